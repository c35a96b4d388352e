#!/usr/bin/env python3
"""The page as a folder of static files: build.py [--package PACKAGE] FOLDER ASSET...

The assets are copied; the page opens creature.pliant first. FOLDER is new, empty, or a page that this script made before.
three.js comes from the npm registry. PACKAGE is the folder that runtime/bindings/web/build.py has made; without it, it is
made now. Any web server serves FOLDER:
python3 -m http.server --directory FOLDER
"""
import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
BINDING = HERE.parents[1] / "runtime/bindings/web/build.py"
PAGE = ["index.html", "example.html", "style.css", "page.js", "polygon.js", "view.js"]
THREE = ["build/three.module.js", "build/three.core.js", "examples/jsm/controls/OrbitControls.js", "LICENSE"]
PACKAGE = ["pliant.js", "pliant.wasm", "three.js", "LICENSE"]
STAMP = ".made_by_samples_web"


def copy(files, source, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name in files:
        shutil.copyfile(source / name, folder / Path(name).name)  # without the write protection that sources may have


def replace(page, folder):
    """Moves the files of the page to the folder, on the same file system."""
    for path in sorted(page.rglob("*")):
        target = folder / path.relative_to(page)
        if path.is_dir():
            target.mkdir(exist_ok=True)
        else:
            os.replace(path, target)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("assets", type=Path, nargs="*", metavar="ASSET")
    parser.add_argument("--package", type=Path)
    options = parser.parse_intermixed_args()
    names = [asset.name for asset in options.assets]
    for name in names:
        if name in PAGE or names.count(name) > 1 or not re.fullmatch(r"[\w.-]+", name, re.ASCII):
            parser.error(f"{name}: names of assets must differ, from those of the page, too, and have letters, digits, '_', "
                         "'.' and '-' only")
    folder = options.folder
    is_empty = folder.is_dir() and not any(folder.iterdir())
    if os.path.lexists(folder) and not (folder / STAMP).exists() and not is_empty:
        parser.error(f"{folder} is there, and is no page of this script: name a new folder")
    folder.mkdir(parents=True, exist_ok=True)
    (folder / STAMP).touch()
    with tempfile.TemporaryDirectory(prefix=".pliant-", dir=folder) as name:
        modules, page = Path(name), Path(name, "page")
        copy(["package.json", "package-lock.json"], HERE, modules)
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--silent", "--fetch-retries=1"],
                       cwd=modules, check=True)
        copy(THREE, modules / "node_modules/three", page / "three")
        package = options.package or modules / "package"
        if not options.package:
            subprocess.run([sys.executable, "-B", BINDING, package], check=True)
        copy(PACKAGE, package, page / "pliant")
        copy(PAGE, HERE, page)
        copy(options.assets, Path(), page)
        replace(page, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
