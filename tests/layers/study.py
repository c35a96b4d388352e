"""study.py [--sets SET...] [--tool PLIANT] [--out FOLDER]: bakes sets of layers, measures them at fresh weights, and prints
Markdown tables; README.md has them. Assets, reports and the picture limbs8.png go to FOLDER (build/layers). Where the exact
shape is known by formula, blends, unreduced layers and the linear sum are compared with it. Times of a drag are those of
pliant_bench_frame in the tool's build folder. Data: PLIANT_DATA. Exit code 0 done, 77 a set without data."""
import argparse
import json
import pathlib
import subprocess
import sys
import time

import numpy as np
from PIL import Image, ImageDraw

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / part) for part in ("layers", "paper", "baker/bake")]
import make_layers  # noqa: E402: makes the sets
import shapes  # noqa: E402: reads triangles, compares shapes
import sheet  # noqa: E402: draws
from continuity import DATA, line, run  # noqa: E402

GLTF = DATA / "gltf_morph" / "ict_face_14targets.glb"
TOLERANCES = {"tube": "1e-3", "ict7": "1e-3", "gltf14": "1e-3", "face52": "1e-3", "limbs8": "3e-3"}
FRESH = ["--samples", "50", "--seed", "77"]
KINDS = ["single", "pair", "sparse", "dense", "corner"]
HEAD = ["weights", "certificate, mean / largest", "linear sum", "fresh, mean / largest", "linear sum"]
FORMULA_HEAD = ["weights", "blend", "layers, unreduced", "linear sum"]
FORMULA_WEIGHTS = {"tube": [(1, 1), (0.5, 0.5), (1.5, 0), (0, 2), (-0.5, -0.5), (1.5, 1.5)],
                   "limbs8": [(1,) * 8, (0.5,) * 8, (1.25,) * 8]}
VIEWS, PICTURE_SIZE, SKIN, CAPTION = (0, 40, 90), (360, 420), (236.0, 226.0, 214.0), 24


def poses_of(name, folder):
    if name != "gltf14":
        return make_layers.write_set(name, folder / name)
    return [GLTF] if GLTF.exists() else make_layers.skip(f"no {GLTF}: set PLIANT_DATA")


def table(head, rows):
    print(line(head), line(["---"] * len(head)), *map(line, rows), "", sep="\n", flush=True)


# A bake and its figures


def bake(tool, name, poses, asset, report):
    """Seconds; None if there is no asset."""
    asset.unlink(missing_ok=True)
    start = time.monotonic()
    result = run(tool, "bake", *poses, "--blend", "layers", "--tolerance", TOLERANCES[name], "--best-effort", "-o", asset,
                 "--report", report)
    if not asset.exists():
        print(f"pliant bake: exit code {result.returncode}\n{result.stderr}", file=sys.stderr)
        return None
    return time.monotonic() - start


def measure(tool, asset, poses):
    """At fresh weights; without samples if the tool failed, as where layers have no shape."""
    result = run(tool, "measure", asset, *poses, *FRESH, "--json")
    if result.returncode != 0:
        print(f"pliant measure: exit code {result.returncode}\n{result.stderr}", file=sys.stderr)
        return {"samples": []}
    return json.loads(result.stdout)


def read_figures(report, measured):
    """All that this script knows of the names in both files: vertices, layers, d, elements, whether the tolerance is met;
    and (kind, error, error of the linear sum) of the certificate's checks and of the fresh weights."""
    errors = [[(check["kind"], check["relative_l2"], check[linear]) for check in checks]
              for checks, linear in ((report["measured"]["checks"], "linear_error"),
                                     (measured["samples"], "linear_relative_l2"))]
    facts = [report["vertices"], len(report["poses"]) - 1, report["subspace"]["dimension"], report["stand_in"]["elements"],
             report["meets_tolerance"]]
    return facts, errors


def summary(values):
    return f"{np.mean(values):.1e} / {np.max(values):.1e}" if len(values) and np.isfinite(values).all() else "-"


def error_rows(errors):
    for kind in [*KINDS, "all"]:
        found = [[check for check in checks if kind in (check[0], "all")] for checks in errors]
        if any(found):
            yield [kind, *(summary([check[i] for check in checks]) for checks in found for i in (1, 2))]


def drag(tool, asset):
    """Microseconds of a solve on a slow drag, as pliant_bench_frame prints them."""
    program = tool.parents[1] / "tests" / "bench" / "pliant_bench_frame"
    if not program.exists():
        return "-"
    result = subprocess.run([program, asset, "--characters", "1", "--threads", "1"], capture_output=True, text=True,
                            check=False)
    rows = [text.split(" | ") for text in result.stdout.splitlines()]
    return rows[2][rows[0].index("drag us (evaluations)")] if result.returncode == 0 else "-"


