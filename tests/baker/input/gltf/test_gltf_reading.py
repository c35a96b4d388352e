"""test_gltf_reading.py TOOL CHECKOUT: poses from glTF files, against an evaluator of our own (gltf_reference.py): files made
here, and the real ones of PLIANT_DATA where they are. TOOL is read_poses_tool."""
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

TOOL, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])
sys.path[:0] = [str(ROOT / "tests/bad_input"), str(pathlib.Path(__file__).parent)]

import gltf_files  # noqa: E402
import gltf_reference  # noqa: E402

DATA = pathlib.Path(os.environ.get("PLIANT_DATA", ROOT.parent / "shared/data"))
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text)
    if not condition:
        failures.append(text)


class Poses:
    def __init__(self, folder, *arguments):
        for old in folder.iterdir():
            old.unlink()
        result = subprocess.run([TOOL, folder, *map(str, arguments)], capture_output=True, text=True, timeout=120)
        self.code, self.errors = result.returncode, result.stderr
        self.lines = [line.rsplit(" ", 3) for line in result.stdout.splitlines()]
        self.names = [line[0][5:] for line in self.lines]
        self.positions = [np.fromfile(folder / f"{k}.positions").reshape(-1, 3) for k in range(len(self.lines))]
        read = {name: np.fromfile(folder / name, dtype)
                for name, dtype in (("triangles", np.uint32), ("normals", np.float32))
                if (folder / name).exists()}
        self.triangles, self.normals = read.get("triangles"), read.get("normals")

    def counts(self):
        return [tuple(map(int, line[1:])) for line in self.lines]


def difference(a, b):
    """Largest distance relative to the size of the scene."""
    return np.abs(a - b).max() / np.linalg.norm(np.ptp(b, axis=0)) if a.shape == b.shape else math.inf


# float32 in the files, doubles on both sides: what is left is the rounding of sums.
TOLERANCE = 1e-5


def compare(folder, path, animation, times):
    poses = Poses(folder, f"{path}#animation={animation}@" + ",".join(map(str, times)), f"{path}#rest")
    check(poses.code == 0 and len(poses.lines) == len(times) + 1, f"{path.name} {animation}: read {poses.errors[:300]}")
    file = gltf_reference.File(path)
    for seconds, p in zip(times, poses.positions):
        off = difference(p, gltf_reference.positions(file, animation, seconds))
        check(off < TOLERANCE, f"{path.name} {animation} at {seconds}: {off:.1e} off")
    off = difference(poses.positions[-1], gltf_reference.positions(file))
    check(off < TOLERANCE, f"{path.name} at rest: {off:.1e} off")


def grid(n=4):
    vertices = [(x / n, y / n, 0.0) for x in range(n + 1) for y in range(n + 1)]
    faces = [(a, a + n + 1, a + n + 2) for x in range(n) for y in range(n) for a in [x * (n + 1) + y]]
    return vertices, faces + [(a, a + n + 2, a + 1) for a, _, _ in faces]


