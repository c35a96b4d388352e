"""real_meshes.py TOOL [--bake] [--only TEXT]: what becomes of meshes as people make them. For every set of poses below, one
row of a Markdown table on standard output: what the files have, what of it is elastic, what was told; with --bake a second
table: what a bake of them comes to, each with the options that stand in its row (none: the default bake). real_meshes.md has
both. Data: PLIANT_DATA; sets that are not there are left out. --limit S ends a bake after S seconds of processor time, and
says so.

real_meshes.py TOOL --compare: the table without bakes against real_meshes.md. Exit code 0 the same, 1 not, 77 no data."""
import argparse
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
DATA = pathlib.Path(os.environ.get("PLIANT_DATA", "") or HERE.parents[3] / "shared" / "data")
TABLE = HERE / "real_meshes.md"
HEAD = ["set", "drawn vertices / triangles", "elastic vertices / triangles", "components", "told", "verdict"]
BAKE_HEAD = ["set", "options", "outcome", "parts", "welded", "ties", "d", "elements", "mean relative L2", "largest",
             "drift of averages / blends, %", "told", "processor seconds"]

# Name of the set, and the poses relative to the data folder; "*" stands for files.
SETS = [
    ("cloth_ball", ["cloth_ball/*.ply"]),
    ("ict_face original", ["ict_face/original_obj/*.obj"]),
    ("human_pair", ["human_pair/*.ply"]),
    ("AnimatedMorphCube", ["gltf_morph/AnimatedMorphCube.glb"]),
    ("AnimatedMorphSphere", ["gltf_morph/AnimatedMorphSphere.glb"]),
    ("MorphStressTest", ["gltf_morph/MorphStressTest.gltf"]),
    ("RobotExpressive, morph", ["gltf_morph/RobotExpressive.glb"]),
    ("RobotExpressive, animation", ["gltf_morph/RobotExpressive.glb#animation=0@0,0.5,1"]),
    ("RobotExpressive, running", ["gltf_morph/RobotExpressive.glb#animation=Running@0,0.2,0.4"]),
    ("ict_face_14targets", ["gltf_morph/ict_face_14targets.glb#target=jawOpen,mouthSmile_L"]),
    ("Fox", ["gltf_skin/Fox.glb#animation=2@0,0.2,0.4"]),
    ("CesiumMan", ["gltf_skin/CesiumMan.glb#animation=0@0,0.5,1"]),
    ("CesiumMan, .gltf", ["gltf_skin/CesiumMan/CesiumMan.gltf#animation=0@0,0.5,1"]),
    ("Trex", ["gltf_skin/Trex.glb#animation=0@0,0.3,0.6"]),
    ("Wolf", ["gltf_skin/Wolf.glb#animation=0@0,0.3,0.6"]),
    ("AnimatedMorphSphere, Draco", ["gltf_draco/AnimatedMorphSphere_draco.glb"]),
    ("MorphStressTest, Draco", ["gltf_draco/MorphStressTest_draco.glb"]),
    ("ict_face_14targets, Draco", ["gltf_draco/ict_face_14targets_draco.glb#target=jawOpen,mouthSmile_L"]),
    ("CesiumMan, Draco", ["gltf_draco/CesiumMan_draco.glb#animation=0@0,0.5,1"]),
    ("Mech_FinnTheFrog, Draco", ["gltf_draco/Mech_FinnTheFrog-transformed.glb#animation=0@0,0.3,0.6"]),
    ("Enemy_Small, Draco", ["gltf_draco/Enemy_Small-transformed.glb#animation=0@0,0.3,0.6"]),
]

# Of bakes that are not, or not only, the default one: large ones, for the time they take, and those of characters of few
# polygons, for what ARAP makes of them.
FACE = ["--tolerance", "2e-3", "--best-effort"]
ARAP = ["--material", "arap"]
BAKE_OPTIONS = {
    "cloth_ball": [["--dim", "8", "--elements", "80", "--check-samples", "4", "--fresh-samples", "2"]],
    "ict_face original": [FACE],
    "ict_face_14targets": [FACE],
    "ict_face_14targets, Draco": [FACE],
    "Fox": [[], ARAP],
    "CesiumMan": [[], ARAP],
    "Trex": [[], ARAP],
    "Wolf": [[], ARAP],
}


def poses_of(patterns):
    """The arguments of the tool, or none if a file is missing."""
    poses = []
    for pattern in patterns:
        name, mark, choice = pattern.partition("#")
        files = sorted(DATA.glob(name))
        if not files:
            return []
        poses += [str(file) + mark + choice for file in files]
    return poses


