#!/usr/bin/env python3
"""Answers hard rays with the `sphere` of Mitsuba 3.9.1, scalar_rgb: pip install mitsuba==3.9.1

mitsuba.py hard-rays.txt > ANSWERS.txt

A ray of Mitsuba begins at its origin; one with another t_min than zero is not asked.
"""

import hard_rays

rays = hard_rays.read(__doc__)

import mitsuba as mi

mi.set_variant("scalar_rgb")
mi.set_log_level(mi.LogLevel.Error)
for ray in rays:
    if ray.t_min != 0:
        print("-")
        continue
    scene = mi.load_dict({"type": "scene", "it": {"type": "sphere", "center": ray.center, "radius": ray.radius}})
    found = scene.ray_intersect(mi.Ray3f(o=ray.origin, d=ray.direction, maxt=ray.t_max, time=0.0, wavelengths=[]))
    print(float(found.t).hex() if found.is_valid() else "miss")
