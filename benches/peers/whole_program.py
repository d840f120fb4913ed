"""Shared by peers that are whole programs: runs them, reads their time and their image."""

import re
import shutil
import subprocess
import sys
import time

import numpy as np


def need(program):
    if not shutil.which(program):
        sys.exit(f"{program} is not installed")


def run(command, folder):
    """Runs a program in a folder; returns its output and its time in seconds."""
    start = time.perf_counter()
    done = subprocess.run(command, cwd=folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    seconds = time.perf_counter() - start
    if done.returncode:
        sys.exit(f"{command[0]} failed:\n{done.stdout[-2000:]}")
    return done.stdout, seconds


def number(pattern, text):
    found = re.search(pattern, text)
    if not found:
        sys.exit(f"no match for {pattern!r} in the program's output")
    return float(found[1])


def lit(path):
    """A binary PPM as rows of booleans: whether a pixel is not black."""
    data = path.read_bytes()
    header = re.match(rb"P6\s+(?:#.*\n)*(\d+)\s+(\d+)\s+(\d+)\s", data)
    if not header:
        sys.exit(f"{path} is not a binary PPM")
    width, height, largest = map(int, header.groups())
    pixels = np.frombuffer(data, ">u2" if largest > 255 else "u1", offset=header.end())
    return pixels.reshape(height, width, 3).any(2)


def answer(scene, args, mask, seconds):
    """The `kinds` of a report; also writes the mask of hits if it is requested."""
    if args.hits:
        mask.astype("<u4").tofile(args.hits / "primary.mask")
    return dict(primary=dict(seconds=seconds, hits=int(mask.sum())))
