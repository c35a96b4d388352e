#!/usr/bin/env python3
"""The npm package: build.py FOLDER

Compiles the runtime to FOLDER/pliant.wasm and copies the package's other files beside it; `npm pack` in FOLDER makes the
archive. FOLDER is new, empty, or a package that this script made before. The compiler is zig, of the Python that runs this;
where that has none, zig is installed from PyPI once, into build/zig of the project. The module imports nothing.
"""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import venv
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
RUNTIME = HERE.parents[1]
ROOT = RUNTIME.parent
FILES = ["package.json", "pliant.js", "pliant.d.ts", "three.js", "three.d.ts", "README.md"]
STAMP = ".made_by_pliant_web"
ZIG = "ziglang==0.17.0"
# Without these two features of zig's default: Chromium 91 and node 16 lack them.
PROCESSOR = "-mcpu=generic+simd128-reference_types-call_indirect_overlong"
COMPILE = ["-m", "ziglang", "cc", "-target", "wasm32-wasi", PROCESSOR, "-std=c99", "-ffp-contract=off",
           "-fno-math-errno", "-fno-trapping-math", f"-I{RUNTIME}", f"-I{ROOT / 'formats'}"]
# Not in a frame, or little of it: made small. The rest is made fast.
SMALL = {"asset", "asset_energy", "asset_shape", "bounds", "elements_layers", "glb", "morph", "normals", "objective", "open",
         "radial", "solver"}


def functions():
    """What pliant.h declares, without the one that returns a struct by value."""
    names = re.findall(r"^PLIANT_API [^(]*?(pliant_\w+)\(", (RUNTIME / "pliant.h").read_text(encoding="utf-8"), re.M)
    return [name for name in names if name != "pliant_solver_desc_default"]


def python_with_zig():
    if importlib.util.find_spec("ziglang"):
        return sys.executable
    folder = ROOT / "build/zig"
    python = folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")
    question = [python, "-c", "import ziglang"]
    is_there = python.exists() and subprocess.run(question, check=False, capture_output=True).returncode == 0
    if not is_there:
        venv.create(folder, clear=True, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", ZIG], check=True)
    return str(python)


def compile_one(python, source, output):
    level = "-Oz" if source.stem in SMALL else "-O2"
    subprocess.run([python, *COMPILE, level, "-c", str(source), "-o", str(output)], check=True)
    return str(output)


def is_ours(folder):
    """Whether this script may write into the folder."""
    return not os.path.lexists(folder) or (folder / STAMP).exists() or (folder.is_dir() and not any(folder.iterdir()))


def place(files, folder):
    """All or none of them, without the write protection that sources may have."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / STAMP).touch()
    with tempfile.TemporaryDirectory(prefix=".pliant-", dir=folder) as work:
        for path in files:
            shutil.copyfile(path, Path(work, path.name))
        for path in files:
            os.replace(Path(work, path.name), folder / path.name)


def main(folder):
    if not is_ours(folder):
        sys.exit(f"build.py: error: {folder} is there, and is no package of this script\nhint: name a new folder")
    python = python_with_zig()
    sources = sorted(RUNTIME.glob("*.c"))
    with tempfile.TemporaryDirectory(prefix="pliant-web-") as work, ThreadPoolExecutor(2) as pool:
        compiled = list(pool.map(lambda source: compile_one(python, source, Path(work, f"{source.stem}.o")), sources))
        exports = [f"-Wl,--export={name}" for name in ("malloc", "free", *functions())]
        link = [python, *COMPILE, "-O2", "-s", "-mexec-model=reactor", *compiled, *exports]
        module = Path(work, "pliant.wasm")
        subprocess.run([*link, "-o", str(module)], check=True)
        place([module, *(HERE / name for name in FILES), ROOT / "LICENSE"], folder)
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
