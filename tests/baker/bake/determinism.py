#!/usr/bin/env python3
"""The same input and options give the same bytes: determinism.py threads TOOL | compilers TOOL [SECOND_TOOL]

threads: baked by one thread, by two, and by two again. compilers: baked by TOOL and by a SECOND_TOOL that another compiler
made (tests/run.sh builds it with clang; without: exit code 77). A shell of three poses and a solid of two, with the solver
that fits each and with Eigen's; whole bakes that choose dimension and elements themselves, and unreduced averages."""
import itertools
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "runtime"))
import tiny_mesh
import tiny_solids


def write_obj(path, points, faces):
    lines = [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in points] + [f"f {a} {b} {c}" for a, b, c in faces + 1]
    path.write_text("\n".join(lines) + "\n")


def write_medit(path, points, tets):
    lines = ["MeshVersionFormatted 2", "Dimension 3", f"Vertices {len(points)}"]
    lines += [f"{x:.17g} {y:.17g} {z:.17g} 0" for x, y, z in points]
    lines += [f"Tetrahedra {len(tets)}"] + [f"{a} {b} {c} {d} 0" for a, b, c, d in tets + 1] + ["End"]
    path.write_text("\n".join(lines) + "\n")


def make_inputs(folder):
    rest, faces = tiny_mesh.tube(24, 10)
    for k, pose in enumerate(tiny_mesh.make_poses(rest, 3, np.random.default_rng(1))):
        write_obj(folder / f"tube{k}.obj", pose, faces)
    rest, tets, *_ = tiny_solids.beam(10, 4)
    for k, pose in enumerate(tiny_mesh.make_poses(rest, 2, np.random.default_rng(1))):
        write_medit(folder / f"beam{k}.mesh", pose, tets)
    return {"shell": [f"tube{k}.obj" for k in range(3)], "solid": [f"beam{k}.mesh" for k in range(2)]}


COMMANDS = {
    "shell": [["bake", "--tolerance", "5e-3", "--check-samples", "6", "--fresh-samples", "1"],
              ["bake", "--dim", "6", "--elements", "24", "--check-samples", "3", "--fresh-samples", "1", "--solver",
               "eigen"],
              ["average", "--weights", "0.2,0.3,0.5"]],
    "solid": [["bake", "--material", "mooney-rivlin", "--dim", "5", "--elements", "20", "--check-samples", "3"],
              ["bake", "--material", "stvk", "--dim", "5", "--check-samples", "3", "--solver", "eigen"]],
}


def run(tool, folder, poses, command, threads):
    suffix = "pliant" if command[0] == "bake" else "ply"
    out = folder / f"out.{suffix}"
    out.unlink(missing_ok=True)
    call = [tool, *command, *poses, "-o", out.name] + (["--threads", str(threads)] if command[0] == "bake" else [])
    answer = subprocess.run(call, cwd=folder, capture_output=True, text=True)
    if answer.returncode not in (0,) or not out.is_file():
        sys.exit(f"{' '.join(call)}: exit code {answer.returncode}\n{answer.stderr}")
    return out.read_bytes()


def first_difference(a, b):
    if len(a) != len(b):
        return f"{len(a)} and {len(b)} bytes"
    return f"byte {int(np.flatnonzero(np.frombuffer(a, np.uint8) != np.frombuffer(b, np.uint8))[0])} of {len(a)}"


def main():
    what, tool, *others = sys.argv[1:]
    if what == "compilers" and not (others and pathlib.Path(others[0]).is_file()):
        print("skipped: no tool of a second compiler (bash tests/run.sh makes one with clang)")
        return 77
    variants = [(tool, 1), (tool, 2), (tool, 2)] if what == "threads" else [(tool, 2), (others[0], 2)]
    failures = 0
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        inputs = make_inputs(folder)
        for kind, command in itertools.chain(*([(k, c) for c in COMMANDS[k]] for k in COMMANDS)):
            results = [run(path, folder, inputs[kind], command, threads) for path, threads in variants]
            wrong = [first_difference(results[0], result) for result in results[1:] if result != results[0]]
            print(f"{kind}: {' '.join(command)}: {len(results[0])} bytes, "
                  f"{'differ at ' + wrong[0] if wrong else 'the same'}", flush=True)
            failures += bool(wrong)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
