"""The pieces of the study on a tube: test_study.py PLIANT_STUDY PLIANT

pliant_study measures subspaces and an asset, tables.py and manifold.py read what it wrote, sheet.py draws. Wanted: finite
errors, no solution better than the best projection, POD better than all others at equal d, surrogate energy and subspace
errors that explain the total.
"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))
import manifold  # noqa: E402
import tables  # noqa: E402
from shapes import align, read_ply, relative_l2, write_ply  # noqa: E402


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def mean(rows, name, **wanted):
    values = [float(row[name]) for row in rows if all(row[key] == value for key, value in wanted.items())]
    assert values, f"no rows with {wanted}"
    return sum(values) / len(values)


def write_poses(folder):
    """pliant_study's own tube as files, for the tool: the snapshots hold the poses in normalised units."""
    poses, faces = np.load(folder / "tube_poses.npy"), np.load(folder / "tube_faces.npy")
    paths = []
    for k, pose in enumerate(poses):
        path = folder / f"tube{k}.ply"
        write_ply(path, pose.reshape(-1, 3), faces)
        paths.append(str(path))
    return paths


def check_subspaces(rows):
    for row in rows:
        assert np.isfinite(float(row["solved_l2"])) and 0 < float(row["solved_l2"]) < 0.2, row
        assert row["truth_converged"] == "1", row
        if row["basis"] != "linear":  # the best projection is the best: a per mille is left for its Gauss-Newton
            assert float(row["projected_l2"]) <= 1.001 * float(row["solved_l2"]) + 1e-9, row
    for d in ("3", "5"):
        best = mean(rows, "solved_l2", basis="pod", d=d)
        assert best < mean(rows, "solved_l2", basis="krylov", d=d) and best < mean(rows, "solved_l2", basis="barbic", d=d)
        assert mean(rows, "solved_l2", basis="krylov", d=d) < mean(rows, "solved_l2", basis="linear")
    assert mean(rows, "solved_l2", basis="pod", d="5") < 0.1 * mean(rows, "solved_l2", basis="pod", d="3")


def check_assets(rows):
    for row in rows:
        total, parts = float(row["total_l2"]), float(row["subspace_l2"]) + float(row["stand_in_l2"])
        assert total <= 1.05 * parts + 1e-6, row  # the triangle inequality, but for the rigid alignments
        assert int(row["elements"]) == 40 and float(row["stand_in_l2"]) > 0, row


def check_cubatures(rows):
    """One set of elements for all poses is better than one for every pose with as many elements, and a dead load helps."""
    error = lambda way, points: mean(rows, "surrogate_l2", cubature=way, elements=str(points))
    assert all(row["has_converged"] == "1" and int(row["iterations_h0_at_mean"]) < 40 for row in rows)
    assert error("joint, NN-HTP", 15) < 0.3 * error("per pose, NN-HTP", 30) < 0.02
    assert error("joint, greedy", 30) < 0.3 * error("per pose, greedy", 30)
    assert error("joint, greedy, dead load", 30) < 0.5 * error("joint, greedy", 30)


def check_pipeline(rows):
    row, = rows
    assert row["surrogate"] == "ghost" and int(row["d"]) == 5 and int(row["elements"]) > 1000
    assert row["unconverged"] == "0", row
    assert all(float(row[key]) > 0 for key in ("basis_s", "surrogate_s", "shape_us", "vertices_ms")), row


def run(*command):
    result = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                            check=False)
    assert result.returncode == 0, f"{command[0]}: exit code {result.returncode}\n{result.stdout}"


def main(study, tool):
    with tempfile.TemporaryDirectory(prefix="pliant_study_") as name:
        folder = Path(name)
        run(study, "-o", folder / "tube", "--tube", 2, "--dims", "3,5", "--train", 11, "--fresh", 7, "--snapshots",
            "--cubatures", 5, "--cubature-poses", 200)
        check_subspaces(rows_of(folder / "tube_subspace.csv"))
        check_cubatures(rows_of(folder / "tube_cubatures.csv"))
        run(study, "-o", folder / "tube", "--tube", 2, "--pipeline", 5)
        check_pipeline(rows_of(folder / "tube_pipeline.csv"))

        poses, asset = write_poses(folder), folder / "tube.pliant"
        run(tool, "bake", *poses, "-o", asset, "--subspace", "krylov", "--dim", 5, "--elements", 40, "--check-samples", 0,
            "--continuity", "off", "--quiet", "--position-error", 0)
        run(study, "-o", folder / "tube_b", "--dims", "3,5", "--kinds", "barbic", "--train", 1, "--fresh", 7, "--basis",
            f"krylov={asset}", "--asset", f"krylov={asset}", *poses)
        check_assets(rows_of(folder / "tube_b_assets.csv"))
        # Read back through an asset, the basis is the same one.
        direct = mean(rows_of(folder / "tube_subspace.csv"), "solved_l2", basis="krylov", d="5")
        assert (abs(mean(rows_of(folder / "tube_b_subspace.csv"), "solved_l2", basis="krylov", d="5") - direct)
                < 0.02 * direct + 1e-6)

        tables.main(folder)
        manifold.study(folder, "tube")
        spaces = rows_of(folder / "tube_manifold.csv")
        assert all(np.isfinite(float(row["L2 mean"])) for row in spaces)
        for row in spaces:  # a manifold inside a linear space of as many columns
            if row["space"].startswith("quadratic"):
                assert float(row["L2 mean"]) >= 0.99 * mean(spaces, "L2 mean", space="linear", columns=row["columns"]), row

        sheet = folder / "sheet.png"
        run(sys.executable, HERE / "sheet.py", "--tool", tool, "-o", sheet, "--size", "90x100", "--continuity", "off",
            "--asset", f"krylov={asset}", "--weights", "0.5,0.5", *poses)
        picture = np.asarray(Image.open(sheet).convert("L"), float)
        assert picture.shape[1] == 3 * 96 + 6 and picture.std() > 5, "the sheet is empty"
        linear, krylov = (float(row["relative_l2"]) for row in rows_of(folder / "sheet.csv"))
        assert krylov < 0.5 * linear, "the asset blends worse than linear"
        # The Python error measure: blind to rigid motions, and not to others.
        shape, _ = read_ply(poses[1])
        masses = np.load(folder / "tube_masses.npy").ravel()
        turned = shape @ np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]]).T + [1, 2, 3]
        assert relative_l2(turned, shape, masses) < 1e-12 < relative_l2(1.01 * shape, shape, masses)
        assert np.abs(align(turned, shape, masses) - shape).max() < 1e-12
    print("the study's pieces work")


if __name__ == "__main__":
    main(*sys.argv[1:])
