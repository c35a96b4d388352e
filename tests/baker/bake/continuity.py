"""continuity.py TOOL [--only TEXT] [--samples N] [--limit S]: what the choice of the energy does to averages and bakes. For
every set of poses below one row with `--continuity off` (thin shells) and one with the default, as a Markdown table on
standard output; continuity.md has it and explains the columns. --samples: fresh weights (default 50). --limit S ends a bake
after S seconds of processor time, and says so. Data: PLIANT_DATA; sets that are not there are left out."""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).parent
DATA = pathlib.Path(os.environ.get("PLIANT_DATA", "") or HERE.parents[3] / "shared" / "data")
HEAD = ["set", "energy", "d", "elements", "jumps", "factorisations", "certificate mean / largest", "fresh mean / largest",
        "elsewhere", "length, %", "volume, %", "seconds"]
ENERGIES = {"shells": ["--continuity", "off"], "default": []}


def files(folder, *names):
    """Paths relative to the data folder; without names those of all PLY files there."""
    return [f"{folder}/{name}.ply" for name in names or sorted(path.stem for path in (DATA / folder).glob("*.ply"))]


COARSE = ["--tolerance", "2e-3"]
# Name, poses relative to the data folder, options of the bake.
SETS = [
    ("Fox", ["gltf_skin/Fox.glb#animation=2@0,0.2,0.4"], []),
    ("CesiumMan", ["gltf_skin/CesiumMan.glb#animation=0@0,0.5,1"], []),
    ("Wolf", ["gltf_skin/Wolf.glb#animation=0@0,0.3,0.6"], []),
    ("Trex", ["gltf_skin/Trex.glb#animation=0@0,0.3,0.6"], []),
    ("RobotExpressive, running", ["gltf_morph/RobotExpressive.glb#animation=Running@0,0.2,0.4"], []),
    ("goast plate", files("goast_small/plate"), []),
    ("goast saddle", files("goast_small/saddle"), []),
    ("goast sphere", files("goast_small/sphere"), []),
    ("human_pair", files("human_pair", "man", "woman"), []),
    ("ict_face, 7 poses", files("ict_face", "neutral", "smile", "jaw_open", "blink_brow_down", "cheek_puff", "pucker",
                                "sneer_frown"), []),
    ("mhr, 5 poses", files("mhr_body", "rest", "pose0", "pose1", "pose2", "pose3"), COARSE),
    ("makehuman, 4 poses", files("makehuman_body", "tpose", "dance1_f00", "walk1_f03", "zombieWalk1_f20"), COARSE),
    ("makehuman, 8 poses", files("makehuman_body"), COARSE),
    ("cloth_ball", files("cloth_ball"), []),
    ("untuned: Wolf, 4 poses", ["gltf_skin/Wolf.glb#animation=1@0,0.2,0.5,0.8"], []),
    ("untuned: Fox, 2 poses", ["gltf_skin/Fox.glb#animation=1@0,0.35"], []),
    ("untuned: Trex, 4 poses", ["gltf_skin/Trex.glb#animation=1@0,0.2,0.5,0.9"], []),
    ("untuned: ict_face, 3 poses", files("ict_face", "neutral", "jaw_open", "pucker"), []),
    ("untuned: makehuman, 2 poses", files("makehuman_body", "walk1_f10", "benchmark"), COARSE),
]


