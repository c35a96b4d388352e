"""test_blender.py TOOL ASSET: Debian's Blender imports the GLB of `pliant export`: counts, names, animation, and with all weights at one
half the very shape."""
import json
import pathlib
import shutil
import subprocess
import sys

import numpy as np

from support import HERE, Glb, check, export, skip


def main():
    tool, asset = sys.argv[1:]
    program = shutil.which("blender")
    if not program:
        skip("blender is not installed (group engines of samples/install_packages.sh)")
    folder = pathlib.Path("blender").resolve()
    folder.mkdir(exist_ok=True)
    export(tool, asset, folder / "shape.glb")
    result = subprocess.run([program, "--background", "--factory-startup", "--python-exit-code", "9", "--python",
                             HERE / "blender_check.py", "--", folder / "shape.glb"], capture_output=True, text=True, timeout=300)
    lines = [line for line in result.stdout.splitlines() if line.startswith("REPORT ")]
    check(result.returncode == 0 and lines, f"exit code {result.returncode}: {result.stdout[-2000:]}{result.stderr[-2000:]}")
    report = json.loads(lines[0][len("REPORT "):])
    glb = Glb(folder / "shape.glb")
    shape = glb.shape(np.full(report["targets"], 0.5))
    names = glb.json["meshes"][0]["extras"]["targetNames"]
    check(report["vertices"] == len(shape), f"{report['vertices']} vertices")
    check(report["faces"] == len(glb.accessor(glb.primitive()["indices"])) // 3, f"{report['faces']} faces")
    check(report["names"] == names and report["curves"] == len(names), f"names {report['names']}, {report['curves']} curves")
    middle = np.array(report["middle"])
    turned = np.stack([shape[:, 0], -shape[:, 2], shape[:, 1]], axis=1)  # glTF's y is up, Blender's z
    diagonal = np.linalg.norm(shape.max(axis=0) - shape.min(axis=0))
    check(abs(middle - turned).max() < 1e-5 * diagonal, f"the shape differs by {abs(middle - turned).max() / diagonal}")
    print(json.dumps({key: report[key] for key in ("vertices", "faces", "targets", "curves")}))
    return 0


sys.exit(main())
