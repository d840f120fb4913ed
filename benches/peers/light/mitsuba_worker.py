"""Renders a scene with one variant of Mitsuba, as often as its standard input asks for.

    mitsuba_worker.py VARIANT SCENE FOLDER WIDTH HEIGHT SAMPLES THREADS SAMPLER...

A line `INDEX SEED FILE` asks for an image with the sampler of that index, which is written to the
file as an array. Each answer is a line of JSON. The first, which nobody asked for, tells what
loading and, for each sampler, compiling took. The home directory should be an empty one: Mitsuba
keeps compiled kernels there.
"""

import json
import os
import pathlib
import resource
import sys
import time

import drjit as dr
import mitsuba as mi
import numpy as np

# Mitsuba writes its warnings to the standard output, which is kept for the answers.
ANSWERS = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
JITS = ("llvm_ad_rgb", "cuda_ad_rgb")


def user_seconds():
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def render(scene, sensor, seed, samples):
    """The image, and the wall time and the user time of all threads that it took, in seconds."""
    dr.sync_thread()
    cpu, wall = user_seconds(), time.perf_counter()
    image = scene.integrator().render(scene, sensor=sensor, seed=seed, spp=samples)
    dr.eval(image)
    dr.sync_thread()
    seconds = {"wall": time.perf_counter() - wall, "cpu": user_seconds() - cpu}
    return np.array(image), seconds


def warm_up(scene, sensors, samples):
    """Renders twice with each sensor; seconds of compiling, and of the first image.

    Compiling is what the second image, of another seed, does not take. If it compiled, too, its
    time would be wrong for all seeds.
    """
    found = []
    for sensor in range(sensors):
        dr.kernel_history_clear()
        _, first = render(scene, sensor, 1_000_001, samples)
        compiled = [kernel for kernel in dr.kernel_history() if not kernel.get("cache_hit", True)]
        seconds = sum(kernel.get("codegen_time", 0) + kernel.get("backend_time", 0) for kernel in compiled) / 1e3
        _, second = render(scene, sensor, 1_000_002, samples)
        again = [kernel for kernel in dr.kernel_history() if not kernel.get("cache_hit", True)]
        found.append({"compile": seconds, "first": first["wall"], "second": second["wall"], "again": len(again)})
    return found


def main():
    variant, name, folder, *numbers = sys.argv[1:8]
    width, height, samples, threads = map(int, numbers)
    samplers = sys.argv[8:]
    mi.set_variant(variant)
    dr.set_thread_count(threads)
    if variant in JITS:
        dr.set_flag(dr.JitFlag.KernelHistory, True)

    import as_mitsuba
    from scenes import SCENES

    start = time.perf_counter()
    scene = as_mitsuba.load(SCENES[name], pathlib.Path(folder), width, height, samplers, samples)
    load = time.perf_counter() - start
    for sampler, sensor in zip(samplers, scene.sensors()):
        if sensor.sampler().sample_count() != samples:
            count = sensor.sampler().sample_count()
            sys.exit(f"error: {sampler} takes {count} samples, not {samples}: ask for a square number of samples")
    warm = warm_up(scene, len(samplers), samples) if variant in JITS else []
    if any(line["again"] for line in warm):
        sys.exit("error: Mitsuba compiles for every seed, so that its times would count compiling")
    dr.set_flag(dr.JitFlag.KernelHistory, False)
    print(json.dumps({"load": load, "warm": warm, "version": mi.__version__}), file=ANSWERS, flush=True)
    for line in sys.stdin:
        sensor, seed, path = line.split(maxsplit=2)
        image, seconds = render(scene, int(sensor), int(seed), samples)
        np.save(path.strip(), image)
        print(json.dumps(seconds), file=ANSWERS, flush=True)


main()
