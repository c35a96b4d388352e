"""rival.py [--tool PLIANT] [--only TEXT]: layers whose weights have the sum 1 beside averages, unreduced, as a Markdown
table; README.md has it and explains the columns. Layers are the model of Froehlich and Botsch 2011 with a metric in place of
edge lengths; pose 0 is their rest shape, and its weight is what the others leave. Data: PLIANT_DATA; sets that are not there
are left out. The creature is made by the program `creature` of the tool's build folder."""
import argparse
import pathlib
import resource
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / part) for part in ("tests/paper", "tests/baker/bake", "samples/pictures")]
import make_moving_pictures  # noqa: E402: makes bars
import shapes  # noqa: E402: reads and writes triangles, compares shapes
from continuity import DATA, files, line, run  # noqa: E402

HEAD = ["set", "poses", "vertices", "layers from averages, mean / largest", "strain %: linear / averages / layers",
        "angles: linear / averages / layers", "jumps: averages / layers", "processor seconds a shape: averages / layers"]
BLENDS = ("average", "layers")
STEPS = 21
BAR_LENGTH, BAR_DEGREES = 4.4, 150


def bar(_, folder):
    """A square bar, twisted to either side."""
    points, quads = make_moving_pictures.bar_surface(cells=10, layers=44, length=BAR_LENGTH)
    triangles = np.array(quads)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    paths = [folder / f"bar_{degrees}.ply" for degrees in (-BAR_DEGREES, BAR_DEGREES)]
    for path, sign in zip(paths, (-1, 1)):
        pose = np.array(list(make_moving_pictures.twisted(points, BAR_LENGTH, sign * BAR_DEGREES)))
        shapes.write_ply(path, pose, triangles, "double")
    return paths


def creature(tool, folder):
    program = tool.parents[1] / "samples" / "creature" / "creature"
    if not program.exists():
        return []
    subprocess.run([program, "-o", folder, "--vertices", "8000"], check=True, stdout=subprocess.DEVNULL)
    return [folder / f"creature_{pose}.ply" for pose in make_moving_pictures.CREATURE_POSES]


def data(*names):
    return lambda tool, folder: [DATA / path for path in files(*names)]


SETS = {"bar, twisted both ways": bar, "human_pair": data("human_pair", "man", "woman"),
        "makehuman": data("makehuman_body", "tpose", "walk1_f03", "zombieWalk1_f20"),
        "ict_face": data("ict_face", "neutral", "smile", "jaw_open", "pucker"), "creature": creature}


def some_weights(count):
    """Equal weights, and three quarters of one pose."""
    rest = 0.25 / (count - 1)
    return np.concatenate([np.full((1, count), 1 / count), np.full((count, count), rest) + (0.75 - rest) * np.eye(count)])


def path_weights(count):
    """From the last pose straight to equal weights of the others."""
    share = np.linspace(0, 1, STEPS)[:, None]
    return np.hstack([np.tile(share / (count - 1), count - 1), 1 - share])


def blended(tool, blend, poses, weights, folder):
    """The shapes at rows of weights, and processor seconds of one; none if the tool finds one of them nowhere."""
    rows = weights if blend == "average" else weights[:, 1:]
    np.savetxt(folder / "path.csv", rows, fmt="%.17g", delimiter=",")
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    result = run(tool, "average", *poses, "--blend", blend, "--path", folder / "path.csv", "-o", folder / "shape_%d.ply")
    if result.returncode != 0:
        print(result.stderr, file=sys.stderr)
        return [], 0
    seconds = (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before) / len(rows)
    return [shapes.read_ply(folder / f"shape_{i}.ply")[0] for i in range(len(rows))], seconds


def metrics(points, triangles):
    """Of each triangle E, F and G, the scalar products of two edges."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    u, v = b - a, c - a
    return (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)


def squared_strain(pose, shape):
    """Sum of the squared logarithms of the principal stretches between metrics."""
    (e0, f0, g0), (e, f, g) = pose, shape
    tiny = 1e-12
    determinant = e0 * g0 - f0 * f0
    half_trace = (g0 * e - 2 * f0 * f + e0 * g) / (2 * determinant)
    product = np.maximum((e * g - f * f) / determinant, tiny)
    larger = half_trace + np.sqrt(np.maximum(half_trace**2 - product, 0))
    return sum(np.log(np.maximum(eigenvalue, tiny))**2 for eigenvalue in (larger, product / larger)) / 4


def hinges_of(triangles):
    """Edges between two triangles: their ends, and the two triangles."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    ends = np.sort(edges, axis=1)
    order = np.lexsort(ends.T)
    first, second = order[:-1], order[1:]
    is_pair = (ends[first] == ends[second]).all(axis=1)
    return edges[first[is_pair]], first[is_pair] // 3, second[is_pair] // 3


