#!/usr/bin/env python3
"""Counts the issue slots that brute force on a GPU takes for an image.

    slots.py FOLDER [--mrays N] [--floor MICROSECONDS] [--gops N]

`spherule bench --export` writes FOLDER. This follows `kernel/src/accel/tiles.rs` tile by tile: the spheres that its
workgroups list, the steps of four cones, and the rounds of the rung that each warp does. The slots of each part are those
of the machine code that NVIDIA's driver generates for an H100 (docs/performance.md). Given the rate that `spherule bench`
prints, in millions of rays a second, the time of an empty launch, and the multiplications a second that `bench` measures, in
billions, it prints the share of all slots that are used.
"""

import argparse

import numpy as np

from scene import Scene

SIDE, WARPS, BLOCK, LISTED, STEP, BITS = 32, 8, (4, 8), 256, 4, 32
# Slots of a warp: once, for two tests of spheres, for a cone, for putting an index on the list.
ONCE, LOOKS, CONE, PUT = 150, 76, 38, 26
# Slots of the one warp that computes the planes and the rows.
PLANES = 98
# Slots of a block of 8 x 4 pixels without and with a list, of a step, of having several steps, of
# a round.
EMPTY, PIXELS, TESTS, MORE, ROUND = 25, 81, 25, 13, 50
LANES = 32


def count(scene):
    width, height, camera = scene.width, scene.height, scene.camera
    spheres = scene.spheres.astype(float)
    eye, forward, right, up = (np.array(camera[key]) for key in ("eye", "forward", "right", "up"))
    right, up = right * camera["half_height"] * width / height, up * camera["half_height"]
    away, squared = spheres[:, :3] - eye, spheres[:, 3] ** 2
    cones = away / np.sqrt((away * away).sum(axis=1) - squared)[:, None]

    def plane(offset, axis, towards):
        normal = np.cross(forward + offset, axis)
        normal /= np.linalg.norm(normal)
        return normal if normal @ towards > 0 else -normal

    def film_x(x):
        return (2 * x + 1 - width) / width

    def film_y(y):
        return (height - 2 * y - 1) / height

    found = dict(tiles=0, listed=0, cones=0, blocks=0, empty=0, steps=0, longer=0, rounds=0)
    for top in range(0, height, SIDE):
        for left in range(0, width, SIDE):
            planes = [
                plane(right * film_x(left), up, right),
                plane(right * film_x(left + SIDE - 1), up, -right),
                plane(up * film_y(top + SIDE - 1), right, up),
                plane(up * film_y(top), right, -up),
            ]
            farthest = np.min([away @ normal for normal in planes], axis=0)
            seen = np.flatnonzero((farthest >= 0) | (farthest**2 <= squared))
            if len(seen) > LISTED:
                raise SystemExit(f"{len(seen)} spheres are visible in one tile: lists longer than {LISTED} are not supported")
            rows = np.arange(top, min(top + SIDE, height) // BLOCK[0] * BLOCK[0])
            columns = np.arange(left, min(left + SIDE, width) // BLOCK[1] * BLOCK[1])
            blocks = len(rows) * len(columns) // LANES
            found["tiles"] += 1
            found["listed"] += len(seen)
            found["cones"] += -(-len(seen) // LANES)
            found["blocks"] += blocks
            if len(seen) == 0:
                found["empty"] += blocks
                continue
            rays = forward + right * film_x(columns)[None, :, None] + up * film_y(rows)[:, None, None]
            reaches = rays @ cones[seen].T >= np.linalg.norm(rays, axis=2)[:, :, None]
            for base in range(0, len(seen), BITS):
                some = reaches[:, :, base : base + BITS]
                found["steps"] += blocks * -(-some.shape[2] // STEP)
                found["longer"] += blocks * (some.shape[2] > STEP)
                asked = some.sum(axis=2).reshape(len(rows) // BLOCK[0], BLOCK[0], -1, BLOCK[1])
                found["rounds"] += int(asked.max(axis=(1, 3)).sum())
    warps = found["tiles"] * WARPS
    looks = -(-len(spheres) // (2 * WARPS * LANES))
    found["slots"] = (
        warps * (ONCE + looks * LOOKS)
        + found["tiles"] * PLANES
        + found["cones"] * CONE
        + found["listed"] * PUT
        + found["empty"] * EMPTY
        + (found["blocks"] - found["empty"]) * PIXELS
        + found["steps"] * TESTS
        + found["longer"] * MORE
        + found["rounds"] * ROUND
    )
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Scene, metavar="FOLDER")
    parser.add_argument("--mrays", type=float, metavar="N", help="millions of rays a second")
    parser.add_argument("--floor", type=float, default=0.0, metavar="US", help="the time of an empty launch")
    parser.add_argument("--gops", type=float, default=31430, metavar="N", help="10^9 multiplications a second")
    args = parser.parse_args()
    found = count(args.scene)
    print(", ".join(f"{value:,} {key}" for key, value in found.items()))
    least = found["slots"] * LANES / args.gops / 1e3
    print(f"{least:.1f} us if every slot is used")
    if args.mrays:
        took = args.scene.width * args.scene.height / args.mrays
        print(f"{took:.1f} us in all: {least / took:.2f}; without {args.floor} us: {least / (took - args.floor):.2f}")


if __name__ == "__main__":
    main()
