#!/usr/bin/env python3
"""Answers hard rays with Mitsuba 3's `sphere`: pip install mitsuba.

mitsuba.py hard-rays.json [VARIANT] > ANSWERS.txt

A ray of Mitsuba has no beginning but its origin, so that t_min is taken for zero.
"""

import json
import os
import sys

# Not this file.
sys.path = [path for path in sys.path if os.path.abspath(path or ".") != os.path.dirname(os.path.abspath(__file__))]

import mitsuba as mi

mi.set_variant(sys.argv[2] if len(sys.argv) > 2 else "scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
with open(sys.argv[1], encoding="utf-8") as file:
    suite = json.load(file)
for chosen in suite["sets"]:
    for ray in chosen["rays"]:
        origin, direction, center = (
            [float.fromhex(x) for x in ray[name]] for name in ("origin", "direction", "center")
        )
        t_max, radius = float.fromhex(ray["t_max"]), float.fromhex(ray["radius"])
        scene = mi.load_dict({"type": "scene", "it": {"type": "sphere", "center": center, "radius": radius}})
        found = scene.ray_intersect(mi.Ray3f(o=origin, d=direction, maxt=t_max, time=0.0, wavelengths=[]))
        print(float(found.t).hex() if found.is_valid() else "miss")
