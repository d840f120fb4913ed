#!/usr/bin/env python3
"""Scores a program's answers to hard rays: docs/hard-rays.md.

score.py hard-rays.json                prints the rays, for programs that read them as text
score.py hard-rays.json ANSWERS.txt    scores the answers: a line for each ray, "miss" or t

Numbers are decimal or hexadecimal (0x1.8p+1). Nothing but Python's standard library is needed.
"""

import json
import math
import struct
import sys


def number(text):
    return float.fromhex(text) if "0x" in text.lower() else float(text)


def single(t):
    """t as the nearest 32-bit float, ties to even; infinite if it is beyond the largest."""
    try:
        return struct.unpack("<f", struct.pack("<f", t))[0]
    except OverflowError:
        return math.copysign(math.inf, t)


def place(t):
    """The place of a 32-bit float among all of them."""
    bits = struct.unpack("<I", struct.pack("<f", t))[0]
    return -(bits & 0x7FFFFFFF) if bits >> 31 else bits


def ulps(found, right):
    return abs(place(single(found)) - place(right))


def score(rays, answers):
    """Rays, false hits, missed hits, hits, hits with the nearest float, the largest error in ulp."""
    false = missed = hits = nearest = worst = 0
    for ray, answer in zip(rays, answers):
        is_hit = answer.lower() != "miss"
        t = number(answer) if is_hit else math.nan
        is_hit = is_hit and math.isfinite(t)
        if ray["answer"] == "miss":
            false += is_hit
        elif not is_hit:
            missed += 1
        else:
            hits += 1
            error = ulps(t, number(ray["t"]))
            nearest += error == 0
            worst = max(worst, error)
    return len(rays), false, missed, hits, nearest, worst


def line(name, counts):
    return f"{name[:55]:55} {counts[0]:7} {counts[1]:7} {counts[2]:7} {counts[4]:7} {counts[3]:7} {counts[5]:11}"


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    with open(sys.argv[1], encoding="utf-8") as file:
        suite = json.load(file)
    if suite.get("format") != "hard-rays" or suite.get("version") != 1:
        sys.exit(f"{sys.argv[1]}: not hard rays of version 1")
    sets = suite["sets"]
    if len(sys.argv) == 2:
        for chosen in sets:
            for ray in chosen["rays"]:
                numbers = ray["origin"] + ray["direction"] + [ray["t_min"], ray["t_max"]]
                print(*numbers, *ray["center"], ray["radius"])
        return
    with open(sys.argv[2], encoding="utf-8") as file:
        answers = file.read().split()
    count = sum(len(chosen["rays"]) for chosen in sets)
    if len(answers) != count:
        sys.exit(f"{sys.argv[2]}: {len(answers)} answers to {count} rays")
    print(f"{'set':55} {'rays':>7} {'false':>7} {'missed':>7} {'nearest':>7} {'of hits':>7} {'worst ulp':>11}")
    total = [0] * 6
    at = 0
    for chosen in sets:
        rays = chosen["rays"]
        counts = score(rays, answers[at : at + len(rays)])
        at += len(rays)
        total = [sum(pair) for pair in zip(total[:5], counts[:5])] + [max(total[5], counts[5])]
        print(line(chosen["name"], counts))
    print(line("all", total))


main()