def run(tool, *arguments):
    return subprocess.run([tool, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=3600)


def numbers(result):
    """Numbers of errors and warnings, each once, in order."""
    return ", ".join(dict.fromkeys(re.findall(r"(?m)^.*?\b(?:error|warning) (P\d{4}):", result.stderr))) or "-"


def checked(tool, poses):
    """The cells from drawn vertices to verdict."""
    result = run(tool, "check", *poses)
    drawn = re.search(r"poses of (\d+) vertices, \d+ faces, (\d+) triangles", result.stdout)
    elastic = re.search(r"simulation mesh has (\d+) vertices, (\d+) triangles", result.stdout)
    parts = re.search(r"has (\d+) components", result.stderr)
    verdict = "fit" if result.returncode == 0 else f"exit code {result.returncode}"
    if not drawn:
        return ["-", "-", "-", numbers(result), verdict]
    return [" / ".join(drawn.groups()), " / ".join((elastic or drawn).groups()), parts[1] if parts else "1", numbers(result),
            verdict]


def baked(arguments, poses, options):
    """The cells of the second table, from options on. The time is that of all threads."""
    with tempfile.TemporaryDirectory(prefix="pliant-real-") as folder:
        asset, report = str(pathlib.Path(folder) / "a.pliant"), pathlib.Path(folder) / "r.json"
        command = [arguments.tool, "bake", *poses, "-o", asset, "--report", str(report), "--continuity", "off", *options]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        limit = ((lambda: resource.setrlimit(resource.RLIMIT_CPU, (arguments.limit, arguments.limit))) if arguments.limit
                 else None)
        result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, preexec_fn=limit)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = f"{after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime:.0f}"
        told = numbers(result)
        if result.returncode < 0 or not report.exists():
            outcome = "out of time" if result.returncode < 0 else f"exit code {result.returncode}"
            return [" ".join(options) or "-", outcome, *["-"] * 8, told, seconds]
        certificate = json.loads(run(arguments.tool, "info", asset, "--json").stdout)["certificate"]
        ties, measured = certificate.get("ties", {}), certificate["measured"]
        drifts = [ties.get(key, {}).get("largest") for key in ("drift_of_averages", "drift_of_blends")]
        return [
            " ".join(options) or "-", "done" if result.returncode == 0 else f"exit code {result.returncode}",
            str(ties.get("parts", 1)), str(certificate.get("elastic", {}).get("welded_vertices", 0)),
            str(ties.get("ties", 0)), str(certificate["subspace"]["dimension"]), str(certificate["stand_in"]["elements"]),
            f"{measured['mean_error']:.1e}", f"{measured['largest_error']:.1e}",
            " / ".join(f"{100 * drift:.2f}" for drift in drifts) if drifts[0] is not None else "-", told, seconds
        ]


def chosen(arguments):
    """Name and poses of the sets that are there and wanted."""
    for name, patterns in SETS:
        poses = poses_of(patterns)
        if poses and arguments.only in name:
            yield name, poses


def rows(arguments):
    for name, poses in chosen(arguments):
        yield [name, *checked(arguments.tool, poses)]


def bake_rows(arguments):
    for name, poses in chosen(arguments):
        for options in BAKE_OPTIONS.get(name, [[]]):
            yield [name, *baked(arguments, poses, options)]


def line(cells):
    return "| " + " | ".join(cells) + " |"


def compare(arguments):
    committed = {}
    for text in TABLE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in text.strip("| ").split(" | ")]
        if text.startswith("|") and cells[0] not in committed:
            committed[cells[0]] = cells[:len(HEAD)]
    count = different = 0
    for cells in rows(arguments):
        if cells[0] not in committed:
            print(f"not in the table: {line(cells)}")
            continue
        count += 1
        if committed[cells[0]] != cells:
            different += 1
            print(f"FAILED: {line(cells)}\n  the table has {line(committed[cells[0]])}")
    print(f"{count} sets, {different} otherwise than in {TABLE.name}" if count else "skipped: no data, set PLIANT_DATA")
    return 77 if count == 0 else 1 if different else 0


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("tool")
    parser.add_argument("--bake", action="store_true")
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--limit", type=int, default=0)
    arguments = parser.parse_args()
    if arguments.compare:
        return compare(arguments)
    head = BAKE_HEAD if arguments.bake else HEAD
    print(line(head), line(["---"] * len(head)), sep="\n")
    for cells in (bake_rows if arguments.bake else rows)(arguments):
        print(line(cells), flush=True)
    return 0


sys.exit(main())
