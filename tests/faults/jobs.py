"""The small jobs that run.py disturbs: command lines of the tool, what they read and what they write."""
import json
import math
from dataclasses import dataclass

OLD = b"old\n"
LEAST = ("--dim", "2", "--check-samples", "2", "--fresh-samples", "1")


@dataclass
class Job:
    name: str
    words: list       # the command line
    inputs: list      # names of files; of an asset "a.pliant" it is made once
    outputs: list     # names, in the order in which they are written
    code: int = 0     # exit code of the undisturbed run
    forks: bool = True  # one process with one thread: every allocation can fail in a child (inject.c)
    kinds: tuple = ()   # the kinds of calls that are disturbed; none: all


def sheet(is_rolled, rows=6, columns=3):
    """A flat or rolled sheet of triangles as OBJ."""
    lines = []
    for i in range(rows):
        x, z = (4 * math.sin(i / 4), 4 - 4 * math.cos(i / 4)) if is_rolled else (i, 0)
        lines += [f"v {x!r} {k} {z!r}" for k in range(columns)]
    for i in range(rows - 1):
        for k in range(columns - 1):
            a = i * columns + k + 1
            lines += [f"f {a} {a + columns} {a + columns + 1}", f"f {a} {a + columns + 1} {a + 1}"]
    return "\n".join(lines).encode() + b"\n"


def bar(is_bent):
    """Two bricks of six tetrahedra each as MEDIT."""
    points = [(i, k, m) for i in range(3) for k in range(2) for m in range(2)]
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
    for x, y, z in points:
        if is_bent:
            x, y = (3 - y) * math.sin(x / 3), 3 - (3 - y) * math.cos(x / 3)
        lines.append(f"{x!r} {y!r} {z!r} 0")
    tets = []
    for i in range(2):
        corner = [1 + 4 * i + d for d in (0, 4, 2, 6, 1, 5, 3, 7)]  # x fastest, then y, then z
        tets += [[corner[0], corner[a], corner[b], corner[7]]
                 for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1))]
    lines += ["Tetrahedra", str(len(tets))] + [" ".join(map(str, tet)) + " 0" for tet in tets]
    return "\n".join(lines + ["End", ""]).encode()


def manifest():
    bakes = [{"poses": order, "output": output, "dim": 2, "check_samples": 2, "fresh_samples": 1, "threads": 1}
             for order, output in ((["flat.obj", "roll.obj"], "b.pliant"), (["roll.obj", "flat.obj"], "c.pliant"))]
    return json.dumps({"bakes": bakes}).encode()


FILES = {"flat.obj": sheet(False), "roll.obj": sheet(True), "bad.obj": sheet(True).replace(b"f 1 4 5", b"f 1 4 99"),
         "flat.mesh": bar(False), "roll.mesh": bar(True), "all.json": manifest(), "path.csv": b"1,0\n0.5,0.5\n"}
SHEETS = ["flat.obj", "roll.obj"]
FILE_KINDS = ("write", "message", "fsync", "rename", "open", "read", "unlink", "stat", "lock", "mode")

JOBS = [
    Job("bake", ["bake", *SHEETS, *LEAST, "--threads", "1", "--report", "a.json", "--depfile", "a.d", "--stamp", "a.stamp",
                 "-o", "a.pliant"], SHEETS, ["a.d", "a.json", "a.pliant", "a.stamp"]),
    Job("bake_eigen", ["bake", *SHEETS, *LEAST, "--threads", "1", "--solver", "eigen", "-o", "a.pliant"], SHEETS,
        ["a.pliant"], kinds=("alloc", "map")),
    Job("bake_layers", ["bake", *SHEETS, *LEAST, "--threads", "1", "--blend", "layers", "-o", "a.pliant"], SHEETS,
        ["a.pliant"], kinds=("alloc", "map")),
    Job("bake_solid", ["bake", "flat.mesh", "roll.mesh", *LEAST, "--threads", "1", "-o", "a.pliant"],
        ["flat.mesh", "roll.mesh"], ["a.pliant"], kinds=("alloc", "map")),
    Job("bake_threads", ["bake", *SHEETS, *LEAST, "--threads", "4", "-o", "a.pliant"], SHEETS, ["a.pliant"], forks=False,
        kinds=("thread", "alloc")),
    Job("check_bad", ["check", "flat.obj", "bad.obj"], ["flat.obj", "bad.obj"], [], code=3),
    Job("average", ["average", *SHEETS, "--threads", "1", "--grid", "1", "--list", "l.csv", "-o", "a_%d.ply"], SHEETS,
        ["a_0.ply", "a_1.ply", "l.csv"]),
    Job("blend", ["blend", "a.pliant", "-w", "1,1", "-o", "x.ply"], ["a.pliant"], ["x.ply"]),
    Job("blend_path", ["blend", "a.pliant", "--path", "path.csv", "-o", "x_%d.ply"], ["a.pliant", "path.csv"],
        ["x_0.ply", "x_1.ply"], kinds=FILE_KINDS),
    Job("export", ["export", "a.pliant", "--morph", "-o", "x.glb"], ["a.pliant"], ["x.glb"]),
    Job("report", ["report", "a.pliant", "-o", "x.html"], ["a.pliant"], ["x.html"]),
    Job("info", ["info", "a.pliant", "--json"], ["a.pliant"], []),
    Job("bake_all", ["bake-all", "all.json", "--jobs", "1"], [*SHEETS, "all.json"],
        ["b.pliant", "b.pliant.stamp", "c.pliant", "c.pliant.stamp"], forks=False),
]
