"""The scene folder that `spherule bench --export` writes, and the report of a peer."""

import argparse
import json
import os
import pathlib

import numpy as np

NONE = 0xFFFFFFFF
KINDS = ("primary", "shadow", "ambient", "incoherent")
NEAREST = ("primary", "incoherent")
HIT = np.dtype([("t", "<f4"), ("id", "<u4")])


def answer_type(kind):
    return HIT if kind in NEAREST else np.dtype("<u4")


class Scene:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        meta = json.loads((self.folder / "meta.json").read_text())
        self.name = meta["scene"]
        self.width, self.height = meta["width"], meta["height"]
        self.camera = meta["camera"]
        self.spheres = np.fromfile(self.folder / "spheres.f32", "<f4").reshape(-1, 4)

    def rays(self, kind):
        """Origin, t_min, direction and t_max in eight columns."""
        return np.fromfile(self.folder / f"{kind}.f32", "<f4").reshape(-1, 8)

    def answers(self, kind, folder=None):
        """spherule's answers, or those that a peer wrote to a folder."""
        path = pathlib.Path(folder or self.folder) / f"{kind}.hits"
        return np.fromfile(path, answer_type(kind))


def arguments(description):
    """The arguments of every peer written in Python."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("dir", type=Scene, metavar="DIR")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--hits", type=pathlib.Path, metavar="FOLDER")
    return parser.parse_args()


def report(peer, version, scene, threads, build_s, kinds, bytes=None, **more):
    """Prints a peer's report as a line of JSON."""
    line = dict(peer=peer, version=version, scene=scene.name, threads=threads)
    line |= dict(build_s=build_s, bytes=bytes, kinds=kinds, **more)
    print(json.dumps(line))
