"""Runs `pliant pose` as a user does: test_pose.py CASE PLIANT. Exit code 77: skipped (the reason is printed)."""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SCRIPTS = ROOT / "samples" / "pose_scripts"
DATA = Path(os.environ.get("PLIANT_DATA") or ROOT.parent / "shared" / "data") / "tet_mid"
CASE, TOOL = sys.argv[1:3]
BEND = "box 0 0 0  1 1 0.1  hold\nbox 0 0 0.9  1 1 1  turn 0.5 0.5 0.5  1 0 0  60\n"


def skip(reason):
    print("skipped:", reason)
    sys.exit(77)


def write_bar(path, length=8):
    """A bar of cubes along z, six tetrahedra each, as Gmsh 2.2. Returns its vertices."""
    def number(i, j, k):
        return (k * 2 + j) * 2 + i
    vertices = [(i, j, k) for k in range(length + 1) for j in range(2) for i in range(2)]
    tets = []
    for k in range(length):
        corner = [number(b & 1, (b >> 1) & 1, k + (b >> 2)) for b in range(8)]
        # Six around the diagonal from corner 0 to corner 7, all right-handed.
        for a, b in ((1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)):
            tets.append([corner[0], corner[a], corner[b], corner[7]])
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(vertices))]
    lines += [f"{n} {x} {y} {z}" for n, (x, y, z) in enumerate(vertices, 1)]
    lines += ["$EndNodes", "$Elements", str(len(tets))]
    lines += [f"{n} 4 2 0 1 {' '.join(str(v + 1) for v in tet)}" for n, tet in enumerate(tets, 1)]
    path.write_text("\n".join(lines + ["$EndElements", ""]))
    return vertices


def read_msh(path):
    """Vertices and tetrahedra of a file that `pliant pose` wrote."""
    lines = path.read_text().splitlines()
    start = lines.index("$Nodes")
    vertices = [tuple(map(float, line.split()[1:])) for line in lines[start + 2:start + 2 + int(lines[start + 1])]]
    start = lines.index("$Elements")
    tets = [[int(v) - 1 for v in line.split()[-4:]] for line in lines[start + 2:start + 2 + int(lines[start + 1])]]
    return vertices, tets


def volume(a, b, c, d):
    u, v, w = ([p - q for p, q in zip(x, a)] for x in (b, c, d))
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6


def smallest_j(rest, posed):
    (before, tets), (after, same) = rest, posed
    assert tets == same, "the tetrahedra changed"
    return min(volume(*(after[v] for v in t)) / volume(*(before[v] for v in t)) for t in tets)


def run(*arguments, expected=0):
    result = subprocess.run([TOOL, "pose", *map(str, arguments)], capture_output=True, text=True, timeout=1000)
    assert result.returncode == expected, f"exit code {result.returncode}, not {expected}: {result.stderr}"
    return result.stdout, result.stderr


def case_bend(folder):
    rest, script, out, ply = (folder / name for name in ("bar.msh", "bend.txt", "bent.msh", "bent.ply"))
    vertices = write_bar(rest)
    script.write_text(BEND)
    stdout, stderr = run(rest, script, "-o", out, "--ply", ply)
    assert re.search(r"bent\.msh: energy \S+, smallest J 0\.\d+, 6 steps, \d+ iterations\n$", stdout), stdout
    assert re.search(r"bend\.txt:1: 4 vertices\n.*bend\.txt:2: 4 vertices\npliant pose: motion 0 %\n", stderr), stderr
    posed = read_msh(out)
    assert posed[0][:4] == vertices[:4], "the held end moved"
    assert smallest_j(read_msh(rest), posed) > 0.1
    assert ply.read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(vertices))
    first = out.read_bytes()
    assert run(rest, script, "-o", out, "-q") == ("", "") and out.read_bytes() == first, "a second run gives another pose"
    asset, blend = folder / "bar.pliant", folder / "blend.ply"
    subprocess.run([TOOL, "check", rest, out], check=True, capture_output=True)
    subprocess.run([TOOL, "bake", rest, out, "-o", asset, "-q"], check=True, capture_output=True)
    subprocess.run([TOOL, "blend", asset, "--weights", "1,1", "-o", blend], check=True, capture_output=True)
    assert blend.exists()


