"""The paper's Table I beside ours: table1.py --build DIR --data DIR -o OUT [--quick] [--threads N]

Every row of the paper gets the nearest poses that can be had: shared sets, the creature, a bar of as many vertices, with
every triangle cut in four where that comes nearer. `pliant_study --pipeline` runs the paper's pipeline on them and times it:
Algorithm 1, a ghost of 800 vertices (surfaces), the quartic (St. Venant-Kirchhoff) or three points per dimension
(Mooney-Rivlin), and the runtime while weights move. Writes the table to OUT, as CSV and Markdown. --quick: meshes below
30,000 vertices. Sets whose data is not there are left out.
"""
import argparse
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import shapes
from tables import write_table

ROOT = Path(__file__).resolve().parents[2]
MHR = ["rest", "pose0", "pose1", "pose2", "pose3"]
ICT = ["neutral", "jaw_open", "smile", "pucker", "cheek_puff"]
CREATURE = ["rest", "reach", "curl"]
# Model, material, thousands of vertices, poses, d, seconds for basis and surrogate energy, ms a step and steps: all of the
# paper (a laptop of 2012). Then our poses, how often they are cut, and the material.
ROWS = [
    ("Armadillo", "DS", 166, 5, 64, 420, 8, 6, 6, "mhr_body_hi", 5, 0, ""),
    ("Armadillo", "DS", 166, 2, 41, 178, 4, 3, None, "mhr_body_hi", 2, 0, ""),
    ("Armadillo", "ARAP", 166, 2, 41, None, None, 15, 4, "mhr_body_hi", 2, 0, "arap"),
    ("Centaur", "DS", 16, 5, 64, 36, 2, 6, 3, "mhr_body", 5, 0, ""),
    ("Chinese dragon", "DS", 130, 2, 17, 121, 3, 1, 2, "human_pair", 2, 2, ""),
    ("Dinosaur", "StVK", 28, 2, 17, 8, 338, 0.2, 6, "bar", 2, 0, ""),
    ("Elephant", "DS", 42, 3, 20, 59, 2, 5, 2, "creature", 3, 1, ""),
    ("Face", "DS", 500, 5, 64, 1456, 6, 7, 3, "ict_face", 5, 2, ""),
    ("Hand", "DS", 6, 6, 65, 17, 0.5, 12, 4, "makehuman_body", 6, 0, ""),
    ("Neptune", "MR", 178, 3, 26, 100, 1076, 2, 5, "cow", 3, 0, "mooney-rivlin"),
    ("Livingstone elephant", "DS", 40, None, 39, 41, 2, 3, None, "creature", 3, 1, ""),
    ("Livingstone elephant", "ARAP", 40, None, 39, None, None, 19, 3, "creature", 3, 1, "arap"),
]
HEAD = ["model of the paper", "energy", "vertices", "poses", "d", "basis s", "surrogate s", "ms a step (steps)", "ours",
        "vertices", "poses", "basis s", "surrogate s", "us a frame (steps)", "vertices ms"]


def call(*command):
    subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Poses:
    """Files of the sets; what is made lies in a folder of its own."""

    def __init__(self, build, data, folder):
        self.build, self.data, self.folder = build, data, folder

    def files(self, name, count, cuts):
        files = getattr(self, name, self.shared)(name)[:count]
        if not all(Path(file).exists() for file in files):
            return None
        return self.cut(name, files, cuts) if cuts else files

    def shared(self, name):
        names = {"mhr_body_hi": MHR, "mhr_body": MHR, "human_pair": ["man", "woman"], "ict_face": ICT}.get(name)
        if name == "makehuman_body":
            names = [path.stem for path in sorted((self.data / name).glob("*.ply"))]
        return [self.data / name / f"{pose}.ply" for pose in names]

    def creature(self, _):
        call(self.build / "samples" / "creature" / "creature", "-o", self.folder)
        return [self.folder / f"creature_{pose}.ply" for pose in CREATURE]

    def bar(self, _):
        call(self.build / "tests" / "paper" / "pliant_bar", "--write", self.folder, "--degrees", 90, "--cells", 16,
             "--length-cells", 96)
        return [self.folder / "bar_straight.msh", self.folder / "bar_90.msh"]

    def cow(self, _):
        cow, poses = self.data / "tet_mid" / "spot.msh", []
        for name in ("look", "leap") if cow.exists() else ():
            poses.append(self.folder / f"spot_{name}.msh")
            call(self.build / "baker" / "pliant", "pose", cow, ROOT / "samples" / "pose_scripts" / f"spot_{name}.txt",
                 "-o", poses[-1])
        return [cow, *poses]

    def cut(self, name, files, cuts):
        meshes = [shapes.read_ply(file) for file in files]
        positions, triangles = [mesh[0] for mesh in meshes], meshes[0][1]
        for _ in range(cuts):
            positions, triangles = shapes.subdivide(positions, triangles)
        out = [self.folder / f"{name}_cut{cuts}_{k}.ply" for k in range(len(files))]
        for file, pose in zip(out, positions):
            shapes.write_ply(file, pose, triangles)
        return out


def measure(build, files, d, material, threads, prefix):
    options = (["--material", material] if material else []) + (["--threads", threads] if threads else [])
    call(build / "tests" / "paper" / "pliant_study", "-o", prefix, "--pipeline", d, *options, *files)
    with open(f"{prefix}_pipeline.csv", newline="") as file:
        return next(csv.DictReader(file))


def cells(row, found):
    model, energy, thousands, poses, d, basis, surrogate, ms, steps, name, _, cuts, _ = row
    text = lambda value: "-" if value is None else f"{value:g}"
    number = lambda key: f"{float(found[key]):.3g}"
    return [model, energy, f"{thousands}k", text(poses), d, text(basis), text(surrogate), f"{ms:g} ({text(steps)})",
            name + (f", cut {cuts} x" if cuts else ""), found["vertices"], found["poses"], number("basis_s"),
            number("surrogate_s"), f"{number('shape_us')} ({number('steps')})", number("vertices_ms")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=Path)
    parser.add_argument("--data", required=True, type=Path)
    parser.add_argument("-o", "--output", required=True, type=Path, metavar="OUT")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--threads")
    options = parser.parse_args()
    table = []
    for row in ROWS:
        if options.quick and row[2] > 30:
            continue
        with tempfile.TemporaryDirectory(prefix="pliant-table1-") as folder:
            files = Poses(options.build, options.data, Path(folder)).files(row[9], row[10], row[11])
            if not files:
                print(f"table1.py: skipping {row[0]}: no data", file=sys.stderr)
                continue
            found = measure(options.build, files, row[4], row[12], options.threads, f"{folder}/row")
        table.append(cells(row, found))
        print(" | ".join(map(str, table[-1])), file=sys.stderr, flush=True)
        write_table(options.output / "table1", "Table I: sizes and times",
                    "The paper's figures (a laptop of 2012), then ours "
                    "for the nearest poses, by the same pipeline. Frames: weights move by 1/60 of a way between random "
                    "weights; a frame may take no step.", HEAD, table)


if __name__ == "__main__":
    main()