def study(tool, name, poses, folder):
    asset, report = folder / f"{name}.pliant", folder / f"{name}.json"
    seconds = bake(tool, name, poses, asset, report)
    if seconds is None:
        print(f"{name}: no asset\n", flush=True)
        return
    (vertices, layers, dimension, elements, is_met), errors = read_figures(json.loads(report.read_text()),
                                                                          measure(tool, asset, poses))
    print(f"{name}: {vertices} vertices, {layers} layers; d = {dimension}, {elements} elements; {seconds:.0f} s, "
          f"{asset.stat().st_size / 1024:.0f} KiB; a drag {drag(tool, asset)} us; tolerance {TOLERANCES[name]} "
          f"{'met' if is_met else 'missed'}\n")
    table(HEAD, error_rows(errors))


# Beside the formula


def numbers(weights):
    return "--weights=" + ",".join(map(str, weights))


def layered(tool, poses, weights, file):
    """The unreduced layers, or None."""
    result = run(tool, "average", *poses, "--blend", "layers", numbers(weights), "-o", file)
    return shapes.read_ply(file)[0] if result.returncode == 0 else None


def blended(tool, asset, weights, file):
    """The runtime's blend, or None."""
    result = run(tool, "blend", asset, numbers(weights), "-o", file) if asset.exists() else None
    return shapes.read_ply(file)[0] if result and result.returncode == 0 else None


def linear_sum(poses, weights):
    rest, *layers = (shapes.read_ply(pose)[0] for pose in poses)
    return rest + sum(weight * (layer - rest) for weight, layer in zip(weights, layers))


def shapes_at(tool, name, poses, weights, folder):
    """The columns of FORMULA_HEAD, in order; None where there is no shape."""
    file = folder / "shape.ply"
    return [blended(tool, folder / f"{name}.pliant", weights, file), layered(tool, poses, weights, file),
            linear_sum(poses, weights)]


def exact_shape(name, weights, rest, triangles):
    return make_layers.tube_shape(*weights) if name == "tube" else make_layers.limbs8_shape(weights, rest, triangles)


def formula_rows(tool, name, poses, folder):
    rest, triangles = shapes.read_ply(poses[0])
    masses = shapes.lumped_masses(rest, triangles)
    for weights in FORMULA_WEIGHTS[name]:
        truth = exact_shape(name, weights, rest, triangles)
        errors = ["-" if shape is None else f"{shapes.relative_l2(shape, truth, masses):.1e}"
                  for shape in shapes_at(tool, name, poses, weights, folder)]
        text = f"all {weights[0]}" if len(set(weights)) == 1 and len(weights) > 2 else ", ".join(map(str, weights))
        yield [text, *errors]


# The picture


def drawn(shape, triangles, turn):
    view = sheet.view_matrix(np.radians(turn), np.radians(5))
    seen = shape @ view.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    window = (*((low + high) / 2)[:2], (high - low)[:2].max() * 1.1)
    return sheet.draw(shape, triangles, np.tile(SKIN, (len(shape), 1)), view, window, PICTURE_SIZE)


def make_picture(tool, poses, folder):
    """All eight layers at 1: each way to add them from three sides."""
    rest, triangles = shapes.read_ply(poses[0])
    masses = shapes.lumped_masses(rest, triangles)
    found = shapes_at(tool, "limbs8", poses, (1,) * 8, folder)
    ways = [(title, shapes.align(shape, found[-1], masses)) for title, shape in zip(FORMULA_HEAD[1:], found)
            if shape is not None]
    width, height = PICTURE_SIZE
    picture = Image.new("RGB", (width * len(VIEWS), (height + CAPTION) * len(ways)), "white")
    for row, (title, shape) in enumerate(ways):
        top = row * (height + CAPTION)
        ImageDraw.Draw(picture).text((8, top + 6), f"limbs8, all layers at 1: {title}", fill="black")
        for column, turn in enumerate(VIEWS):
            picture.paste(drawn(shape, triangles, turn), (column * width, top + CAPTION))
    picture.save(folder / "limbs8.png")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sets", nargs="+", choices=list(TOLERANCES), default=list(TOLERANCES))
    parser.add_argument("--tool", type=pathlib.Path, default=ROOT / "build" / "release" / "baker" / "pliant")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "build" / "layers")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    for name in arguments.sets:
        poses = poses_of(name, arguments.out)
        study(arguments.tool, name, poses, arguments.out)
        if name in FORMULA_WEIGHTS:
            print(f"{name}, relative L2 from the exact shape:\n")
            table(FORMULA_HEAD, formula_rows(arguments.tool, name, poses, arguments.out))
        if name == "limbs8":
            make_picture(arguments.tool, poses, arguments.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
