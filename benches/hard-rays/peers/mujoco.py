#!/usr/bin/env python3
"""Answers hard rays with mju_rayGeom of MuJoCo 4.0.0, in 64-bit floats: pip install mujoco==4.0.0

mujoco.py hard-rays.txt > ANSWERS.txt

It takes a ray's direction as it is. A ray with another t_min than zero is not asked.
"""

import hard_rays

rays = hard_rays.read(__doc__)

import mujoco
import numpy

UPRIGHT = numpy.eye(3).flatten()
SPHERE = mujoco.mjtGeom.mjGEOM_SPHERE

for ray in rays:
    if ray.t_min != 0:
        print("-")
        continue
    center, origin, direction = map(numpy.array, (ray.center, ray.origin, ray.direction))
    size = numpy.array([ray.radius, 0.0, 0.0])
    t = mujoco.mju_rayGeom(center, UPRIGHT, size, origin, direction, SPHERE)
    print(t.hex() if 0 <= t < ray.t_max else "miss")
