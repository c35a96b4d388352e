"""What the tests of `pliant report` share: running the tool, reports of bakes by hand,
an asset with the pose names of a stranger."""
import json
import pathlib
import struct
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3]))
from asset_checksums import with_checksums  # noqa: E402


def check(condition, text):
    if not condition:
        print(f"FAILED: {text}")
        sys.exit(1)


def run(tool, *arguments, code=0):
    result = subprocess.run([tool, *map(str, arguments)], capture_output=True, text=True, timeout=200)
    check(result.returncode == code,
          f"{' '.join(map(str, arguments))}: exit code {result.returncode}, wanted {code}\n{result.stdout}{result.stderr}")
    return result.stdout + result.stderr


def information(tool, asset):
    return json.loads(subprocess.run([tool, "info", "--json", str(asset)], capture_output=True, check=True,
                                     timeout=60).stdout)


def rename_poses(source, target, names):
    """The asset with other names of poses, which together need as many bytes as the old ones have."""
    blob = bytearray(source.read_bytes())
    start = blob.find(b"pose 0\0")
    size = len(b"".join(b"pose %d\0" % k for k in range(len(names))))
    new = b"".join(name.encode() + b"\0" for name in names)
    check(start > 0 and len(new) == size, f"{source}: the names have {size} bytes, the new ones {len(new)}")
    blob[start:start + size] = new
    target.write_bytes(with_checksums(blob))


def hostile_names(count):
    """Names of `count` poses, the first of them a script, in as many bytes as 'pose 0', 'pose 1', ... take."""
    first = "<script>alert(1)</script>"
    size = sum(len(f"pose {k}") for k in range(count)) - len(first)
    names = [first] + ["p"] * (count - 1)
    for i in range(size - (count - 1)):
        names[1 + i % (count - 1)] += "x"
    return names


def write_report(tool, source, path, /, **changes):
    """What `pliant bake --report` would have said of the asset."""
    report = information(tool, source)["certificate"]
    report.update(seconds={"load": 0.25, "subspace": 12.5}, asset=source.name, cubature_residual=1e-3,
                  warnings=[dict(number=2204, where="rest.obj:7", what="faces 0 and 1 run along their edge",
                                 hint="turn <one>", vertices=[], faces=[0, 1])])
    report.update(changes)
    path.write_text(json.dumps({key: value for key, value in report.items() if value is not None}))


def tube(bend, count=10, around=8):
    """An ASCII OFF of a bent tube along y; its face 3 is turned over, which check and bake warn of (P2204)."""
    import math
    points, faces = [], []
    for i in range(count):
        angle = bend * i / (count - 1)
        for k in range(around):
            phi = 2 * math.pi * k / around
            x, z, y = 0.3 * math.cos(phi), 0.3 * math.sin(phi), 2.0 * i / (count - 1)
            points.append((x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle), z))
    for i in range(count - 1):
        for k in range(around):
            a, b = i * around + k, i * around + (k + 1) % around
            faces += [(a, b, a + around), (b, b + around, a + around)]
    faces[3] = faces[3][::-1]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0"] + [f"{x!r} {y!r} {z!r}" for x, y, z in points]
                     + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"


def book(angle, rows=4):
    """An ASCII OFF of a sheet, folded at its spine: vertices 2 rows .. 3 rows - 1."""
    import math
    points = []
    for column in (-2, -1, 0, 1, 2):
        turn = angle if column > 0 else 0.0
        points += [(column * math.cos(turn), 0.8 * row, column * math.sin(turn)) for row in range(rows)]
    faces = []
    for a in (column * rows + row for column in range(4) for row in range(rows - 1)):
        faces += [(a, a + rows, a + 1), (a + 1, a + rows, a + rows + 1)]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0"] + [f"{x!r} {y!r} {z!r}" for x, y, z in points]
                     + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"


def bent_sheet(left=0.0, right=0.0, columns=13, rows=5):
    """An ASCII OFF of a sheet whose two sides bend, each on its own."""
    import math
    points = []
    for column in range(columns):
        x = 4 * column / (columns - 1) - 2
        side, angle = (-1, left) if x < 0 else (1, right)
        along = max(abs(x) - 0.3, 0.0) if angle else 0.0
        reach = abs(x) if not along else 0.3 + math.sin(along * angle) / angle
        points += [(side * reach, 0.6 * row, (1 - math.cos(along * angle)) / angle if along else 0.0) for row in range(rows)]
    faces = []
    for a in (column * rows + row for column in range(columns - 1) for row in range(rows - 1)):
        faces += [(a, a + rows, a + 1), (a + 1, a + rows, a + rows + 1)]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0"] + [f"{x!r} {y!r} {z!r}" for x, y, z in points]
                     + [f"3 {a} {b} {c}" for a, b, c in faces]) + "\n"


def bake_shapes(tool, folder, name, shapes, dimension, *options):
    """Bakes OFF files of these texts. Returns the report, which stands beside the folder of its asset, out/."""
    poses = []
    for k, shape in enumerate(shapes):
        poses.append(folder / f"{name}_{k}.off")
        poses[-1].write_text(shape)
    (folder / "out").mkdir(exist_ok=True)
    run(tool, "bake", *poses, "-o", folder / "out" / f"{name}.pliant", "--report", folder / f"{name}.json", "--dim",
        dimension, "--elements", 2 * dimension + 4, "-q", *options)
    return folder / f"{name}.json"


def png_size(data):
    return struct.unpack(">II", data[16:24])
