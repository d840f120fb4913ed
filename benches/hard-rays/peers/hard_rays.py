"""Reads hard-rays.txt for the programs in this folder."""

import os
import sys
from typing import NamedTuple

# This folder has files that are called like the packages that they import.
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path = [path for path in sys.path if os.path.abspath(path or ".") != HERE]


class Ray(NamedTuple):
    """A ray and its sphere. Each number is a 32-bit float."""

    origin: list
    direction: list
    t_min: float
    t_max: float
    center: list
    radius: float


def read(usage):
    """The rays of the file that the command line names."""
    if len(sys.argv) != 2:
        print(usage, file=sys.stderr)
        sys.exit(2)
    name = sys.argv[1]
    try:
        with open(name, encoding="utf-8") as file:
            lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{name}: {error}")
    if not lines or not lines[0].startswith("# hard-rays 1,"):
        sys.exit(f"{name}: not hard rays of version 1")
    rays = []
    for number, line in enumerate(lines, 1):
        if line.startswith("#"):
            continue
        try:
            x = [float.fromhex(word) for word in line.split()[1:13]]
            rays.append(Ray(x[0:3], x[3:6], x[6], x[7], x[8:11], x[11]))
        except (ValueError, IndexError):
            sys.exit(f"{name}:{number}: not the twelve numbers of a ray")
    return rays
