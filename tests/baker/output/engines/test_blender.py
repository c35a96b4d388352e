"""test_blender.py TOOL ASSET...: Debian's Blender imports the GLB of `pliant export`, in floats and in integers: counts,
names, animation, and with all weights at one half the very shape. The recipe of samples/README.md sets the weights of poses.
"""
import json
import pathlib
import sys

import numpy as np

from support import Glb, blender, blender_report, check, export, skip, weight_count
from test_pose_table import evaluated, recipe


def main():
    tool, *assets = sys.argv[1:]
    program = blender()
    if not program:
        skip("blender is not installed (group engines of samples/install_packages.sh)")
    folder = pathlib.Path("blender").resolve()
    folder.mkdir(exist_ok=True)
    (folder / "recipe.py").write_text(recipe("python", "def set_poses"))
    for asset, options in [(assets[0], []), (assets[0], ["--quantize", "1e-4"]), *((asset, []) for asset in assets[1:])]:
        export(tool, asset, folder / "shape.glb", *options)
        check_file(Glb(folder / "shape.glb"), blender_report(program, folder / "shape.glb", folder / "recipe.py"))
    return 0


def check_file(glb, report):
    shape = glb.placed(glb.shape(np.full(report["targets"], 0.5)))
    names = glb.json["meshes"][0]["extras"]["targetNames"]
    # Blender keeps the two corners of the box and drops their face, which has no area.
    check(report["vertices"] == len(shape) + 2, f"{report['vertices']} vertices")
    check(report["faces"] == len(glb.accessor(glb.primitive()["indices"])) // 3 - 1, f"{report['faces']} faces")
    check(report["names"] == names and report["curves"] == len(names), f"names {report['names']}, {report['curves']} curves")
    middle = np.array(report["middle"])[:len(shape)]
    turned = np.stack([shape[:, 0], -shape[:, 2], shape[:, 1]], axis=1)  # glTF's y is up, Blender's z
    diagonal = np.linalg.norm(shape.max(axis=0) - shape.min(axis=0))
    check(abs(middle - turned).max() < 1e-5 * diagonal, f"the shape differs by {abs(middle - turned).max() / diagonal}")
    pliant = glb.json["meshes"][0]["extras"]["pliant"]
    wanted = evaluated(pliant, [0.5, 0.25] + [0] * (weight_count(pliant) - 2))
    check(abs(wanted - report["driven"]).max() < 1e-5, f"the recipe sets {report['driven']}, not {wanted}")
    print(json.dumps({key: report[key] for key in ("vertices", "faces", "targets", "curves")}))


sys.exit(main())
