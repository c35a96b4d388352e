#!/usr/bin/env python3
"""The page as a folder of static files: build.py FOLDER PACKAGE ASSET...

PACKAGE is the folder that runtime/bindings/web/build.py makes. The assets are copied; the page opens creature.pliant first.
three.js comes from the npm registry. Any web server serves FOLDER: python3 -m http.server --directory FOLDER
"""
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PAGE = ["index.html", "example.html", "style.css", "page.js", "polygon.js", "view.js"]
THREE = ["build/three.module.js", "build/three.core.js", "examples/jsm/controls/OrbitControls.js", "LICENSE"]
PACKAGE = ["pliant.js", "pliant.wasm", "three.js", "LICENSE"]


def copy(files, source, folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name in files:
        shutil.copy(source / name, folder)


def main(folder, package, *assets):
    with tempfile.TemporaryDirectory() as name:
        modules = Path(name)
        copy(["package.json", "package-lock.json"], HERE, modules)
        subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--silent", "--fetch-retries=1"],
                       cwd=modules, check=True)
        copy(THREE, modules / "node_modules/three", folder / "three")
    copy(PAGE, HERE, folder)
    copy(PACKAGE, package, folder / "pliant")
    copy(assets, Path(), folder)
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(*map(Path, sys.argv[1:])))
