"""make_layers.py SET FOLDER: writes rest.ply and one PLY for each layer of a set, in double precision; the file's name is
the layer's. Sets: tube, ict7, face52, limbs8 (README.md). Data: PLIANT_DATA. Exit code 0 written, 77 no data."""
import argparse
import itertools
import math
import pathlib
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("layers", "paper", "baker/bake")]
import joints  # noqa: E402: bends limbs
import shapes  # noqa: E402: reads and writes triangles
from continuity import DATA  # noqa: E402

RINGS, SIDES = 121, 24
TUBE_LENGTH, RADII = 6.0, (0.7, 0.5)
TUBE_BEND = joints.Joint("bend", (0, 0, 6), (0, 0, 4), (0, 0, 1), (1, 0, 0), length=2.0, degrees=90)
TWIST_END, TWIST_DEGREES = 2.0, 90

FACE_SHAPES = ["blink_brow_down", "cheek_puff", "jaw_open", "pucker", "smile", "sneer_frown"]
FACE_LAYERS = 52
SEAM = 3.0  # centimetres, half the width of the strip where halves of a face fade

# The figure is 16.7 units tall and 15.9 wide, its face looks along z. Of two joints of a limb the outer one comes first.
LEFT_ELBOW = joints.Joint("left_elbow", (7.9, 5.3, 0), (3.7, 5.4, 0.13), (1, 0, 0), (0, 0, 1), length=1.4, degrees=90)
LEFT_KNEE = joints.Joint("left_knee", (1.7, -8.2, 0), (1.3, -2.8, 0.13), (0, -1, 0), (0, 0, -1), length=2.0, degrees=90)
LEFT_SHOULDER = joints.Joint("left_shoulder", (7.9, 5.3, 0), (1.75, 5.1, 0.1), (1, 0, 0), (0, -1, 0), length=1.7,
                             degrees=70)
LEFT_HIP = joints.Joint("left_hip", (1.7, -8.2, 0), (0.9, -0.1, 0.28), (0.34, -0.94, 0), (0.2, 0.05, 1), length=2.2,
                        degrees=60)
SPINE = joints.Joint("spine", (0, 8.5, 0), (0, 0.9, 0.5), (0, 1, 0), (0, 0, 1), length=2.4, degrees=60)
BODY_JOINTS = [LEFT_ELBOW, joints.mirrored(LEFT_ELBOW, "right_elbow"), LEFT_KNEE, joints.mirrored(LEFT_KNEE, "right_knee"),
               LEFT_SHOULDER, joints.mirrored(LEFT_SHOULDER, "right_shoulder"), LEFT_HIP, SPINE]


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def read_data(name):
    path = DATA / f"{name}.ply"
    return shapes.read_ply(path) if path.exists() else skip(f"no {path}: set PLIANT_DATA")


def straight_tube():
    ring, side = (axis.ravel() for axis in np.mgrid[:RINGS, :SIDES])
    around = 2 * math.pi * side / SIDES
    points = np.stack([RADII[0] * np.cos(around), RADII[1] * np.sin(around), TUBE_LENGTH * ring / (RINGS - 1)], axis=1)
    ring, side = (axis.ravel() for axis in np.mgrid[:RINGS - 1, :SIDES])
    a, b = ring * SIDES + side, ring * SIDES + (side + 1) % SIDES
    corners = [(a, b, b + SIDES), (a, b + SIDES, a + SIDES)]
    return points, np.concatenate([np.stack(triangle, axis=1) for triangle in corners])


def tube_shape(bend, twist):
    """The exact shape at these weights: the upper third bent, all of it above the lower third turned."""
    points, _ = straight_tube()
    turn = math.radians(TWIST_DEGREES) * twist * np.minimum(points[:, 2] / TWIST_END, 1)
    share = ((points[:, 2] - TUBE_BEND.start[2]) / TUBE_BEND.length).clip(0, 1)
    x, y, z = joints.bent(TUBE_BEND, points, share, bend).T
    return np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y, z], axis=1)


def tube():
    rest, triangles = straight_tube()
    return rest, triangles, {"bend": tube_shape(1, 0), "twist": tube_shape(0, 1)}


def ict7():
    rest, triangles = read_data("ict_face/neutral")
    return rest, triangles, {name: read_data(f"ict_face/{name}")[0] for name in FACE_SHAPES}


def halves(rest, changes):
    """Left and right half of each change; both together are the change."""
    place = ((rest[:, 0] / SEAM + 1) / 2).clip(0, 1)
    left = (place * place * (3 - 2 * place))[:, None]
    for name, change in changes.items():
        yield f"{name}_left", left * change
        yield f"{name}_right", change - left * change


def pairs(changes, wanted=lambda first, second: True):
    for first, second in itertools.combinations(changes, 2):
        if wanted(first, second):
            yield f"{first}_and_{second}", changes[first] + changes[second]


def have_other_shapes(first, second):
    """Both halves of one shape are that shape."""
    return first.rsplit("_", 1)[0] != second.rsplit("_", 1)[0]


def spread(items, count):
    """So many of the items, evenly over all of them."""
    return [items[i * len(items) // count] for i in range(count)]


def face52():
    """Shapes, halves, sums of two shapes, and as many sums of two halves as are missing. Only 12 changes of the 52 are
    linearly independent."""
    rest, triangles, layers = ict7()
    whole = {name: layer - rest for name, layer in layers.items()}
    half = dict(halves(rest, whole))
    changes = {**whole, **half, **dict(pairs(whole))}
    changes.update(spread(list(pairs(half, have_other_shapes)), FACE_LAYERS - len(changes)))
    return rest, triangles, {name: rest + change for name, change in changes.items()}


def limbs8_shape(weights, rest, triangles):
    """The exact shape at these weights: outer joints first."""
    points = rest
    for joint, weight in zip(BODY_JOINTS, weights):
        points = joints.bent(joint, points, joints.shares(joint, rest, triangles), weight)
    return points


def limbs8():
    rest, triangles = read_data("makehuman_body/tpose")
    unit = np.eye(len(BODY_JOINTS))
    return rest, triangles, {joint.name: limbs8_shape(row, rest, triangles) for joint, row in zip(BODY_JOINTS, unit)}


SETS = {"tube": tube, "ict7": ict7, "face52": face52, "limbs8": limbs8}


def write_set(name, folder):
    """Paths of the rest shape and of the layers."""
    rest, triangles, layers = SETS[name]()
    folder.mkdir(parents=True, exist_ok=True)
    files = {folder / f"{shape}.ply": points for shape, points in {"rest": rest, **layers}.items()}
    for file, points in files.items():
        shapes.write_ply(file, points, triangles, "double")
    return list(files)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("set", choices=list(SETS))
    parser.add_argument("folder", type=pathlib.Path)
    arguments = parser.parse_args()
    print(*write_set(arguments.set, arguments.folder), sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
