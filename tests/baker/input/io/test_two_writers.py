"""test_two_writers.py TOOL: two processes write the same file at once. TOOL is load_poses_tool, which writes pose 0. Whoever
reads meanwhile sees one of the two files, whole. A full disk, kill -9 and other faults: tests/faults."""
import math
import os
import pathlib
import subprocess
import sys
import tempfile

TOOL = sys.argv[1]
SEGMENTS = 200
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text)
    if not condition:
        failures.append(text)


def write_sheet(path, height):
    """A wavy sheet of SEGMENTS x SEGMENTS quads: about one megabyte when written."""
    n = SEGMENTS + 1
    with open(path, "w", encoding="ascii") as file:
        for i in range(n):
            for k in range(n):
                file.write(f"v {i} {k} {height * math.sin(0.1 * i) * math.cos(0.07 * k):.6f}\n")
        for i in range(SEGMENTS):
            for k in range(SEGMENTS):
                a = i * n + k + 1
                file.write(f"f {a} {a + 1} {a + n + 1} {a + n}\n")


def command(output, *poses, repeat=1):
    return [TOOL, "--write", str(output), "--repeat", str(repeat), *map(str, poses)]


def test_two_writers(folder, poses, first, second):
    output = folder / "two"
    output.mkdir()
    target = output / "out.ply"
    writers = [subprocess.Popen(command(target, *order, repeat=100), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
               for order in (poses, poses[::-1])]
    seen = set()
    while any(writer.poll() is None for writer in writers):
        if target.exists():
            seen.add(target.read_bytes())
    check(all(writer.wait() == 0 for writer in writers), "two writers at once: both succeed")
    seen.add(target.read_bytes())
    check(seen <= {first, second}, f"whoever reads meanwhile sees a whole file ({len(seen)} different ones seen)")
    check(os.listdir(output) == ["out.ply"], "nothing else is left")


def main():
    with tempfile.TemporaryDirectory(prefix="pliant-test-") as name:
        folder = pathlib.Path(name)
        poses = [folder / "a.obj", folder / "b.obj"]
        write_sheet(poses[0], 3)
        write_sheet(poses[1], 5)
        wanted = []
        for order in (poses, poses[::-1]):
            subprocess.run(command(folder / "wanted.ply", *order), check=True)
            wanted.append((folder / "wanted.ply").read_bytes())
        test_two_writers(folder, poses, *wanted)
    return 1 if failures else 0


sys.exit(main())