def run(tool, *arguments, limit=0):
    set_limit = (lambda: resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))) if limit else None
    return subprocess.run([tool, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          preexec_fn=set_limit)


def read_ply(path):
    """Positions and triangles of a file as the tool writes it: binary, single precision, faces of any size."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii")
    vertex_count, face_count = (int(header.split(f"element {name} ")[1].split()[0]) for name in ("vertex", "face"))
    points = np.frombuffer(data, "<f4", 3 * vertex_count, end).reshape(-1, 3).astype(float)
    triangles, place = [], end + 12 * vertex_count
    for _ in range(face_count):
        size = data[place]
        face = np.frombuffer(data, "<i4", size, place + 1)
        triangles += [(face[0], face[i], face[i + 1]) for i in range(1, size - 1)]
        place += 1 + 4 * size
    return points, np.array(triangles)


def average_of_all(tool, poses, options, pose_count):
    """The poses as the tool places them with the average of all of them last, and the triangles; or None."""
    rows = [",".join("1" if i == k else "0" for i in range(pose_count)) for k in range(pose_count)]
    rows.append(",".join(["1"] * pose_count))
    with tempfile.TemporaryDirectory(prefix="pliant-average-") as text:
        folder = pathlib.Path(text)
        (folder / "path.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        result = run(tool, "average", *poses, *options, "--path", folder / "path.csv", "-o", folder / "a_%d.ply")
        if result.returncode != 0:
            return None
        shapes = [read_ply(folder / f"a_{k}.ply") for k in range(pose_count + 1)]
    return [points for points, _ in shapes], shapes[0][1]


def strain(tool, poses, options, pose_count):
    """Mean change of edge lengths and of the volume in the average of all poses, per cent."""
    found = average_of_all(tool, poses, options, pose_count)
    if not found:
        return "-", "-"
    shapes, triangles = found
    edges = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1),
                      axis=0)
    lengths = [np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1) for points in shapes]
    wanted = np.mean(lengths[:-1], axis=0)
    change = np.abs(lengths[-1] - wanted)[wanted > 0] / wanted[wanted > 0]
    volumes = []
    for points in shapes:
        a, b, c = (points[triangles[:, i]] - points.mean(axis=0) for i in range(3))
        volumes.append(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)
    return f"{100 * change.mean():.2f}", f"{100 * (volumes[-1] / np.mean(volumes[:-1]) - 1):+.2f}"


def row(arguments, name, poses, options, energy):
    with tempfile.TemporaryDirectory(prefix="pliant-continuity-") as text:
        folder = pathlib.Path(text)
        asset = folder / "a.pliant"
        start = time.monotonic()
        result = run(arguments.tool, "bake", *poses, "-o", asset, *ENERGIES[energy], *options, "--best-effort",
                     limit=arguments.limit)
        seconds = time.monotonic() - start
        if not asset.exists():
            outcome = "out of time" if result.returncode < 0 else f"exit code {result.returncode}"
            return [name, energy, outcome, *["-"] * (len(HEAD) - 4), f"{seconds:.0f}"]
        certificate = json.loads(run(arguments.tool, "info", asset, "--json").stdout)["certificate"]
        measured = certificate["measured"]
        fresh = json.loads(run(arguments.tool, "measure", asset, *poses, "--samples", arguments.samples, "--json").stdout)
        errors = [sample["relative_l2"] for sample in fresh["samples"]]
        elsewhere = sum(sample["branches"] > 0 for sample in fresh["samples"])
        length, volume = strain(arguments.tool, poses, ENERGIES[energy], len(certificate["poses"]))
        return [
            name, energy, str(certificate["subspace"]["dimension"]), str(certificate["stand_in"]["elements"]),
            str(len(certificate["branches"])), str(certificate["factorizations"]),
            f"{measured['mean_error']:.1e} / {measured['largest_error']:.1e}",
            f"{np.mean(errors):.1e} / {np.max(errors):.1e}", str(elsewhere), length, volume, f"{seconds:.0f}"
        ]


def line(cells):
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tool")
    parser.add_argument("--only", default="")
    parser.add_argument("--energy", choices=list(ENERGIES))
    parser.add_argument("--samples", type=int, default=50)
    parser.add_argument("--limit", type=int, default=0)
    arguments = parser.parse_args()
    print(line(HEAD), line(["---"] * len(HEAD)), sep="\n")
    for name, patterns, options in SETS:
        poses = [str(DATA / pattern) for pattern in patterns]
        if arguments.only not in name or not poses or not all(os.path.exists(pose.split("#")[0]) for pose in poses):
            continue
        for energy in [arguments.energy] if arguments.energy else ENERGIES:
            print(line(row(arguments, name, poses, options, energy)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