def interpolations(folder, scratch):
    """Every interpolation of every property, nodes in nodes, two instances of one mesh."""
    gltf = gltf_files.Gltf()
    vertices, faces = grid()
    gltf.mesh(vertices, faces, [[(0, 0, x * y) for x, y, _ in vertices], [(y, 0, 0) for x, y, _ in vertices]],
              ["up", "side"])
    gltf.json["nodes"] = [{"children": [1, 2], "scale": [1, 2, 1]}, {"mesh": 0, "translation": [1, 0, 0]},
                          {"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}]
    turn = [(0, 0, 0, 1), (0, math.sin(0.6), 0, math.cos(0.6)), (0, 0, -math.sin(1.0), -math.cos(1.0))]
    flat = [(0, 0, 0, 0), (0.1, 0, 0, 0), (0, 0.2, 0, 0)]
    gltf.animation("linear", (1, "rotation", "LINEAR", [0.5, 1, 2], turn),
                   (0, "translation", "LINEAR", [0, 2], [(0, 0, 0), (1, 2, 3)]),
                   (1, "weights", "LINEAR", [0, 2], [0, 1, 1, 0]), (1, "scale", "LINEAR", [0, 1], [(1, 1, 1), (2, 1, 3)]))
    gltf.animation("step", (1, "rotation", "STEP", [0.5, 1, 2], turn), (2, "weights", "STEP", [0, 1], [0, 1, 0.5, 0.25]))
    gltf.animation("cubic",
                   (1, "rotation", "CUBICSPLINE", [0.5, 1, 2], [row for q, t in zip(turn, flat) for row in (t, q, t)]),
                   (0, "translation", "CUBICSPLINE", [0, 2],
                    [(0, 0, 0), (0, 0, 0), (1, 0, 0), (0, 3, 0), (1, 2, 3), (0, 0, 0)]),
                   (2, "weights", "CUBICSPLINE", [0, 2], [0, 0, 0, 0.5, 1, 0, 0, 2, 1, 0, 0, 0]))
    path = folder / "interpolations.glb"
    path.write_bytes(gltf.glb())
    for name in ("linear", "step", "cubic"):
        compare(scratch, path, name, [0, 0.25, 0.5, 0.8, 1, 1.7, 2, 3])
    poses = Poses(scratch, path)
    check(poses.names == ["interpolations", "up", "side"], f"names {poses.names}")
    check(poses.counts()[0] == (50, 64, 2), f"two instances {poses.counts()}")
    off = difference(poses.positions[2], gltf_reference.positions(gltf_reference.File(path), target="side"))
    check(off < TOLERANCE, f"a target alone: {off:.1e} off")
    by_number = Poses(scratch, f"{path}#animation=2@0.8", f"{path}#animation=cubic@0.8")
    check(len(by_number.positions) == 2 and np.array_equal(*by_number.positions), "an animation by number")


def frames(folder, scratch):
    """The decimal times of keys, which are in single precision, mean these keys and nothing before them."""
    gltf = gltf_files.Gltf()
    gltf.mesh(*grid())
    gltf.animation("frames", (0, "translation", "STEP", [k / 24 for k in range(25)], [(k, 0, 0) for k in range(25)]))
    path = folder / "frames.glb"
    path.write_bytes(gltf.glb())
    for digits in (6, 17):
        times = ",".join(f"{k / 24:.{digits}g}" for k in range(25))
        poses = Poses(scratch, f"{path}#animation=frames@{times}")
        check([p[0, 0] for p in poses.positions] == list(range(25)) and not poses.errors, f"keys by {digits} digits")
    end = gltf_files.Gltf()
    end.mesh(*grid())
    end.animation("end", (0, "translation", "STEP", [0, 0.7], [(0, 0, 0), (1, 0, 0)]))
    path.write_bytes(end.glb())
    poses = Poses(scratch, f"{path}#animation=end@0,0.7")
    check([p[0, 0] for p in poses.positions] == [0, 1] and not poses.errors, f"the last key: {poses.errors}")


def boxes(folder, scratch):
    """The box behind the vertices of an export is left out; one that another program moved is not, nor are faces."""
    vertices, faces = grid()
    count, box = len(vertices), [(-9, -9, -9), (9, 9, 9)]
    order = list(range(count + 2))
    for name, swapped, wanted in (("behind", [], (count, len(faces))), ("moved", [0, count], (count + 2, len(faces) + 1))):
        if swapped:
            order[swapped[0]], order[swapped[1]] = swapped[1], swapped[0]
        gltf = gltf_files.Gltf()
        primitive = gltf.mesh([(vertices + box)[i] for i in order],
                              [tuple(order.index(v) for v in face) for face in faces + [(count, count + 1, count)]])
        primitive["extras"] = {"pliant": {"vertex_count": count}}
        path = folder / f"{name}.glb"
        path.write_bytes(gltf.glb())
        poses = Poses(scratch, path, path)
        check(poses.counts()[0][:2] == wanted, f"a box {name}: {poses.counts()} {poses.errors[:200]}")


def encodings(folder, scratch):
    """The same mesh in other encodings gives the same positions and triangles."""
    vertices, faces = grid()
    count = len(vertices)
    plain = gltf_files.Gltf()
    plain.mesh(vertices, faces)
    (folder / "plain.glb").write_bytes(plain.glb())
    wanted = Poses(scratch, folder / "plain.glb", folder / "plain.glb")

    def same(name, gltf, order=None):
        (folder / name).write_bytes(gltf.glb())
        got = Poses(scratch, folder / name, folder / name)
        alike = (got.code == 0 and got.positions[0].shape == wanted.positions[0].shape
                 and np.array_equal(got.positions[0], wanted.positions[0]))
        check(alike and (order is None or got.triangles.reshape(-1, 3).tolist() == order), f"{name} {got.errors[:200]}")

    sparse = gltf_files.Gltf()
    primitive = sparse.mesh([(9, 9, 9) if i in (3, 7) else v for i, v in enumerate(vertices)], faces)
    sparse.json["accessors"][primitive["attributes"]["POSITION"]]["sparse"] = {
        "count": 2, "indices": {"bufferView": sparse.view(bytes([3, 7])), "componentType": 5121},
        "values": {"bufferView": sparse.view(np.array([vertices[3], vertices[7]], "<f4").tobytes())}}
    same("sparse.glb", sparse)

    # Of zeros that all are replaced: without a view, which the specification allows.
    alone = gltf_files.Gltf()
    primitive = alone.mesh(vertices, faces)
    accessor = alone.json["accessors"][primitive["attributes"]["POSITION"]]
    accessor["sparse"] = {
        "count": len(vertices), "values": {"bufferView": accessor.pop("bufferView")},
        "indices": {"bufferView": alone.view(np.arange(len(vertices), dtype="<u4").tobytes()), "componentType": 5125}}
    same("sparse_alone.glb", alone)

    named = gltf_files.Gltf()
    primitive = named.mesh(vertices, faces, [vertices, vertices])
    primitive["extras"] = {"targetNames": ["Blink", "Joy"]}  # as exporters of VRM write them
    (folder / "named.vrm").write_bytes(named.glb())
    names = Poses(scratch, folder / "named.vrm").names
    check(names[1:] == ["Blink", "Joy"], f"names of targets in a primitive {names}")

    still = gltf_files.Gltf()
    still.mesh(vertices, faces)
    still.animation("still", (0, "translation", "LINEAR", [0, 1], [(0, 0, 0)] * 2))
    del still.json["accessors"][-1]["bufferView"]  # zeros, as gltf-transform stores them
    (folder / "still.glb").write_bytes(still.glb())
    got = Poses(scratch, f"{folder / 'still.glb'}#animation=still@0,1")
    check(got.code == 0 and np.array_equal(got.positions[1], wanted.positions[0]), f"still.glb {got.errors[:200]}")

    strided = gltf_files.Gltf()
    primitive = strided.mesh(vertices, faces)
    accessor = strided.json["accessors"][primitive["attributes"]["POSITION"]]
    accessor["bufferView"] = strided.view(b"".join(b"skip" + np.array(v, "<f4").tobytes() for v in vertices))
    accessor["byteOffset"] = 4
    strided.json["bufferViews"][accessor["bufferView"]]["byteStride"] = 16
    same("strided.glb", strided)

    quantised = gltf_files.Gltf()
    primitive = quantised.mesh(vertices, faces)
    primitive["attributes"]["POSITION"] = quantised.accessor([(int(255 * x), int(255 * y), 0, 0) for x, y, _ in vertices],
                                                             5121, normalized=True)
    quantised.json["accessors"][-1]["type"] = "VEC3"
    quantised.json["bufferViews"][-1]["byteStride"] = 4
    quantised.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    (folder / "quantised.glb").write_bytes(quantised.glb())
    got = Poses(scratch, folder / "quantised.glb", folder / "quantised.glb")
    check(got.code == 0 and np.abs(got.positions[0] - wanted.positions[0]).max() < 1 / 255,
          f"quantised positions {got.errors[:200]}")

    corners = gltf_files.Gltf()
    positions = corners.accessor([vertices[i] for f in faces for i in f])
    corners.json["meshes"] = [{"primitives": [{"attributes": {"POSITION": positions}}]}]
    (folder / "corners.glb").write_bytes(corners.glb())
    got = Poses(scratch, folder / "corners.glb", folder / "corners.glb")
    check(got.code == 0 and got.triangles.tolist() == list(range(3 * len(faces))),
          "without indices corners are vertices 0, 1, 2, ...")

    for mode, order in ((5, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]), (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0]])):
        other = gltf_files.Gltf()
        primitive = other.mesh(vertices, faces)
        primitive.update(mode=mode, indices=other.accessor(range(5), 5123))
        same(f"mode{mode}.glb", other, order)

    for name in ("mirrored", "mirrored_skin", "mirrored_bind"):
        mirrored = gltf_files.Gltf()
        is_bound = name == "mirrored_bind"  # as Blender does it: the vertices hold the mirror, joints move none at rest
        turned = [face[::-1] for face in faces] if is_bound else faces
        primitive = mirrored.mesh(vertices, turned, NORMAL=mirrored.accessor([(0, 0, 1)] * count))
        mirrored.json["nodes"][0]["scale"] = [-2, 1, 1]
        if name != "mirrored":  # a joint below the mirrored node
            primitive["attributes"]["JOINTS_0"] = mirrored.accessor([(0, 0, 0, 0)] * count, 5121)
            primitive["attributes"]["WEIGHTS_0"] = mirrored.accessor([(1, 0, 0, 0)] * count)
            mirrored.json["nodes"] = [{**mirrored.json["nodes"][0], "skin": 0, "children": [1]}, {}]
            mirrored.json["skins"] = [{"joints": [1]}]
            if is_bound:
                inverse = (-0.5, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
                mirrored.json["skins"][0]["inverseBindMatrices"] = mirrored.accessor([inverse])
        (folder / f"{name}.glb").write_bytes(mirrored.glb())
        got = Poses(scratch, folder / f"{name}.glb", folder / f"{name}.glb")
        p, t = got.positions[0], got.triangles.reshape(-1, 3)
        outside = np.cross(p[t[:, 1]] - p[t[:, 0]], p[t[:, 2]] - p[t[:, 0]])[:, 2]
        check((outside > 0).all() and np.allclose(got.normals.reshape(-1, 3), [0, 0, 1]), f"{name}: the outside stays there")


COUNTS = { # vertices, triangles, parts; poses without a choice (SOURCE.txt beside the files)
    "gltf_morph/AnimatedMorphCube.glb": (24, 12, 1, 3), "gltf_morph/AnimatedMorphSphere.glb": (1876, 960, 1, 3),
    "gltf_morph/MorphStressTest.gltf": (1528, 2412, 2, 9), "gltf_morph/RobotExpressive.glb": (7214, 3237, 19, 4),
    "gltf_morph/ict_face_14targets.glb": (14062, 28068, 1, 15), "gltf_skin/CesiumMan.glb": (3273, 4672, 1, 1),
    "gltf_skin/CesiumMan/CesiumMan.gltf": (3273, 4672, 1, 1), "gltf_skin/Fox.glb": (1728, 576, 1, 1),
    "gltf_skin/Trex.glb": (3496, 1820, 5, 1), "gltf_skin/Wolf.glb": (3994, 1962, 4, 1),
    "gltf_draco/AnimatedMorphSphere_draco.glb": (1876, 960, 1, 3),
    "gltf_draco/MorphStressTest_draco.glb": (1528, 2412, 2, 9),
    "gltf_draco/ict_face_14targets_draco.glb": (14062, 28068, 1, 15), "gltf_draco/CesiumMan_draco.glb": (3572, 4672, 1, 1),
    "gltf_draco/Enemy_Small-transformed.glb": (1436, 1856, 1, 1),
    "gltf_draco/Mech_FinnTheFrog-transformed.glb": (6269, 5846, 1, 1)}


def real_files(scratch):
    for name, (vertices, triangles, parts, pose_count) in COUNTS.items():
        poses = Poses(scratch, DATA / name, DATA / name)
        check(poses.counts() == [(vertices, triangles, parts)] * (2 * pose_count),
              f"{name}: {poses.counts()[:1]} {poses.errors[:200]}")
    skins, morphs = DATA / "gltf_skin", DATA / "gltf_morph"
    compare(scratch, skins / "Fox.glb", "Run", [0, 0.3, 0.6])
    compare(scratch, skins / "Wolf.glb", gltf_reference.File(skins / "Wolf.glb").json["animations"][3]["name"],
            [0, 0.4, 1.1])
    compare(scratch, morphs / "RobotExpressive.glb", "Walking", [0.1, 0.5])
    compare(scratch, morphs / "AnimatedMorphCube.glb",
            gltf_reference.File(morphs / "AnimatedMorphCube.glb").json["animations"][0]["name"], [0, 1.5])
    poses = Poses(scratch, skins / "CesiumMan.glb", skins / "CesiumMan.glb")
    check("P2323" in poses.errors, "CesiumMan: weights that do not sum to 1 are told")
    # Draco keeps 14 bits of the positions, and the same shape up to the order of vertices.
    for plain, packed in (("gltf_morph/AnimatedMorphSphere.glb", "gltf_draco/AnimatedMorphSphere_draco.glb"),
                          ("gltf_morph/ict_face_14targets.glb", "gltf_draco/ict_face_14targets_draco.glb")):
        poses = Poses(scratch, DATA / plain, DATA / packed)
        half = len(poses.positions) // 2
        for k in range(half):
            a, b = poses.positions[k], poses.positions[half + k]
            off = max(np.abs(a.min(0) - b.min(0)).max(),
                      np.abs(a.max(0) - b.max(0)).max()) / np.linalg.norm(np.ptp(a, axis=0))
            check(off < 2e-4, f"{packed} pose {k}: bounds {off:.1e} off")


def main():
    with tempfile.TemporaryDirectory(prefix="pliant-test-") as name:
        folder, scratch = pathlib.Path(name), pathlib.Path(name) / "scratch"
        scratch.mkdir()
        interpolations(folder, scratch)
        frames(folder, scratch)
        boxes(folder, scratch)
        encodings(folder, scratch)
        if (DATA / "gltf_skin").is_dir():
            real_files(scratch)
        else:
            print("no real files: set PLIANT_DATA")
    print(f"{len(failures)} failures")
    return 1 if failures else 0


sys.exit(main())
