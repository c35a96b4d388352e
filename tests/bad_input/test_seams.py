"""test_seams.py PLIANT: every verb on a flat-shaded mesh with a face that is a line, and the same on the joined one. What is
written has the vertices and faces of the files; what is measured is the same. Messages name vertices and faces of the
files."""
import json
import pathlib
import subprocess
import sys
import tempfile

import generate

TOOL = sys.argv[1]
QUICK = ["--quiet", "--dim", "4", "--elements", "24", "--check-samples", "2", "--fresh-samples", "1", "--solver", "eigen"]
failures = []


def check(condition, text):
    print(("ok      " if condition else "FAILED  ") + text)
    if not condition:
        failures.append(text)


def run(*arguments):
    return subprocess.run([TOOL, *map(str, arguments)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          timeout=300)


def counts(ply):
    header = ply.read_bytes().split(b"end_header")[0].decode()
    return [int(line.split()[2]) for line in header.splitlines() if line.startswith("element")]


def points(ply):
    header, body = ply.read_bytes().split(b"end_header\n")
    count = int(header.split(b"element vertex ")[1].split()[0])
    return memoryview(body[:12 * count]).cast("f").tolist()


def distance(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def make_poses(folder):
    """Joined, split, and split with a line behind the last face."""
    poses = {"joined": [], "split": []}
    for name, mesh in (("rest", generate.good()), ("bent", generate.bent())):
        poses["joined"].append(folder / f"joined_{name}.obj")
        poses["split"].append(folder / f"split_{name}.obj")
        generate.write_mesh(poses["joined"][-1], mesh)
        generate.write_mesh(poses["split"][-1], generate.split(mesh).plus([], [(0, 1, 0)]))
    return poses


def test_quads(folder):
    """Faces of four corners, split, are written with four."""
    files = [folder / "quads.obj", folder / "quads_bent.obj"]
    for file, motion in zip(files, (generate.saddle, generate.roof)):
        generate.write_mesh(file, generate.split(generate.sheet(motion, quads=True, n=6)))
    baked = run("bake", *files, "-o", folder / "quads.pliant", *QUICK)
    check(baked.returncode == 0, f"split quads bake {baked.stderr}")
    run("blend", folder / "quads.pliant", "--weights", "1,0", "-o", folder / "quads.ply")
    check(counts(folder / "quads.ply") == [144, 36], "their blend has the vertices and faces of the files")
    measured = run("measure", folder / "quads.pliant", *files, "--samples", "1")
    check(measured.returncode == 0, f"all their rows reproduce the poses {measured.stderr}")


def main():
    with tempfile.TemporaryDirectory(prefix="pliant-test-") as name:
        folder = pathlib.Path(name)
        poses = make_poses(folder)
        faces = generate.good().faces
        measured = {}
        for kind, files in poses.items():
            asset = folder / f"{kind}.pliant"
            baked = run("bake", *files, "-o", asset, *QUICK)
            check(baked.returncode == 0, f"{kind}: bakes {baked.stderr}")
            check(run("validate", asset).returncode == 0, f"{kind}: is valid")
            blend = run("blend", asset, "--weights", "1,1", "-o", folder / f"{kind}_blend.ply")
            average = run("average", *files, "--weights", "1,1", "-o", folder / f"{kind}_average.ply", "--quiet")
            check(blend.returncode == 0 and average.returncode == 0, f"{kind}: blend and average {blend.stderr}")
            result = run("measure", asset, *files, "--samples", "2", "--json")
            check(result.returncode == 0, f"{kind}: is measured {result.stderr}")
            measured[kind] = [sample["relative_l2"] for sample in json.loads(result.stdout)["samples"]]
            if kind == "split":
                check("P2220" in baked.stderr
                      and "P2201: " + str(files[0]) + ":1025: face 256 uses vertex 0" in baked.stderr,
                      f"what was done is said {baked.stderr}")
                from_blend = run("measure", asset, *files, "--samples", "1", "--from-blend")
                check(from_blend.returncode == 0, f"measured from the blends {from_blend.stderr}")
                wrong = run("measure", asset, *poses["joined"], "--samples", "1")
                check("error P5104" in wrong.stderr, f"the joined poses are other ones {wrong.stderr}")
                apart = run("check", *files, "--weld", "0")
                check(apart.returncode == 0 and "has 256 components" in apart.stderr,
                      f"--weld 0 keeps vertices apart {apart.stderr}")
        for shape in ("blend", "average"):
            check(counts(folder / f"split_{shape}.ply") == [768, 257], f"{shape}: vertices and faces of the files")
            check(counts(folder / f"joined_{shape}.ply") == [130, 256], f"{shape}: the same of the joined mesh")
        one, other = points(folder / "split_average.ply"), points(folder / "joined_average.ply")
        other = [other[3 * vertex + c] for face in faces for vertex in face for c in range(3)]
        test_quads(folder)
        check(distance(one, other) < 1e-5, f"the averages are the same: {distance(one, other):.1e} apart")
        check(all(abs(a - b) < 0.2 * max(a, b) for a, b in zip(*measured.values())), f"so are the errors: {measured}")
    return 1 if failures else 0


sys.exit(main())
