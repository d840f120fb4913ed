"""What the benchmarks run in: Python's packages in the cache folder, and spherule's binary."""

import importlib.util
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
NUMPY = "numpy>=1.24,<3"


def has(modules):
    return all(importlib.util.find_spec(module) for module in modules)


def enter(cache, script, packages):
    """Restarts a script in the environment; `packages` maps modules to what pip is to install."""
    folder = cache.resolve() / "python"
    python = folder / "bin/python"
    if pathlib.Path(sys.prefix) == folder:
        return
    imports = "import " + ", ".join(packages)
    try:
        if not python.exists():
            subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        if subprocess.run([python, "-c", imports], capture_output=True).returncode:
            subprocess.run([python, "-m", "pip", "install", "--quiet", *packages.values()], check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"there is no Python environment in {folder} ({error}); it needs venv and pip, and PyPI for {imports}")
    os.execv(python, [python, script, *sys.argv[1:]])


def spherule():
    """The spherule binary; built if the environment does not name one."""
    if "SPHERULE" in os.environ:
        return os.environ["SPHERULE"]
    try:
        subprocess.run(["cargo", "build", "--release"], cwd=ROOT, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"spherule cannot be built: {error}")
    return pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release/spherule"
