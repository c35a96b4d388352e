"""The runtime compiles in one folder without an include path: flat.py ROOT FORM COMPILER WORK PROGRAM ASSETS

FORM `copied`: the files that README.md says to copy, as C99. `copied_gl`: with those of pliant_gl. `single`: the files that
runtime/make_single.py writes, as C99 and as C++11. Each form is compiled without a warning by COMPILER (gcc or clang) and
linked to tests/runtime/test_bits.c. It must print the same hash of blends of ASSETS as PROGRAM, which uses the library.
"""
import platform
import shutil
import subprocess
import sys
from pathlib import Path

STRICT = ["-pedantic", "-Wall", "-Wextra", "-Werror", "-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
C99 = ["-std=c99"]
CPP11 = ["-x", "c++", "-std=c++11"]
# Parts of fast-math: gcc must refuse them, clang must not heed them.
REASSOCIATING = ["-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"]
CPP_COMPILERS = {"gcc": "g++", "clang": "clang++"}


def fill(root, form, folder):
    """Puts the runtime's files into `folder`, which is emptied first."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if form == "single":
        subprocess.run([sys.executable, "-B", str(root / "runtime/make_single.py"), str(folder)], check=True)
        return
    patterns = ["runtime/*.c", "runtime/*.h", "formats/pliant_format.h"]
    if form == "copied_gl":
        patterns += ["runtime/gl/*.c", "runtime/gl/*.h"]
    for pattern in patterns:
        for path in root.glob(pattern):
            shutil.copy(path, folder)


def must_refuse(command, sources, folder, flags):
    fast = subprocess.run([*command, *STRICT, *flags, "-fsyntax-only", *sources], cwd=folder, check=False,
                          capture_output=True, text=True)
    assert fast.returncode != 0 and "Pliant cannot be compiled" in fast.stderr, fast.stderr


def hash_of(root, command, compiler, folder, assets):
    """Compiles everything in `folder` there by `command`, and runs test_bits, compiled by `compiler`, with it."""
    sources = sorted(path.name for path in folder.glob("*.c"))
    must_refuse(command, sources, folder, ["-ffast-math", "-ffp-contract=off"])
    if compiler == "gcc":
        must_refuse(command, sources, folder, REASSOCIATING)
        if platform.machine() == "x86_64":
            must_refuse(command, sources, folder, ["-mfpmath=387"])
    ignored = REASSOCIATING if compiler == "clang" else []
    subprocess.run([*command, *STRICT, *ignored, "-c", *sources], cwd=folder, check=True)
    objects = sorted(str(path) for path in folder.glob("*.o"))
    program = folder / "bits"
    test = str(root / "tests/runtime/test_bits.c")
    subprocess.run([compiler, *C99, f"-I{folder}", test, *objects, "-lm", "-o", str(program)], check=True)
    return subprocess.run([str(program), assets], check=True, capture_output=True, text=True).stdout


def main(root, form, compiler, work, library_program, assets):
    commands = [[compiler, *C99]] + ([[CPP_COMPILERS[compiler], *CPP11]] if form == "single" else [])
    missing = [command[0] for command in commands if not shutil.which(command[0])]
    if missing:
        print(f"skipped: {' and '.join(missing)} not installed")
        return 77
    wanted = subprocess.run([library_program, assets], check=True, capture_output=True, text=True).stdout
    print(f"library: {wanted.strip()}")
    good = True
    for command in commands:
        folder = work / command[0]
        fill(root, form, folder)
        found = hash_of(root, command, compiler, folder, assets)
        print(f"{form}, {' '.join(command)}: {found.strip()}")
        good = good and found == wanted
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3], Path(sys.argv[4]).resolve(), *sys.argv[5:]))
