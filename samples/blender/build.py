#!/usr/bin/env python3
"""The add-on as a zip that Blender installs: build.py OUT.zip"""
import os
import re
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGE = HERE / "pliant_blender"
HEADER = HERE.parents[1] / "runtime/pliant.h"
PLACES = {"__init__.py": ("(0, 0, 0)", "({}, {}, {})"), "blender_manifest.toml": ('"0.0.0"', '"{}.{}.{}"')}


def content(path, version):
    """A file of the package, with the version of the project."""
    text = path.read_text(encoding="utf-8")
    if path.name in PLACES:
        place, form = PLACES[path.name]
        if text.count(place) != 1:
            sys.exit(f"{path}: {place} is to be there once, for the version")
        text = text.replace(place, form.format(*version))
    return text


def main(output):
    version = re.findall(r"^#define PLIANT_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", HEADER.read_text(), re.M)
    with tempfile.TemporaryDirectory(prefix=".pliant-", dir=output.parent) as folder:
        made = Path(folder, output.name)
        with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in [*sorted([*PACKAGE.glob("*.py"), *PACKAGE.glob("*.toml")]), HERE.parents[1] / "LICENSE"]:
                entry = zipfile.ZipInfo.from_file(path, f"{PACKAGE.name}/{path.name}")
                entry.external_attr = 0o644 << 16  # for all users to read, whatever the umask
                archive.writestr(entry, content(path, version), zipfile.ZIP_DEFLATED)
        os.replace(made, output)
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2 or not sys.argv[1].endswith(".zip"):
        sys.exit(__doc__)
    sys.exit(main(Path(sys.argv[1])))
