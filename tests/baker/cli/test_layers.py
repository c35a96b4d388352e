"""Runs `pliant average` and `pliant bake` with `--blend layers` as a user does: test_layers.py PLIANT. Without other
packages."""
import json
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from layered_tube import RINGS, SIDES, tube, write_obj  # noqa: E402

TOOL = sys.argv[1]
def read(path):
    data = path.read_bytes()
    numbers = struct.unpack_from(f"<{3 * RINGS * SIDES}f", data, data.index(b"end_header\n") + 11)
    return [numbers[i:i + 3] for i in range(0, len(numbers), 3)]


def difference(one, other):
    """The largest difference of distances between vertices: rigid motions do not count."""
    count = len(one)
    pairs = [(i, (i * 37 + step) % count) for i in range(count) for step in (1, 29, 61)]
    return max(abs(math.dist(one[i], one[j]) - math.dist(other[i], other[j])) for i, j in pairs)


def average(folder, *arguments):
    result = subprocess.run([TOOL, "average", "rest.obj", "twisted.obj", "bent.obj", "--blend", "layers", "--json",
                             *arguments], cwd=folder, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)["averages"]


with tempfile.TemporaryDirectory(prefix="pliant_layers_") as temporary:
    work = pathlib.Path(temporary)
    for name, angles in (("rest", (0, 0)), ("twisted", (1, 0)), ("bent", (0, 1.2))):
        write_obj(work / f"{name}.obj", tube(*angles))

    row = average(work, "--weights", "1,1", "-o", "sum.ply")[0]
    assert row["weights"] == [1, 1] and row["energy"] < 1e-15, row
    assert difference(read(work / "sum.ply"), tube(1, 1.2)) < 1e-5, "layers that fit together compose exactly"
    average(work, "--weights=-0.5,1.5", "-o", "more.ply")
    assert difference(read(work / "more.ply"), tube(-0.5, 1.8)) < 0.1, "negative weights, and weights above 1"

    (work / "path.csv").write_text("0,0\n0,1\n", encoding="utf-8")
    average(work, "--path", "path.csv", "-o", "path_%d.ply")
    assert difference(read(work / "path_0.ply"), tube(0, 0)) < 1e-6, "no layer: the rest shape"
    assert difference(read(work / "path_1.ply"), tube(0, 1.2)) < 1e-6, "one layer: its pose"

    rows = average(work, "--grid", "2", "--list", "grid.csv", "-o", "grid_%d.ply")
    assert [row["weights"] for row in rows] == [[a / 2, b / 2] for b in range(3) for a in range(3)], rows
    assert difference(read(work / "grid_8.ply"), read(work / "sum.ply")) < 1e-6

    many = ["rest.obj"] + ["twisted.obj", "bent.obj"] * 7
    result = subprocess.run([TOOL, "average", *many, "--blend", "layers", "--weights", ",".join(["0.1"] * 14), "--quiet",
                             "-o", "many.ply"], cwd=work, capture_output=True, text=True, check=False)
    assert result.returncode == 0, f"more layers than an average has poses: {result.stderr}"
    # A bake, and blends by the runtime.
    def run(*arguments, expected=0):
        done = subprocess.run([TOOL, *arguments], cwd=work, capture_output=True, text=True, check=False)
        assert done.returncode == expected, done.stderr
        return done.stdout

    said = run("bake", "rest.obj", "twisted.obj", "bent.obj", "--blend", "layers", "--range", "bent=-0.5:1",
               "-o", "tube.pliant", "--report", "tube.json")
    assert "\n  rest shape and 2 layers, " in said and "3 poses" not in said, said
    assert "the linear sum keeps" not in said, said
    assert re.search(r"^  worst mixture: (twisted|bent)=", said, re.M), said
    report = json.loads((work / "tube.json").read_text(encoding="utf-8"))
    assert report["meets_tolerance"] and report["subspace"]["dimension"] <= 12, report["subspace"]
    kinds = {row["kind"]: row for row in report["layers"]["errors"]}
    assert {"single", "pair"} <= set(kinds) and sum(row["count"] for row in kinds.values()) == 40, kinds
    assert all(10 * row["mean_error"] < row["linear_mean_error"] for row in kinds.values()), kinds
    ranges = [(row["layer"], row["low"], row["high"]) for row in report["layers"]["ranges"]]
    assert ranges == [("twisted", 0, 1), ("bent", -0.5, 1)], ranges
    text = run("info", "tube.pliant")
    assert "  layer bent, weights -0.5 .. 1\n" in text, text
    for kind, row in kinds.items():
        line = f"  {kind}: {row['count']} mixture"
        assert line in text and line in said and f"{row['mean_error']:.2e} (mean)" in text, (text, said)
        assert f"linear sum {row['linear_mean_error']:.2e} and {row['linear_largest_error']:.2e}" in said, said
    for name, angles in (("a", (0.02, 0)), ("b", (0, 0.02))):
        write_obj(work / f"{name}.obj", tube(*angles))
    said = run("bake", "rest.obj", "a.obj", "b.obj", "--blend", "layers", "--tolerance", "1e-2", "-o", "small.pliant")
    assert "the linear sum keeps the tolerance, too: mean error " in said, said
    assert "valid" in run("validate", "tube.pliant")
    info = json.loads(run("info", "tube.pliant", "--json"))
    assert [layer["name"] for layer in info["layers"]] == ["twisted", "bent"] and info["format"] == "1.5", info["layers"]

    run("blend", "tube.pliant", "--set", "bent=1", "--set", "twisted=1", "-o", "both.ply")
    assert difference(read(work / "both.ply"), tube(1, 1.2)) < 0.02, "both layers at full strength"
    run("blend", "tube.pliant", "--weights", "0,1", "-o", "bent.ply")
    assert max(math.dist(a, b) for a, b in zip(read(work / "bent.ply"), tube(0, 1.2))) < 2e-3, "a layer is in its place"
    for weights, outside in (("1,-0.5", 0), ("1.5,-0.5", 0.5)):
        frame = json.loads(run("blend", "tube.pliant", f"--weights={weights}", "-o", "w.ply", "--json"))["frames"][0]
        assert frame["outside"] == outside, frame
    # The box of an export holds its own animation.
    (work / "far.csv").write_text("0,0\n1.5,-1\n1,2\n", encoding="utf-8")
    run("export", "tube.pliant", "--path", "far.csv", "-o", "far.glb")
    glb = (work / "far.glb").read_bytes()
    bounds = json.loads(glb[20:20 + struct.unpack_from("<I", glb, 12)[0]])["meshes"][0]["extras"]["pliant"]["bounds"]
    for weights in ("1.5,-1", "1,2"):
        run("blend", "tube.pliant", f"--weights={weights}", "-o", "far.ply")
        outside = [point for point in read(work / "far.ply")
                   if any(not low <= x <= high for low, x, high in zip(bounds["min"], point, bounds["max"]))]
        assert not outside, (weights, bounds, outside[0])
    # The unit of a weight makes no difference: one layer is a hundredth of the bend, and its weight runs to 100.
    write_obj(work / "hundredth.obj", tube(0, 0.012))
    evaluations = {}
    for layer, high in (("bent", 1), ("hundredth", 100)):
        run("bake", "rest.obj", f"{layer}.obj", "--blend", "layers", "--range", f"0:{high}", "-o", "unit.pliant")
        (work / "unit.csv").write_text("".join(f"{high * i / 20}\n" for i in range(21)), encoding="utf-8")
        frames = json.loads(run("blend", "unit.pliant", "--path", "unit.csv", "-o", "u_%d.ply", "--json"))["frames"]
        evaluations[layer] = sum(frame["evaluations"] for frame in frames)
        run("export", "unit.pliant", "-o", "unit.glb")
        glb = (work / "unit.glb").read_bytes()
        table = json.loads(glb[20:20 + struct.unpack_from("<I", glb, 12)[0]])["meshes"][0]["extras"]["pliant"]["pose_table"]
        assert table["error_of_diagonal"]["largest"] < 5e-3, (layer, table["error_of_diagonal"])
    assert evaluations["hundredth"] < 2 * evaluations["bent"], evaluations
    samples = json.loads(run("measure", "tube.pliant", "rest.obj", "twisted.obj", "bent.obj", "--samples", "12", "--json"))
    errors = [sample["relative_l2"] for sample in samples["samples"]]
    assert max(errors) < 2 * report["measured"]["largest_error"], errors
    # A basis in few bits moves the poses, which are the same still.
    run("bake", "rest.obj", "twisted.obj", "bent.obj", "--dim", "6", "--check-samples", "2", "--fresh-samples", "1",
        "--best-effort", "--position-error", "2e-3", "-o", "coarse.pliant")
    run("measure", "coarse.pliant", "rest.obj", "twisted.obj", "bent.obj", "--samples", "2")
    run("measure", "coarse.pliant", "rest.obj", "bent.obj", "twisted.obj", "--samples", "2", expected=3)
    # Far from the origin single precision moves them, too.
    for name, angles in (("far", (0, 0)), ("far_bent", (0, 1.2))):
        write_obj(work / f"{name}.obj", [tuple(x + 30000 for x in point) for point in tube(*angles)])
    run("bake", "far.obj", "far_bent.obj", "--dim", "4", "--check-samples", "2", "--fresh-samples", "1", "--best-effort",
        "-o", "far.pliant")
    run("measure", "far.pliant", "far.obj", "far_bent.obj", "--samples", "2")
    help_text = subprocess.run([TOOL, "average", "--help"], capture_output=True, text=True, check=True).stdout
    assert "--blend" in help_text and "layer" in help_text and "rest shape" in " ".join(help_text.split())
print("layers: bake, sum, exaggeration, path, grid, many layers, help")