def angles(points, triangles, hinges):
    """Signed angles between the normals at hinges."""
    edges, first, second = hinges
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    axis = points[edges[:, 1]] - points[edges[:, 0]]
    axis /= np.maximum(np.linalg.norm(axis, axis=1), 1e-30)[:, None]
    sine = (np.cross(normals[first], normals[second]) * axis).sum(axis=1)
    return np.arctan2(sine, (normals[first] * normals[second]).sum(axis=1))


def distortion(shape, poses, triangles, hinges):
    """What no pose shows: strain in per cent (root mean square) and degrees of hinges (mean), each triangle and hinge
    against the pose where it is most alike."""
    area = np.mean([np.sqrt(e * g - f * f) for e, f, g in (metrics(pose, triangles) for pose in poses)], axis=0)
    strain = np.min([squared_strain(metrics(pose, triangles), metrics(shape, triangles)) for pose in poses], axis=0)
    bends = [angles(pose, triangles, hinges) - angles(shape, triangles, hinges) for pose in poses]
    bend = np.min(np.abs([np.arctan2(np.sin(b), np.cos(b)) for b in bends]), axis=0)
    return 100 * np.sqrt(np.average(strain, weights=area)), np.degrees(bend.mean())


def jump(path, masses):
    """The largest step of a path by its mean one."""
    steps = [shapes.relative_l2(a, b, masses) for a, b in zip(path, path[1:])]
    return max(steps) / np.mean(steps)


def distances(found, masses):
    return [shapes.relative_l2(layers, average, masses) for average, layers in zip(found["average"], found["layers"])]


def linear_blends(poses, weights, masses):
    aligned = [shapes.align(pose, poses[0], masses) for pose in poses]
    return list(np.tensordot(weights, aligned, axes=1))


def row(tool, name, paths, folder):
    meshes = [shapes.read_ply(path) for path in paths]
    poses, triangles = [points for points, _ in meshes], meshes[0][1]
    masses = np.mean([shapes.lumped_masses(*mesh) for mesh in meshes], axis=0)
    some = some_weights(len(poses))
    weights = np.concatenate([some, path_weights(len(poses))])
    found, seconds = {"linear": linear_blends(poses, some, masses)}, []
    for blend in BLENDS:
        found[blend], time_of_one = blended(tool, blend, paths, weights, folder)
        seconds.append(f"{time_of_one:.2f}")
        if not found[blend]:
            return [name, str(len(poses)), str(len(masses)), f"no {blend}", *["-"] * (len(HEAD) - 4)]
    away = distances(found, masses)
    hinges = hinges_of(triangles)
    worse = [np.mean([distortion(shape, poses, triangles, hinges) for shape in found[way][:len(some)]], axis=0)
             for way in ("linear", *BLENDS)]
    jumps = [f"{jump(found[blend][len(some):], masses):.2f}" for blend in BLENDS]
    return [name, str(len(poses)), str(len(masses)), f"{np.mean(away):.1e} / {np.max(away):.1e}",
            " / ".join(f"{strain:.2f}" for strain, _ in worse), " / ".join(f"{bend:.2f}" for _, bend in worse),
            " / ".join(jumps), " / ".join(seconds)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "baker" / "pliant")
    parser.add_argument("--only", default="", help="sets whose name holds this")
    arguments = parser.parse_args()
    print(line(HEAD), line(["---"] * len(HEAD)), sep="\n", flush=True)
    for name, make in SETS.items():
        if arguments.only not in name:
            continue
        with tempfile.TemporaryDirectory(prefix="pliant-rival-") as folder:
            paths = make(arguments.tool, pathlib.Path(folder))
            if paths and all(path.exists() for path in paths):
                print(line(row(arguments.tool, name, paths, pathlib.Path(folder))), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
