#!/usr/bin/env python3
"""The API reference builds without a warning: docs.py SOURCE_DIR [--planted]

Every function, type, field and constant of the public headers is documented, and what the comments refer to exists.
With --planted an undocumented function and a wrong reference are put into a copy and must be reported.
Exit code 77: no doxygen."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile


def complaints(root, out):
    """What doxygen says about the headers below `root`, a line each, and its exit code."""
    environment = dict(os.environ, PLIANT_DOCS_OUT=str(out))
    answer = subprocess.run(["doxygen", "runtime/docs/Doxyfile"], cwd=root, env=environment, capture_output=True, text=True)
    return answer.returncode, (answer.stdout + answer.stderr).strip().splitlines()


def plant(source, copy):
    """A copy of what doxygen reads, with two faults."""
    for path in ("runtime/docs", "runtime/pliant.h", "runtime/gl/pliant_gl.h"):
        target = copy / path
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copytree(source / path, target) if (source / path).is_dir() else shutil.copy(source / path, target)
    header = copy / "runtime/pliant.h"
    faults = "int pliant_planted(void);\n\n/** As @ref pliant_no_such_function. */\nint pliant_wrong(void);\n"
    text = header.read_text()
    place = text.rindex("#ifdef __cplusplus")
    header.write_text(text[:place] + faults + text[place:])


def main():
    source = pathlib.Path(sys.argv[1]).resolve()
    if not shutil.which("doxygen"):
        print("skipped: no doxygen (bash samples/install_packages.sh tests)")
        return 77
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        out = folder / "out"
        out.mkdir()
        if "--planted" not in sys.argv:
            code, lines = complaints(source, out)
            print("\n".join(lines) or "no warnings")
            page = out / "html" / "pliant_8h.html"
            return 0 if code == 0 and not lines and "pliant_solver_init" in page.read_text() else 1
        plant(source, folder / "copy")
        code, lines = complaints(folder / "copy", out)
        print("\n".join(lines))
        found = all(any(name in line for line in lines) for name in ("pliant_planted", "pliant_no_such_function"))
        return 0 if code != 0 and found else 1


if __name__ == "__main__":
    sys.exit(main())
