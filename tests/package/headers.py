"""The public headers and the runtime's sources hold to the standards they claim: headers.py ROOT COMPILER

The public headers compile alone as C99 and as C++11, the runtime as C99, all with -pedantic and without one warning. A
planted line that C99 does not have must be refused, else the flags do nothing.
"""
import shutil
import subprocess
import sys
from pathlib import Path

HEADERS = ("runtime/pliant.h", "runtime/gl/pliant_gl.h", "formats/pliant_format.h")
STRICT = ["-pedantic-errors", "-Wall", "-Wextra", "-Werror", "-fsyntax-only"]
C99 = ["-x", "c", "-std=c99"]
CPP11 = ["-x", "c++", "-std=c++11"]
# A binary constant: an extension in C99 and in C++11.
PLANTED = "static const int planted = 0b11;\n"


def compiles(compiler, root, language, source, report=True):
    paths = [f"-I{root}/{folder}" for folder in ("runtime", "runtime/gl", "formats")]
    command = [compiler, *language, *STRICT, *paths, "-"]
    result = subprocess.run(command, input=source, capture_output=True, text=True, check=False)
    if result.returncode != 0 and report:
        print(f"{' '.join(command)}\n{result.stderr}")
    return result.returncode == 0


def main(root, compiler):
    if not shutil.which(compiler):
        print(f"skipped: {compiler} is not installed")
        return 77
    good = True
    for language in (C99, CPP11):
        for header in HEADERS:
            include = f'#include "{root}/{header}"\n'
            twice = include + include + "int planted_use;\n"
            good = compiles(compiler, root, language, twice) and good
            if compiles(compiler, root, language, include + PLANTED, report=False):
                print(f"{header}: {language[-1]} let a binary constant pass")
                good = False
    sources = sorted(Path(root, "runtime").glob("**/*.c"))
    for path in sources:
        good = compiles(compiler, root, C99, f'#include "{path}"\n') and good
    print(f"{len(HEADERS)} headers as C99 and C++11, {len(sources)} sources as C99, {compiler}: {'good' if good else 'BAD'}")
    return 0 if good and sources else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), sys.argv[2]))
