"""Runs pose_solid as a user would: test_pose_solid.py CASE POSE_SOLID PLIANT. Exit code 77: skipped (the reason is printed)."""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
SCRIPTS = ROOT / "samples" / "pose_scripts"
DATA = Path(os.environ.get("PLIANT_DATA") or ROOT.parent / "shared" / "data") / "tet_mid"
CASE, PROGRAM, TOOL = sys.argv[1:4]
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
    """Vertices and tetrahedra of a file that pose_solid wrote."""
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
    result = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=1000)
    assert result.returncode == expected, f"exit code {result.returncode}, not {expected}: {result.stderr}"
    return result.stdout, result.stderr


def refused(folder, code, text, *arguments):
    """Runs on something wrong: exit code, what the error says, a hint, and no file more than before."""
    before = sorted(folder.iterdir())
    _, err = run(*arguments, expected=code)
    assert err.startswith("pose_solid: error") and text in err and "\n  hint: " in err, err
    assert sorted(folder.iterdir()) == before, "something was written"


def case_bend(folder):
    rest, script, out, ply = (folder / name for name in ("bar.msh", "bend.txt", "bent.msh", "bent.ply"))
    vertices = write_bar(rest)
    script.write_text(BEND)
    stdout, stderr = run(rest, "-o", out, "-s", script, "--ply", ply)
    assert re.search(r"bent\.msh: energy \S+, smallest J 0\.\d+, 6 steps, \d+ iterations\n$", stdout), stdout
    steps = re.findall(r"energy (\S+) \(from (\S+)\), smallest J (\S+),", stderr)
    assert len(steps) == 6 and all(float(after) <= float(before) for after, before, _ in steps), stderr
    posed = read_msh(out)
    assert posed[0][:4] == vertices[:4], "the held end moved"
    assert smallest_j(read_msh(rest), posed) > 0.1
    assert ply.read_bytes().startswith(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % len(vertices))
    quiet, nothing = run(rest, "-o", out, "-s", script, "-q")
    assert quiet == stdout and nothing == "" and read_msh(out) == posed, "a second run gives another pose"
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
    run(rest, "-o", out, "-s", script)
    assert smallest_j(read_msh(rest), read_msh(out)) > 0.1
    subprocess.run([TOOL, "check", rest, out], check=True, capture_output=True)


def case_wrong_scripts(folder):
    rest, script, out = (folder / name for name in ("bar.msh", "wrong.txt", "bent.msh"))
    write_bar(rest)
    for line, text in (
        ("cube 0 0 0 1 1 1 hold", "region 'cube'"), ("box 0 0 0 1 1 hold", "box has 5 of 6 numbers"),
        ("box 0 0 0 1 1 x hold", "'x' is not a number"), ("box 0 0 1 1 1 0 hold", "above the second"),
        ("sphere 0 0 0 0 hold", "radius"), ("sphere 0 0 0 nan hold", "not a number"), ("vertices hold", "no vertex is named"),
        ("vertices 1 2 3.5 hold", "not the number of a vertex"), ("vertices 1 2 99 hold", "vertex 99 is not there"),
        ("vertices 1 2 3", "nothing is said"), ("vertices 8 9 10 lift", "not the number of a vertex"),
        ("box 0 0 0 1 1 0.5 lift 1", "motion 'lift'"), ("box 0 0 0 1 1 0.5 move 1 2", "move has 2 of 3 numbers"),
        ("box 0 0 0 1 1 0.5 turn 0 0 0 0 0 0 90", "no direction"), ("box 0 0 0 1 1 0.5 hold move 1 0 0", "held and moved"),
        ("box 2 2 2 3 3 3 hold", "no vertex lies"), ("box 0 0 0 1 1 0.05 hold", "belong to earlier lines"),
    ):
        script.write_text(BEND + "# wrong\n" + line + "\n")
        refused(folder, 3, f"{script}:4: ", rest, "-o", out, "-s", script)
        refused(folder, 3, text, rest, "-o", out, "-s", script)
    for whole, text in (("# nothing\n", "no line with a handle"), ("box 0 0 0 1 1 0 hold\n", "every region is held"),
                        ("box 0 0 0 1 1 1 move 1 0 0\n", "all vertices"), ("vertices 0 1 move 1 0 0\n", "could still turn"),
                        ("vertices 0 4 8 move 1 0 0\n", "on a line")):
        script.write_text(whole)
        refused(folder, 3, text, rest, "-o", out, "-s", script)
    script.write_text("cube\n" + BEND + "sphere 1\n")  # all of them at once
    _, err = run(rest, "-o", out, "-s", script, expected=3)
    assert "wrong.txt:1:" in err and "wrong.txt:4:" in err, err


def case_wrong_files(folder):
    rest, script, out = (folder / name for name in ("bar.msh", "bend.txt", "bent.msh"))
    write_bar(rest)
    script.write_text(BEND)
    surface = folder / "surface.off"
    surface.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
    refused(folder, 3, "is a surface", surface, "-o", out, "-s", script)
    refused(folder, 3, "missing.msh", folder / "missing.msh", "-o", out, "-s", script)
    refused(folder, 3, "missing.txt", rest, "-o", out, "-s", folder / "missing.txt")
    refused(folder, 1, "is also the input", rest, "-o", rest, "-s", script)
    refused(folder, 1, "nowhere", rest, "-o", folder / "nowhere" / "x.msh", "-s", script)
    refused(folder, 2, "does not end in .msh", rest, "-o", folder / "bent.ply", "-s", script)
    refused(folder, 2, "--script", rest, "-o", out)
    refused(folder, 2, "--poisson", rest, "-o", out, "-s", script, "--poisson", "0.5")
    # No way to get there: nothing is written either.
    script.write_text("box 0 0 0  1 1 0.45  hold\nbox 0 0 0.55  1 1 1  move 0 0 -0.9\n")
    refused(folder, 1, "stuck at", rest, "-o", out, "-s", script, "-q")
    refused(folder, 1, "try --material mooney-rivlin", rest, "-o", out, "-s", script, "-q", "--material", "stvk")


def case_help(folder):
    out, _ = run("--help")
    for word in ("box", "sphere", "vertices", "hold", "move", "turn", "fractions", "--ply", "--material", "Example", "Exit codes"):
        assert word in out, f"--help does not explain {word}"


def case_examples(folder):
    """The example scripts for the public meshes; the smaller ones, the others take minutes."""
    if not (DATA / "bear.msh").exists():
        skip(f"no solids in {DATA}: set PLIANT_DATA")
    for script in sorted(SCRIPTS.glob("bear_*.txt")):
        out = folder / (script.stem + ".msh")
        run(DATA / "bear.msh", "-o", out, "-s", script)
        assert smallest_j(read_msh(DATA / "bear.msh"), read_msh(out)) > 0.05, script


with tempfile.TemporaryDirectory(prefix="pliant_pose_solid_") as temporary:
    globals()["case_" + CASE](Path(temporary))
