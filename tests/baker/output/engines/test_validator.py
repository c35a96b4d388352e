"""test_validator.py TOOL BUILD ASSET...: the Khronos validator finds no error and no warning in what `pliant export`
writes."""
import json
import pathlib
import sys

import numpy as np

from support import Glb, check, export, run_node

# Told about every file with our extension: a validator that does not know it cannot look into it, nor see that the view is
# used.
EXPECTED = ("UNSUPPORTED_EXTENSION", "UNUSED_OBJECT /bufferViews/", "UNUSED_OBJECT /buffers/0")
WITH_EXTENSION = {"--embed", "--meshopt"}
# The triangle that holds the box has no area, and nothing else has.
DEGENERATE = "contains 1 degenerate triangles"


def remarks(found, options):
    """What the validator says beyond what is known."""
    known = EXPECTED if WITH_EXTENSION & set(options) else ()
    return [m for m in found["messages"] if not m.startswith(known) and DEGENERATE not in m]


def bind_origin(glb, skin):
    """Joints at rest are unturned, so that a matrix moves a vertex by this less the joint's place."""
    bind = glb.accessor(skin["inverseBindMatrices"])[0].reshape(4, 4)
    return bind[3, :3] + glb.json["nodes"][skin["joints"][0]]["translation"]


def check_skin(glb):
    """Weights that sum to 1, joints that exist; at the first frame, pose 0, the joints take the mesh nearly nowhere."""
    skin = glb.json["skins"][0]
    weights, joints = glb.attribute("WEIGHTS_0"), glb.attribute("JOINTS_0").astype(int)
    check(len(skin["joints"]) == 4 and joints.max() < 4, f"{len(skin['joints'])} joints, {joints.max()} used")
    check(abs(weights.sum(axis=1) - 1).max() < 1e-5 and weights.min() >= 0, "weights of the skin")
    places = []
    for joint in range(4):
        channels = {c["target"]["path"]: c for c in glb.json["animations"][0]["channels"]
                    if c["target"]["node"] == skin["joints"][joint]}
        outputs = {path: glb.accessor(glb.json["animations"][0]["samplers"][c["sampler"]]["output"])[0].astype(float)
                   for path, c in channels.items()}
        x, y, z, w = outputs["rotation"]
        turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
        bind = glb.accessor(skin["inverseBindMatrices"])[joint].reshape(4, 4).T.astype(float)
        places.append((glb.attribute("POSITION") @ bind[:3, :3].T + bind[:3, 3]) @ turn.T + outputs["translation"])
    found = sum(weights[:, i, None] * np.array(places)[joints[:, i], np.arange(len(weights))] for i in range(4))
    # In integers the matrices hold the step of the grid and its origin.
    step = np.cbrt(np.linalg.det(glb.accessor(skin["inverseBindMatrices"])[0].reshape(4, 4)[:3, :3].astype(float)))
    origin = bind_origin(glb, skin)
    rest = step * glb.attribute("POSITION") + origin
    size = np.ptp(rest, axis=0).max()
    check(abs(found - rest).max() < 0.05 * size, f"frame 0 moves {abs(found - rest).max()}")


def check_embedded(path, asset):
    """The asset, byte for byte, at a page of the file, where the extension says."""
    glb = Glb(path)
    extension = glb.json["meshes"][0]["extensions"]["PLIANT_elastic_blend"]
    check(glb.start % 4096 == 0 and glb.json["bufferViews"][extension["bufferView"]]["byteOffset"] == 0, f"{path}: place")
    check(glb.view(extension["bufferView"]) == asset.read_bytes(), f"{path}: not the asset")


def main():
    tool, build, *assets = sys.argv[1:]
    folder = pathlib.Path("validator")
    folder.mkdir(exist_ok=True)
    files = {}
    for path in assets:
        for options in ([], ["--embed"], ["--embed", "--morph"], ["--skin", "4"], ["--quantize", "1e-4"],
                        ["--quantize", "1e-4", "--no-normals"], ["--quantize", "1e-4", "--skin", "4"],
                        ["--meshopt", "--skin", "2", "--embed"]):
            output = folder / (pathlib.Path(path).stem + "".join(options).replace(" ", "") + ".glb")
            export(tool, path, output, *options)
            files[str(output.resolve())] = options
    for form in ("", "--quantize1e-4"):
        check_skin(Glb(folder / f"{pathlib.Path(assets[0]).stem}{form}--skin4.glb"))
    check_embedded(folder / f"{pathlib.Path(assets[0]).stem}--embed.glb", pathlib.Path(assets[0]))
    report = json.loads(run_node(build, "validate.mjs", *files))
    check(set(report) == set(files), "the validator answered about other files")
    for path, found in report.items():
        check(found["errors"] == 0 and found["warnings"] == 0 and not remarks(found, files[path]), f"{path}: {found}")
    print(f"{len(report)} files: no errors, no warnings")
    return 0


if __name__ == "__main__":
    sys.exit(main())
