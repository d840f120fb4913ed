#!/usr/bin/env python3
"""Answers hard rays with POV-Ray 3.7's trace(): apt-get install povray

povray.py hard-rays.txt > ANSWERS.txt

trace() is the function of scenes that finds where a ray meets an object, in 64-bit floats. One
scene asks every ray and writes the points to a file; t is computed from them in rational numbers,
so that it is as near as the point is. POV-Ray drops hits that are very near to a ray's origin. Its
rays begin at zero; one with another t_min is not asked.
"""

import fractions
import os
import subprocess
import sys
import tempfile

import hard_rays


def vector(numbers):
    # POV-Ray reads no subnormal numbers, nor a sign before a zero.
    return "<" + ",".join(f"{x:.17g}" for x in numbers) + ">"


def scene(rays):
    """A scene that asks the rays: a line of the point, or `miss`."""
    yield "#version 3.7;\n#declare N = <0, 0, 0>;\n#fopen FILE \"points.txt\" write\n"
    yield "#macro ASK(O, D, C, R)\n"
    yield "  #local BALL = sphere { C, R }\n  #local P = trace(BALL, O, D, N);\n"
    yield "  #if (vlength(N) = 0) #write (FILE, \"miss\\n\")\n"
    yield "  #else #write (FILE, str(P.x, 0, 50), \" \", str(P.y, 0, 50), \" \", str(P.z, 0, 50), \"\\n\") #end\n"
    yield "#end\n"
    for ray in rays:
        yield f"ASK({vector(ray.origin)}, {vector(ray.direction)}, {vector(ray.center)}, {ray.radius:.17g})\n"
    yield "#fclose FILE\n"


def parameter(ray, point):
    """The parameter of the point of the ray that is nearest to a point."""
    exact = fractions.Fraction
    direction = [exact(x) for x in ray.direction]
    way = [exact(p) - exact(o) for p, o in zip(point, ray.origin)]
    return float(sum(a * b for a, b in zip(way, direction)) / sum(d * d for d in direction))


def main():
    rays = hard_rays.read(__doc__)
    asked = [ray for ray in rays if ray.t_min == 0]
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "ask.pov"), "w", encoding="ascii") as file:
            file.writelines(scene(asked))
        command = ["povray", "+Iask.pov", "+W1", "+H1", "-D", "-F", "+WL0"]
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        except FileNotFoundError:
            sys.exit("no povray: apt-get install povray")
        if done.returncode:
            sys.exit(done.stderr)
        with open(os.path.join(folder, "points.txt"), encoding="ascii") as file:
            lines = file.read().splitlines()
    if len(lines) != len(asked):
        sys.exit(f"POV-Ray answered {len(lines)} of {len(asked)} rays")
    answers = iter(lines)
    for ray in rays:
        if ray.t_min != 0:
            print("-")
            continue
        answer = next(answers)
        if answer != "miss":
            t = parameter(ray, [float(x) for x in answer.split()])
            answer = t.hex() if t < ray.t_max else "miss"
        print(answer)


main()
