#!/usr/bin/env python3
"""Scores a program's answers to hard rays: docs/hard-rays.md.

score.py hard-rays.json                prints the rays, for programs that read them as text
score.py hard-rays.json ANSWERS.txt    scores the answers: a line for each ray

An answer is "miss"; t, decimal or hexadecimal (0x1.8p+1); "hit" for a hit without its t; or "-" for
a ray that was not asked, which does not count. Nothing but Python's standard library is needed.
"""

import json
import math
import struct
import sys


def number(text):
    return float.fromhex(text) if "0x" in text.lower() else float(text)


def is_answer(text):
    if text in ("miss", "hit", "-"):
        return True
    try:
        number(text)
    except ValueError:
        return False
    return True


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
    asked = false = missed = hits = nearest = worst = 0
    for ray, answer in zip(rays, answers):
        if answer == "-":
            continue
        asked += 1
        t = None if answer in ("miss", "hit") else number(answer)
        is_hit = answer == "hit" if t is None else math.isfinite(t)
        if ray["answer"] == "miss":
            false += is_hit
        elif not is_hit:
            missed += 1
        else:
            hits += 1
            if t is None:
                continue
            error = ulps(t, number(ray["t"]))
            nearest += error == 0
            worst = max(worst, error)
    return asked, false, missed, hits, nearest, worst


def total(counts):
    """The sums of sets' counts, and their largest error."""
    columns = list(zip(*counts)) or [[0]] * 6
    return [sum(column) for column in columns[:5]] + [max(columns[5])]


def line(name, counts):
    return f"{name[:55]:55} {counts[0]:7} {counts[1]:7} {counts[2]:7} {counts[4]:7} {counts[3]:7} {counts[5]:11}"


def text_of(name):
    try:
        with open(name, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{name}: {error}")


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        suite = json.loads(text_of(sys.argv[1]))
    except json.JSONDecodeError as error:
        sys.exit(f"{sys.argv[1]}: {error}")
    if not isinstance(suite, dict) or suite.get("format") != "hard-rays" or suite.get("version") != 1:
        sys.exit(f"{sys.argv[1]}: not hard rays of version 1")
    sets = suite["sets"]
    if len(sys.argv) == 2:
        for chosen in sets:
            for ray in chosen["rays"]:
                numbers = ray["origin"] + ray["direction"] + [ray["t_min"], ray["t_max"]]
                print(*numbers, *ray["center"], ray["radius"])
        return
    answers = text_of(sys.argv[2]).split()
    for index, answer in enumerate(answers, 1):
        if not is_answer(answer):
            sys.exit(f"{sys.argv[2]}:{index}: neither miss, hit, - nor a number")
    count = sum(len(chosen["rays"]) for chosen in sets)
    if len(answers) != count:
        sys.exit(f"{sys.argv[2]}: {len(answers)} answers to {count} rays")
    print(f"{'set':55} {'rays':>7} {'false':>7} {'missed':>7} {'nearest':>7} {'of hits':>7} {'worst ulp':>11}")
    every, families = [], []
    at = 0
    for chosen in sets:
        counts = score(chosen["rays"], answers[at : at + len(chosen["rays"])])
        at += len(chosen["rays"])
        every.append(counts)
        if chosen["kind"] == "family":
            families.append(counts)
        print(line(chosen["name"], counts))
    print(line("families", total(families)))
    print(line("all", total(every)))


main()
