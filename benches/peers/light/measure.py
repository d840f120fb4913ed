"""Renders a scene with every program in turns, and sums up what they found and took."""

import contextlib
import pathlib
import shutil
import sys
from dataclasses import dataclass, field

import images
import numpy as np
import variance
from renderers import VARIANTS, Mitsuba, MitsubaSampler, Spherule
from scenes import SCENES

from peers import Missing

OURS = "spherule"
COARSE = 32  # pixels of a tile whose means are compared
# The programs disagree if a channel's mean over the image differs by more standard errors than
# IMAGE_SCORE and by a larger share than LEAST_SHARE, or if the squares of the tiles' scores have a
# mean that is TILE_SIGMAS standard deviations above what is expected.
IMAGE_SCORE = 6.0
LEAST_SHARE = 0.001
TILE_SIGMAS = 5.0


@dataclass
class Runs:
    """The images and the times of one program."""

    renderer: object
    images: list = field(default_factory=list)
    seconds: list = field(default_factory=list)

    def stack(self):
        return np.array(self.images)

    def median(self, clock):
        return float(np.median([seconds[clock] for seconds in self.seconds]))


def start(scene, folder, options):
    """The renderers that work here, and the reasons why others do not."""
    renderers, missing = [Spherule(scene, folder, options)], {}
    for variant in options.variants:
        try:
            mitsuba = Mitsuba(variant, scene, folder, options)
            renderers += [MitsubaSampler(mitsuba, sampler) for sampler in options.samplers]
        except Missing as reason:
            missing[VARIANTS[variant]] = str(reason)
    return renderers, missing


def render_all(scene, renderers, options):
    runs = {renderer.name: Runs(renderer) for renderer in renderers}
    for seed in range(options.seeds):
        print(f"{scene}: seed {seed + 1} of {options.seeds}", file=sys.stderr)
        for renderer in renderers:
            image, seconds = renderer.render(seed)
            runs[renderer.name].images.append(image)
            runs[renderer.name].seconds.append(seconds)
    return runs


def most_tile_score(seeds, tiles):
    """The largest root mean square of the tiles' scores that still is agreement.

    The scores of images that agree have Student's distribution, here with d degrees of freedom.
    """
    d = 2 * (seeds - 1)
    square = d / (d - 2)
    fourth = 3 * d**2 / ((d - 2) * (d - 4))
    return np.sqrt(square + TILE_SIGMAS * np.sqrt((fourth - square**2) / tiles))


def agreement(ours, theirs):
    """How far the mean of their stack is off that of ours."""
    whole = variance.standard_scores(theirs.mean((1, 2)), ours.mean((1, 2)))
    channel = int(np.abs(whole).argmax())
    share = theirs[..., channel].mean() / ours[..., channel].mean() - 1
    stacks = [variance.tiles(variance.luminance(stack), COARSE) for stack in (ours, theirs)]
    scores = variance.standard_scores(*stacks)
    tile_score, most = np.sqrt(np.mean(scores**2)), most_tile_score(len(ours), scores.size)
    image_score = float(whole[channel])
    agrees = bool((abs(image_score) <= IMAGE_SCORE or abs(share) <= LEAST_SHARE) and tile_score <= most)
    scores = {"image_score": image_score, "tile_score": float(tile_score), "most_tile_score": float(most)}
    return {"agrees": agrees, "share": float(share), **scores}


def summary(run, reference, clocks):
    """A program's line: its variance, its seconds, and their product on each clock."""
    stack = variance.luminance(run.stack())
    relative, error = variance.with_error(stack, reference)
    line = {"mean": float(stack.mean()), "variance": float(relative), "error": float(error)}
    for clock in clocks:
        line[clock] = run.median(clock)
        line[f"variance_x_{clock}"] = line["variance"] * line[clock]
    return line | {"seconds": run.seconds, **run.renderer.about()}


def ratios(programs, clocks):
    """On each clock, the best Mitsuba, and how many times as long as spherule it takes."""
    ours, found = programs[OURS], {}
    for clock in clocks:
        key = f"variance_x_{clock}"
        best = min((name for name in programs if name != OURS), key=lambda name: programs[name][key])
        error = float(np.hypot(ours["error"], programs[best]["error"]))
        ratio = programs[best][key] / ours[key]
        found[clock] = {"best": best, "ratio": ratio, "error": ratio * error}
    return found


def keep(scene, runs, folder, kept):
    """Copies what the programs read, and writes the mean image of each."""
    kept.mkdir(parents=True, exist_ok=True)
    for path in (folder / f"{scene}.toml", *folder.glob(f"{scene}-*.exr")):
        shutil.copy(path, kept)
    for name, run in runs.items():
        images.write(run.stack().mean(0), kept / f"{scene} {name}.exr".replace(" ", "-"))


def measure(scene, folder, options):
    """What one scene gave: a line for each program, the agreement, and the ratios if all agree."""
    folder = pathlib.Path(folder) / scene
    folder.mkdir(parents=True, exist_ok=True)
    renderers, missing = start(scene, folder, options)
    with contextlib.ExitStack() as stack:
        for renderer in renderers:
            stack.callback(renderer.close)
        if len(renderers) < 2:
            raise Missing("; ".join(missing.values()))
        runs = render_all(scene, renderers, options)
    if options.keep:
        keep(scene, runs, folder, options.keep)
    reference = np.mean([variance.luminance(run.stack()).mean(0) for run in runs.values()], 0)
    programs = {name: summary(run, reference, options.clocks) for name, run in runs.items()}
    others = [name for name in programs if name != OURS]
    agreed = {name: agreement(runs[OURS].stack(), runs[name].stack()) for name in others}
    found = {"scene": scene, "tests": SCENES[scene].tests, "programs": programs, "agreement": agreed, "missing": missing}
    if all(line["agrees"] for line in agreed.values()):
        found["ratios"] = ratios(programs, options.clocks)
    return found
