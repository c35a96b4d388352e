"""bake_growth.py [--levels N] [--poses POSE...] [--options TEXT]: how the cost of a bake grows with the mesh.
Takes poses (binary PLY; the creature's rest, reach and curl if none are given), cuts every triangle in four N times (2),
bakes each size, and prints a Markdown table with the exponent p of n^p from each size to the next. Draws the seconds over
the vertices in build/bench/growth.svg. The tool is built in build/release. GiB: the largest resident set."""
import argparse
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "bench"), str(ROOT / "tests" / "paper")]
import bake_cost  # noqa: E402: builds the tool
import shapes  # noqa: E402: reads, cuts and writes triangles

HEAD = ["vertices", "seconds", "exponent", "GiB", "factorisations", "d", "error, mean / largest"]


def bake(tool, poses, triangles, options, folder):
    """Seconds, GiB and the certificate."""
    files = [folder / f"pose_{k}.ply" for k in range(len(poses))]
    for file, pose in zip(files, poses):
        shapes.write_ply(file, pose, triangles)
    asset = folder / "a.pliant"
    start = time.monotonic()
    process = subprocess.Popen([tool, "bake", *files, *options, "-o", asset, "--best-effort", "--quiet"])
    _, status, usage = os.wait4(process.pid, 0)
    seconds = time.monotonic() - start
    if os.waitstatus_to_exitcode(status) not in (0, 4):
        raise SystemExit("the bake failed")
    info = subprocess.run([tool, "info", asset, "--json"], check=True, capture_output=True, text=True).stdout
    return seconds, usage.ru_maxrss / 2**20, json.loads(info)["certificate"]


def exponent(points):
    """Of the last two points (vertices, seconds)."""
    if len(points) < 2:
        return "-"
    (n0, s0), (n1, s1) = points[-2:]
    return f"{math.log(s1 / s0) / math.log(n1 / n0):.2f}"


def draw(points, path):
    """Seconds over vertices on logarithmic axes, and n^1.3 through the first point, dashed."""
    last = points[-1][0]
    wanted = [points[0], (last, points[0][1] * (last / points[0][0])**1.3)]
    low, high = (np.log10([f(axis) for axis in zip(*points, *wanted)]) for f in (min, max))
    low, high = np.floor(low), np.ceil(high)

    def place(point):
        x, y = (np.log10(point) - low) / (high - low)
        return f"{60 + 420 * x:.1f},{330 - 300 * y:.1f}"

    def line(some, style):
        return f'<polyline points="{" ".join(map(place, some))}" fill="none" {style}/>'

    parts = ['<svg xmlns="http://www.w3.org/2000/svg" width="500" height="370" font-family="sans-serif" font-size="12">',
             '<rect width="500" height="370" fill="white"/>']
    for axis, (first, end) in enumerate(zip(low.astype(int), high.astype(int))):
        for power in range(first, end + 1):
            near, far = ((10.0**power, 10.0**low[1]), (10.0**power, 10.0**high[1])) if axis == 0 else (
                (10.0**low[0], 10.0**power), (10.0**high[0], 10.0**power))
            x, y = map(float, place(near).split(","))
            x, y = (x - 10, y + 18) if axis == 0 else (x - 45, y + 4)
            parts += [line([near, far], 'stroke="#ddd"'), f'<text x="{x}" y="{y}">1e{power}</text>']
    parts += [line(wanted, 'stroke="#888" stroke-dasharray="5 4"'), line(points, 'stroke="#06c" stroke-width="2"'),
              '<text x="180" y="362">vertices (dashed: n^1.3)</text>', '<text x="8" y="18">seconds of a bake</text>',
              "</svg>"]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(parts) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--levels", type=int, default=2)
    parser.add_argument("--poses", nargs="+", default=[])
    parser.add_argument("--options", default="", help="of the bakes, as one text")
    arguments = parser.parse_args()
    binary = bake_cost.build(ROOT, "pliant", "creature")
    with tempfile.TemporaryDirectory(prefix="pliant-growth-") as name:
        folder = pathlib.Path(name)
        files = arguments.poses
        if not files:
            bake_cost.call(binary / "samples" / "creature" / "creature", "-o", folder)
            files = [folder / f"creature_{pose}.ply" for pose in ("rest", "reach", "curl")]
        meshes = [shapes.read_ply(file) for file in files]
        poses, triangles = [positions for positions, _ in meshes], meshes[0][1]
        print(bake_cost.continuity.line(HEAD), bake_cost.continuity.line(["---"] * len(HEAD)), sep="\n", flush=True)
        points = []
        for level in range(arguments.levels + 1):
            if level > 0:
                poses, triangles = shapes.subdivide(poses, triangles)
            seconds, memory, certificate = bake(binary / "baker" / "pliant", poses, triangles, arguments.options.split(),
                                                folder)
            points.append((len(poses[0]), seconds))
            measured = certificate["measured"]
            print(bake_cost.continuity.line([
                str(len(poses[0])), f"{seconds:.1f}", exponent(points), f"{memory:.2f}", str(certificate["factorizations"]),
                str(certificate["subspace"]["dimension"]),
                f"{measured['mean_error']:.1e} / {measured['largest_error']:.1e}"]), flush=True)
        draw(points, ROOT / "build" / "bench" / "growth.svg")
    return 0


if __name__ == "__main__":
    sys.exit(main())
