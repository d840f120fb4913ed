"""Tachyon, as a whole program: flat white spheres on black, its cheapest shading, one ray a pixel.

Tracing is its "Ray Tracing Time", which includes shading; building is its "Preprocessing Time".
"""

import pathlib
import re
import tempfile

import numpy as np

import whole_program
from scene import arguments, report

HEAD = """BEGIN_SCENE
RESOLUTION {width} {height}
CAMERA
  PROJECTION PERSPECTIVE
  ZOOM {zoom:.9g}
  ASPECTRATIO 1
  ANTIALIASING 0
  RAYDEPTH 1
  CENTER {eye}
  VIEWDIR {forward}
  UPDIR {up}
  FRUSTUM {left:.9g} {right:.9g} {bottom:.9g} {top:.9g}
END_CAMERA
BACKGROUND 0 0 0
TEXDEF white AMBIENT 1 DIFFUSE 0 SPECULAR 0 OPACITY 1 COLOR 1 1 1 TEXFUNC 0
"""


def words(vector):
    return " ".join(f"{x:.9g}" for x in vector)


def write(scene, path):
    """Writes the scene; returns whether Tachyon's image of it is mirrored."""
    eye, forward, right, up = (np.array(scene.camera[k], float) for k in ("eye", "forward", "right", "up"))
    # Tachyon's image plane is at distance one. Its rays pass through the upper right corners of
    # pixels; the shift by half a pixel to the left and down moves them to the centres.
    half = scene.camera["half_height"] / np.linalg.norm(forward)
    wide, pixel = half * scene.width / scene.height, half / scene.height
    head = HEAD.format(
        width=scene.width, height=scene.height, zoom=0.5 / half,
        eye=words(eye), forward=words(forward), up=words(up),
        left=-wide - pixel, right=wide - pixel, bottom=-half - pixel, top=half - pixel,
    )  # fmt: skip
    with open(path, "w") as file:
        file.write(head)
        for x, y, z, r in scene.spheres.tolist():
            file.write(f"SPHERE CENTER {x:.9g} {y:.9g} {z:.9g} RAD {r:.9g} white\n")
        file.write("END_SCENE\n")
    return np.dot(np.cross(up, forward), right) < 0


def main():
    args = arguments(__doc__.splitlines()[0])
    whole_program.need("tachyon")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        mirrored = write(args.dir, folder / "scene.dat")
        command = ["tachyon", "scene.dat", "+V", "-numthreads", str(args.threads), "-lowestshade"]
        text, process_s = whole_program.run(command + ["-o", "out.ppm", "-format", "PPM"], folder)
        mask = whole_program.lit(folder / "out.ppm")
    kinds = whole_program.answer(
        args.dir, args, mask[:, ::-1] if mirrored else mask,
        whole_program.number(r"Ray Tracing Time:\s*([\d.]+)", text),
    )  # fmt: skip
    report(
        "tachyon", re.search(r"Version (\S+)", text)[1], args.dir, args.threads,
        whole_program.number(r"Preprocessing Time:\s*([\d.]+)", text), kinds,
        process_s=process_s, parse_s=whole_program.number(r"Parsing Time:\s*([\d.]+)", text),
    )  # fmt: skip


main()
