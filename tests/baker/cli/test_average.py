"""`pliant average` of shapes whose energies are nearly 0, and of one that the line from the mean does not reach:
test_average.py PLIANT. Without other packages."""
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

TOOL = sys.argv[1]
COLUMNS, ROWS, RADIUS = 24, 12, 4.0
FACES = [tuple(ROWS * i + j + k for k in corners) for i in range(COLUMNS - 1) for j in range(ROWS - 1)
         for corners in ((0, ROWS, ROWS + 1), (0, ROWS + 1, 1))]


def write_sheet(path, bend):
    lines = [f"v {x:.9g} {y} {z:.9g}" for i in range(COLUMNS) for x, z in [bend(i)] for y in range(ROWS)]
    path.write_text("\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES]) + "\n", encoding="utf-8")


def write_saddle(path, height):
    """13 x 5 vertices, stretched up to three times at the corners."""
    points = [(x, y, height * x * x * (y - 2)) for x in range(13) for y in range(5)]
    faces = [(5 * i + j, 5 * i + j + 5, 5 * i + j + 6, 5 * i + j + 1) for i in range(12) for j in range(4)]
    lines = [f"v {x} {y} {z:.9g}" for x, y, z in points]
    path.write_text("\n".join(lines + ["f " + " ".join(str(v + 1) for v in face) for face in faces]) + "\n")
    return points


def read(path, count=COLUMNS * ROWS):
    data = path.read_bytes()
    numbers = struct.unpack_from(f"<{3 * count}f", data, data.index(b"end_header\n") + 11)
    return [numbers[i:i + 3] for i in range(0, len(numbers), 3)]


with tempfile.TemporaryDirectory(prefix="pliant_average_") as temporary:
    work = pathlib.Path(temporary)
    write_sheet(work / "flat.obj", lambda i: (i, 0))
    write_sheet(work / "rolled.obj", lambda i: (RADIUS * math.sin(i / RADIUS), RADIUS - RADIUS * math.cos(i / RADIUS)))
    for weight in (0.5, 0.9):
        weights = f"{1 - weight},{weight}"
        result = subprocess.run([TOOL, "average", "flat.obj", "rolled.obj", "--weights", weights, "-o", "a.ply"], cwd=work,
                                capture_output=True, text=True, check=False)
        assert result.returncode == 0, (weights, result.stderr)
        points, turn = read(work / "a.ply"), (COLUMNS - 1) * weight / RADIUS
        chord = math.dist(points[0], points[(COLUMNS - 1) * ROWS])
        wanted = 2 * (COLUMNS - 1) / turn * math.sin(turn / 2)  # a part of a cylinder, as long as the sheet
        assert abs(chord - wanted) < 0.01 * COLUMNS, (weights, chord, wanted)
    write_saddle(work / "plane.obj", 0)
    saddle = write_saddle(work / "saddle.obj", 0.02)
    for weights in ("0.001,1", "0,1"):
        result = subprocess.run([TOOL, "average", "plane.obj", "saddle.obj", "--weights", weights, "-o", "a.ply"], cwd=work,
                                capture_output=True, text=True, check=False)
        assert result.returncode == 0, (weights, result.stderr)
        points = read(work / "a.ply", len(saddle))
        for v, point in enumerate(points):
            other = 37 * v % len(saddle)
            assert abs(math.dist(point, points[other]) - math.dist(saddle[v], saddle[other])) < 0.03, (weights, v)
print("passed")
