"""test_read_back.py TOOL READER ASSET: what `pliant export` writes is read as poses again. Vertices and triangles are those
of the asset, without the box; integers are as near as asked; compressed ones are the same to the bit. READER is
read_poses_tool."""
import pathlib
import subprocess
import sys

import numpy as np

from support import Glb, check, export


def read(reader, folder, glb, choice=""):
    """Positions of the poses, and triangles."""
    poses = folder / "poses"
    poses.mkdir(exist_ok=True)
    for old in poses.iterdir():
        old.unlink()
    result = subprocess.run([reader, poses, f"{glb}{choice}"], capture_output=True, text=True, timeout=60)
    check(result.returncode == 0 and not result.stderr, f"{glb}: {result.stderr}")
    count = len(result.stdout.splitlines())
    return (np.array([np.fromfile(poses / f"{k}.positions").reshape(-1, 3) for k in range(count)]),
            np.fromfile(poses / "triangles", np.uint32).reshape(-1, 3))


def first_least(triangles):
    """Turned, not turned over, so that the least corner leads."""
    turns = triangles.argmin(axis=1)[:, None] + np.arange(3)
    return np.take_along_axis(triangles, turns % 3, axis=1)


def main():
    tool, reader, asset = sys.argv[1:]
    folder = pathlib.Path("read_back").resolve()
    folder.mkdir(exist_ok=True)
    found = {}
    for options in ("", "--quantize 1e-4", "--meshopt", "--skin 3", "--skin 3 --meshopt"):
        glb = folder / ((options.replace(" ", "") or "plain") + ".glb")
        export(tool, asset, glb, *options.split())
        found[options] = read(reader, folder, glb, "#animation=0@0,0.5,3" if "skin" in options else "")
    plain, skin = found[""], found["--skin 3"]
    glb = Glb(folder / "plain.glb")
    n, d = glb.own_count(), len(glb.json["meshes"][0]["weights"])
    check(plain[0].shape == (d + 1, n, 3), f"{plain[0].shape} are not {d + 1} poses of {n} vertices")
    check((plain[1] == glb.accessor(glb.primitive()["indices"]).reshape(-1, 3)[:-1]).all(), "triangles of the plain file")
    integers, packed = found["--quantize 1e-4"], found["--meshopt"]
    check((integers[0] == packed[0]).all(), "compression changes positions")
    for triangles in (integers[1], packed[1], skin[1], found["--skin 3 --meshopt"][1]):
        check((first_least(triangles) == first_least(plain[1])).all(), "triangles change")
    size = np.linalg.norm(np.ptp(plain[0][0], axis=0))
    off = abs(skin[0] - found["--skin 3 --meshopt"][0]).max() / size
    check(0 < off < 1.1e-4, f"a skin in integers is {off:.1e} of the diagonal away")
    away = abs(integers[0] - plain[0]).max() / size
    check(0 < away < 1e-3, f"single targets in integers are {away:.1e} of the diagonal away")  # no blends: no promise
    print(f"{n} vertices, {d} targets; skin in integers {off:.1e}, targets alone {away:.1e} of the diagonal")
    return 0


sys.exit(main())
