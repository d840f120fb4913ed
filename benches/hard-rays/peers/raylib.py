#!/usr/bin/env python3
"""Answers hard rays with raylib's GetRayCollisionSphere, version 5.5: pip install raylib==5.5.0.4

raylib.py hard-rays.txt > ANSWERS.txt

It takes directions of length one in 32-bit floats, so that each is divided by its length in 64
bits and rounded, and t is the distance over that length. Its rays are lines: a sphere behind the
origin is hit at a negative distance, which counts as a miss. A ray with another t_min than zero is
not asked.
"""

import math

import hard_rays

rays = hard_rays.read(__doc__)

import pyray

for ray in rays:
    if ray.t_min != 0:
        print("-")
        continue
    length = math.hypot(*ray.direction)
    along = pyray.Vector3(*(x / length for x in ray.direction))
    asked = pyray.Ray(pyray.Vector3(*ray.origin), along)
    found = pyray.get_ray_collision_sphere(asked, pyray.Vector3(*ray.center), ray.radius)
    t = found.distance / length
    print(t.hex() if found.hit and 0 <= t < ray.t_max else "miss")
