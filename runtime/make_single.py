#!/usr/bin/env python3
"""The runtime as one C file and one header: make_single.py FOLDER

Writes pliant.c and pliant.h into FOLDER. They need the C library only and compile as C99 and as C++11. pliant.h is a copy of
runtime/pliant.h; pliant.c holds runtime/*.c, their internal headers and formats/pliant_format.h. pliant_gl is not included.
Programs that read chunks by tag (pliant_asset_chunk) also need a copy of formats/pliant_format.h.
"""
import re
import shutil
import sys
from pathlib import Path

RUNTIME = Path(__file__).resolve().parent
ROOT = RUNTIME.parent
INCLUDE = re.compile(r'^#include "([^"]+)"$')
DEFINE = re.compile(r"^\s*#\s*define (\w+)", re.MULTILINE)

HEAD = """/* The Pliant runtime in one file, made of its sources by runtime/make_single.py: compile it with
   -O3 -ffp-contract=off -fno-math-errno -fno-trapping-math. The manual is pliant.h.

{licence} */

#include "pliant.h"
"""


def banner(path):
    return f"\n/* ==== {path.relative_to(ROOT).as_posix()} ==== */\n\n"


def find(name):
    return next(folder / name for folder in (RUNTIME, ROOT / "formats") if (folder / name).is_file())


def expanded(path, seen):
    """The text of a file, each of our headers put in where it is included first; `seen` has their names."""
    text = ""
    for line in path.read_text(encoding="utf-8").splitlines():
        match = INCLUDE.match(line)
        if not match:
            text += line + "\n"
        elif match.group(1) not in seen:
            seen.add(match.group(1))
            header = find(match.group(1))
            text += banner(header) + expanded(header, seen)
    return text


def without_macros(path):
    """Lines that take back the macros of a source, which are its own."""
    return "".join(f"#undef {name}\n" for name in dict.fromkeys(DEFINE.findall(path.read_text(encoding="utf-8"))))


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    if folder.resolve() == RUNTIME:
        sys.exit("make_single.py: FOLDER is that of the sources: name another one")
    folder.mkdir(parents=True, exist_ok=True)
    licence = (ROOT / "LICENSE").read_text(encoding="utf-8").strip()
    text, seen = HEAD.format(licence=licence), {"pliant.h"}
    for path in sorted(RUNTIME.glob("*.c")):
        text += banner(path) + expanded(path, seen) + "\n" + without_macros(path)
    (folder / "pliant.c").write_text(text, encoding="utf-8")
    shutil.copyfile(RUNTIME / "pliant.h", folder / "pliant.h")


if __name__ == "__main__":
    main()
