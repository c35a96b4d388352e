"""test_blender.py TOOL ASSET: Debian's Blender imports the GLB of `pliant export`: counts, names, animation, and with all
weights at one half the very shape."""
import json
import pathlib
import sys

import numpy as np

from support import Glb, blender, blender_report, check, export, skip


def main():
    tool, asset = sys.argv[1:]
    program = blender()
    if not program:
        skip("blender is not installed (group engines of samples/install_packages.sh)")
    folder = pathlib.Path("blender").resolve()
    folder.mkdir(exist_ok=True)
    export(tool, asset, folder / "shape.glb")
    report = blender_report(program, folder / "shape.glb")
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