def case_mirrored(folder):
    """Corners numbered the other way round stay so: the baker turns those of all poses if they agree."""
    rest, script, out = (folder / name for name in ("bar.msh", "bend.txt", "bent.msh"))
    write_bar(rest)
    turned = re.sub(r"^(\d+ 4 2 0 1 \d+ \d+) (\d+) (\d+)$", r"\1 \3 \2", rest.read_text(), flags=re.MULTILINE)
    rest.write_text(turned)
    script.write_text(BEND)
    run(rest, script, "-o", out)
    assert smallest_j(read_msh(rest), read_msh(out)) > 0.1
    subprocess.run([TOOL, "check", rest, out], check=True, capture_output=True)


def case_snap(folder):
    """A bar that is twisted by two turns comes back to its rest pose, which must not happen in silence."""
    rest, script, out = (folder / name for name in ("bar.msh", "twist.txt", "twisted.msh"))
    write_bar(rest)
    for degrees in (180, 720):
        script.write_text(f"box 0 0 0 1 1 0.05 hold\nbox 0 0 0.95 1 1 1 turn 0.5 0.5 0.5 0 0 1 {degrees}\n")
        stdout, stderr = run(rest, script, "-o", out)
        energy = float(re.search(r"energy (\S+),", stdout)[1])
        assert ("warning P4307: the body snaps over at" in stderr) == (degrees == 720) == (energy < 1e-3), stdout + stderr


def case_all_errors(folder):
    """One run reports the bad lines of a script, and the bad mesh, with file and line. tests/bad_input has each error."""
    rest, script, out = (folder / name for name in ("bar.msh", "wrong.txt", "bent.msh"))
    write_bar(rest)
    rest.write_text(rest.read_text().replace("\n5 0 0 1\n", "\n5 0 nan 1\n", 1))
    script.write_text("cube\n" + BEND + "sphere 1\n")
    _, err = run(rest, script, "-o", out, expected=3)
    for text in ("wrong.txt:1: region 'cube'", "wrong.txt:4: sphere has 1 of 4", "bar.msh:10: "):
        assert text in err, err
    assert err.index("bar.msh:10: ") < err.index("wrong.txt:1: "), "the mesh is judged first"
    assert not out.exists()


def case_over_script(folder):
    """Neither output replaces an input."""
    rest, script = folder / "bar.msh", folder / "bend.ply"
    write_bar(rest)
    script.write_text(BEND)
    _, err = run(rest, script, "-o", folder / "bent.msh", "--ply", script, expected=1)
    assert "error P4004" in err and script.read_text() == BEND and not (folder / "bent.msh").exists(), err


def case_help(folder):
    out, _ = run("--help")
    for word in ("box", "sphere", "vertices", "hold", "move", "turn", "fractions", "--ply", "--material", "Example",
                 "pliant bake"):
        assert word in out, f"--help does not explain {word}"


def case_examples(folder):
    """The example scripts for the public meshes; the smaller ones, the others take minutes."""
    if not (DATA / "bear.msh").exists():
        skip(f"no solids in {DATA}: set PLIANT_DATA")
    for script in sorted(SCRIPTS.glob("bear_*.txt")):
        out = folder / (script.stem + ".msh")
        run(DATA / "bear.msh", script, "-o", out)
        assert smallest_j(read_msh(DATA / "bear.msh"), read_msh(out)) > 0.05, script


with tempfile.TemporaryDirectory(prefix="pliant_pose_") as temporary:
    globals()["case_" + CASE](Path(temporary))
