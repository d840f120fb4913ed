"""The peers: how each is installed or built, and the command that runs it."""

import os
import pathlib
import platform
import shutil
import subprocess
import sys
import zipfile

HERE = pathlib.Path(__file__).resolve().parent

# The packages that `run --install` installs with apt; everything else goes into the cache folder.
DEBIAN = ["g++", "libembree-dev", "libllvm15", "povray", "tachyon"]
EMBREEX = "embreex==4.4.0.post1"
MITSUBA = "mitsuba==3.9.1"
CXXFLAGS = [
    "-std=c++17", "-O3", "-march=native", "-mprefer-vector-width=512",
    "-fno-math-errno", "-fno-trapping-math", "-Wall", "-Wextra", "-pthread",
]  # fmt: skip


class Missing(Exception):
    """The reason why a peer cannot run on this machine."""


def call(*command, **env):
    """Runs a step of an installation. If it fails, its last error line is the reason."""
    command = [str(word) for word in command]
    try:
        done = subprocess.run(command, text=True, capture_output=True, cwd=HERE, env=os.environ | env)
    except OSError as error:
        raise Missing(str(error)) from None
    if done.returncode:
        lines = (done.stderr or done.stdout).strip().splitlines() or ["no output"]
        errors = [line for line in lines if "error" in line.lower()]
        raise Missing(f"{pathlib.Path(command[0]).name}: {(errors or lines)[-1].strip()}")


def on_path(program, how="./run --install installs it with apt"):
    if not shutil.which(program):
        raise Missing(f"{program} is not installed ({how})")


def embree(cache, out, *flags):
    if platform.machine() != "x86_64":
        raise Missing("embree.cpp is for x86-64")
    on_path("g++")
    call("g++", *CXXFLAGS, "-o", cache / out, HERE / "embree/embree.cpp", *flags)
    return [cache / out]


def embree4(cache):
    # The wheel for any Python will do: only its libraries are used.
    wheels = cache / "embreex"
    if not list(wheels.glob("*.libs")):
        call(
            sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--only-binary=:all:",
            "--python-version=3.11", "--platform=manylinux_2_28_x86_64", f"--dest={wheels}", EMBREEX,
        )  # fmt: skip
        for wheel in wheels.glob("*.whl"):
            zipfile.ZipFile(wheel).extractall(wheels)
    libraries = list(wheels.glob("*.libs/libembree4*.so*"))
    if not libraries:
        raise Missing(f"{EMBREEX} has no libembree4")
    rpath = libraries[0].parent
    return embree(cache, "embree4", libraries[0], f"-Wl,-rpath,{rpath}", f"-Wl,-rpath-link,{rpath}")


def embree3(cache):
    if not pathlib.Path("/usr/include/embree3/rtcore.h").exists():
        raise Missing("libembree-dev is not installed (./run --install installs it with apt)")
    return embree(cache, "embree3", "-DEMBREE3", "-lembree3")


def rust(name):
    def prepare(cache):
        on_path("cargo")
        flags = dict(RUSTFLAGS="-C target-cpu=native", CARGO_TARGET_DIR=str(cache / "rust"))
        manifest = HERE / "rust-peers/Cargo.toml"
        call("cargo", "build", "--quiet", "--release", "--locked", "--manifest-path", manifest, **flags)
        return [cache / "rust/release" / name]

    return prepare


def program(name):
    def prepare(cache):
        on_path(name)
        return [sys.executable, HERE / f"{name}.py"]

    return prepare


def mitsuba(cache):
    call(sys.executable, "-m", "pip", "install", "--quiet", MITSUBA)
    call(sys.executable, "-c", "import mitsuba; mitsuba.set_variant('llvm_ad_rgb'); mitsuba.Float(1) + 1")
    return [sys.executable, HERE / "mitsuba3.py"]


def cuda(name, *flags):
    def prepare(cache):
        on_path("nvcc", "it comes with NVIDIA's CUDA toolkit")
        out = cache / "".join(["cuda-", name, *flags])
        call("nvcc", "-O3", "-std=c++17", "-arch=native", *flags, "-o", out, HERE / f"cuda/{name}.cu")
        return [out]

    return prepare


# Name: how to prepare the peer, and the arguments that select it in its program.
ON_CPU = {
    "embree4-points": (embree4, ["--geometry", "points"]),
    "embree4-callback": (embree4, ["--geometry", "callback"]),
    "embree3-points": (embree3, ["--geometry", "points"]),
    "embree3-callback": (embree3, ["--geometry", "callback"]),
    "obvhs-cwbvh": (rust("obvhs"), ["--variant", "cwbvh"]),
    "obvhs-bvh2": (rust("obvhs"), ["--variant", "bvh2"]),
    "bvh": (rust("bvh"), []),
    "parry3d": (rust("parry3d"), []),
    "mitsuba": (mitsuba, []),
    "tachyon": (program("tachyon"), []),
    "povray": (program("povray"), []),
}
ON_GPU = {
    "cuda-tree": (cuda("tree"), []),
    "cuda-brute-plain": (cuda("brute"), ["--variant", "plain"]),
    "cuda-brute-tricks": (cuda("brute"), ["--variant", "tricks"]),
    "cuda-brute-fast-tricks": (cuda("brute", "-use_fast_math"), ["--variant", "tricks"]),
}


def install():
    """Installs the peers' Debian packages; needs root."""
    subprocess.run(["apt-get", "update"], check=True)
    subprocess.run(["apt-get", "install", "--yes", *DEBIAN], check=True)
