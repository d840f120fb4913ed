"""POV-Ray, as a whole program: flat white spheres on black, no lights, one ray a pixel.

Tracing is its "Trace Time", building its "Bounding Time"; +BM2 selects its BSP tree, which traces
faster than the default.
"""

import pathlib
import re
import tempfile

import numpy as np

import whole_program
from scene import arguments, report

HEAD = """#version 3.7;
global_settings {{ assumed_gamma 1 }}
camera {{ perspective location <{eye}> right <{right}> up <{up}> direction <{forward}> }}
background {{ rgb 0 }}
#default {{ texture {{ pigment {{ rgb 1 }} finish {{ ambient 0 diffuse 0 emission 1 }} }} }}
"""


def words(vector):
    return ",".join(f"{x:.9g}" for x in vector)


def write(scene, path):
    eye, forward, right, up = (np.array(scene.camera[k], float) for k in ("eye", "forward", "right", "up"))
    size = 2 * scene.camera["half_height"]
    head = HEAD.format(
        eye=words(eye), forward=words(forward),
        right=words(right * size * scene.width / scene.height), up=words(up * size),
    )  # fmt: skip
    with open(path, "w") as file:
        file.write(head)
        for x, y, z, r in scene.spheres.tolist():
            file.write(f"sphere {{ <{x:.9g},{y:.9g},{z:.9g}>, {r:.9g} }}\n")


def seconds(name, text):
    return whole_program.number(name + r" Time:.*\(([\d.]+) seconds\)", text)


def main():
    args = arguments(__doc__.splitlines()[0])
    whole_program.need("povray")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write(args.dir, folder / "scene.pov")
        size = [f"+W{args.dir.width}", f"+H{args.dir.height}"]
        command = ["povray", "+Iscene.pov", "+Oout.ppm", "+FP", *size, "-A", "-D", "+BM2", f"+WT{args.threads}"]
        text, process_s = whole_program.run(command, folder)
        mask = whole_program.lit(folder / "out.ppm")
    kinds = whole_program.answer(args.dir, args, mask, seconds("Trace", text))
    report(
        "povray", re.search(r"Version (\d+(?:\.\d+)+)", text)[1], args.dir, args.threads,
        seconds("Bounding", text), kinds,
        process_s=process_s, parse_s=seconds("Parse", text),
    )  # fmt: skip


main()
