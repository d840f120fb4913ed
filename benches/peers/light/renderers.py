"""The programs: how each is made to render a seed of a scene, and what it took."""

import glob
import json
import os
import pathlib
import re
import subprocess
import sys

import as_spherule
import images
import numpy as np
from scenes import SCENES

from peers import Missing

HERE = pathlib.Path(__file__).resolve().parent
VARIANTS = {"llvm": "llvm_ad_rgb", "scalar": "scalar_rgb", "cuda": "cuda_ad_rgb"}
NEEDS = {  # if its backend does not start
    "llvm": "it needs LLVM's library; DRJIT_LIBLLVM_PATH may name it",
    "cuda": "it needs an NVIDIA GPU, and OptiX in its driver",
}
OLDEST_LLVM = 17  # before it, LLVM has no code for an instruction of Mitsuba's kernels, and aborts
LLVM_PLACES = ("/usr/lib/*-linux-gnu", "/usr/lib", "/usr/lib64", "/usr/lib/llvm-*/lib", "/opt/homebrew/opt/llvm/lib")


class Spherule:
    """spherule's command, one process an image."""

    def __init__(self, scene, folder, options):
        self.name, self.folder, self.options = "spherule", folder, options
        self.scene = as_spherule.write(SCENES[scene], folder, options.width, options.height)
        self.idle_cpu = self.run(0, 1)[1]["cpu"]

    def run(self, seed, samples):
        image, stats = self.folder / "spherule.exr", self.folder / "stats.json"
        options = self.options
        command = [options.spherule, "render", self.scene, "--device", "gpu" if options.gpu else "cpu"]
        command += ["--samples", samples, "--seed", seed, "--precision", options.precision]
        command += ["--quiet", "--stats", stats, "--output", image]
        environment = os.environ | {"RAYON_NUM_THREADS": str(options.threads)}
        process = subprocess.Popen(list(map(str, command)), stderr=subprocess.PIPE, text=True, env=environment)
        complaint = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise Missing(f"spherule: {complaint.strip() or process.returncode}")
        self.stats = json.loads(stats.read_text())
        return image, {"wall": self.stats["seconds"]["trace"], "cpu": usage.ru_utime}

    def render(self, seed):
        """The image of a seed, and the seconds of tracing and of the CPU.

        The process's CPU time includes reading the scene and writing the image. An image of one
        sample takes as long for these, and one sample's share of the rest.
        """
        path, seconds = self.run(seed, self.options.samples)
        samples = self.options.samples
        seconds["cpu"] = (seconds["cpu"] - self.idle_cpu) * samples / (samples - 1)
        return images.read(path), seconds

    def about(self):
        return {key: self.stats[key] for key in ("device", "precision", "effects")}

    def close(self):
        pass


class Mitsuba:
    """A process of one of Mitsuba's variants, for all its samplers."""

    def __init__(self, variant, scene, folder, options):
        self.folder = folder
        home = folder / f"home-{variant}"
        home.mkdir()
        environment = os.environ | {"HOME": str(home)}
        self.llvm = find_llvm() if variant == "llvm" else None
        if self.llvm:
            environment["DRJIT_LIBLLVM_PATH"] = self.llvm
        self.samplers = options.samplers
        numbers = map(str, (options.width, options.height, options.samples, options.threads))
        command = [sys.executable, HERE / "mitsuba_worker.py", VARIANTS[variant], scene, folder, *numbers, *self.samplers]
        self.errors = (folder / f"{variant}.log").open("w+")
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.errors, text=True, env=environment
        )
        self.variant = variant
        self.started = self.answer()

    def answer(self):
        line = self.process.stdout.readline()
        if line:
            return json.loads(line)
        self.process.wait()
        self.errors.seek(0)
        text = re.sub(r"\x1b\[\d*m", "", self.errors.read())  # without colours
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        errors = [line for line in lines if "error" in line.lower()] or lines or ["it ended without a word"]
        need = f"; {NEEDS[self.variant]}" if "backend" in errors[0] else ""
        raise Missing(f"{VARIANTS[self.variant]}: {errors[0]}{need}")

    def render(self, sampler, seed):
        path = self.folder / f"{self.variant}.npy"
        try:
            print(self.samplers.index(sampler), seed, path, file=self.process.stdin, flush=True)
        except BrokenPipeError:
            pass  # the answer has the reason
        seconds = self.answer()
        return np.load(path), seconds

    def close(self):
        if self.process.poll() is not None:
            return
        self.process.stdin.close()
        self.process.wait()
        self.errors.close()


class MitsubaSampler:
    def __init__(self, mitsuba, sampler):
        self.mitsuba, self.sampler = mitsuba, sampler
        self.name = f"{mitsuba.variant} {sampler}"

    def render(self, seed):
        return self.mitsuba.render(self.sampler, seed)

    def about(self):
        """Mitsuba's version, and the seconds of loading and compiling; a path of LLVM."""
        started, about = self.mitsuba.started, {"llvm": self.mitsuba.llvm}
        if started["warm"]:
            about["compile"] = started["warm"][self.mitsuba.samplers.index(self.sampler)]["compile"]
        return about | {"version": started["version"], "load": started["load"]}

    def close(self):
        self.mitsuba.close()


def llvm_version(path):
    """The major version in a file name such as libLLVM-19.so or libLLVM.so.19.1, or 0."""
    found = re.fullmatch(r"libLLVM(?:\.so\.|-)(\d+)(?:[.\d]|so|dylib)*", pathlib.Path(path).name)
    return int(found[1]) if found else 0


def find_llvm():
    """The path of LLVM's library: the one in DRJIT_LIBLLVM_PATH, or the newest one."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named and (not llvm_version(named) or llvm_version(named) >= OLDEST_LLVM):
        return named
    found = [path for place in LLVM_PLACES for path in glob.glob(f"{place}/libLLVM*")]
    found = [path for path in found if llvm_version(path) >= OLDEST_LLVM]
    if not found:
        raise Missing(
            f"llvm_ad_rgb needs LLVM's library, version {OLDEST_LLVM} or later: "
            "`apt-get install libllvm19` on Debian 12, or its path in DRJIT_LIBLLVM_PATH"
        )
    return max(found, key=llvm_version)
