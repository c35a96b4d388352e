"""bake_cost.py [--against COMMIT] [--only TEXT] [--runs N]: bakes of another commit and of this tree side by side,
as a Markdown table. Both tools are built here, in build/release and in build/bench/COMMIT. Every set is baked N times (3) by
both in turns; seconds are medians. Errors are those of the certificates, mean / largest. Data: PLIANT_DATA; sets that are
not there are left out. The creature, the bars, and the poses of the cow (Spot, a solid) are made here."""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "baker" / "bake"))
import continuity  # noqa: E402: its sets of poses are ours

SETS = ["human_pair", "ict_face, 7 poses", "makehuman, 4 poses", "mhr, 5 poses"]
MOONEY_RIVLIN = ["--material", "mooney-rivlin"]
OPTIONS = {"PLIANT_BUILD_SAMPLES": ["creature"], "PLIANT_BUILD_TESTS": ["pliant_bar", "pliant_bench_frame"]}
HEAD = ["set", "seconds", "now", "ratio", "factorisations", "now", "d", "now", "error", "now"]


def call(*command, **options):
    subprocess.run([str(part) for part in command], check=True, stdout=sys.stderr, **options)


def build(source, *targets):
    """The folder of a release build of the tree `source`, brought up to date."""
    options = [f"-D{option}={'ON' if set(wanted) & set(targets) else 'OFF'}" for option, wanted in OPTIONS.items()]
    call("cmake", "--preset", "release", *options, cwd=source)
    call("cmake", "--build", "--preset", "release", "--target", *targets, "--parallel", os.cpu_count(), cwd=source)
    return source / "build" / "release"


def checkout(commit):
    folder = ROOT / "build" / "bench" / commit
    if not folder.exists():
        call("git", "clone", "--quiet", "--no-checkout", ROOT, folder)
        call("git", "checkout", "--quiet", "--detach", commit, cwd=folder)
    return folder


def solids(binary, folder):
    """Bars, straight and twisted by a quarter of a turn, and a cow in three poses."""
    call(binary / "tests" / "paper" / "pliant_bar", "--write", folder)
    bars = [str(folder / f"bar_{name}.msh") for name in ("straight", "90")]
    yield "bar, stvk", bars, []
    yield "bar, mooney-rivlin", bars, MOONEY_RIVLIN
    cow = continuity.DATA / "tet_mid" / "spot.msh"
    poses = [str(cow)]
    for name in ("look", "leap") if cow.exists() else ():
        poses.append(str(folder / f"spot_{name}.msh"))
        script = ROOT / "samples" / "pose_scripts" / f"spot_{name}.txt"
        call(binary / "baker" / "pliant", "pose", cow, script, "-o", poses[-1])
    yield "cow, mooney-rivlin", poses, MOONEY_RIVLIN


def surfaces(binary, folder):
    """Name, poses and options; the poses that are made go to `folder`."""
    call(binary / "samples" / "creature" / "creature", "-o", folder)
    yield "creature", [str(folder / f"creature_{pose}.ply") for pose in ("rest", "reach", "curl", "leap", "twist")], []
    for name, patterns, options in continuity.SETS:
        if name in SETS:
            yield name, [str(continuity.DATA / pattern) for pattern in patterns], options


def sets(binary, folder):
    yield from surfaces(binary, folder)
    yield from solids(binary, folder)


def bake(tool, poses, options, asset):
    start = time.monotonic()
    call(tool, "bake", *poses, *options, "-o", asset, "--best-effort", "--quiet")
    seconds = time.monotonic() - start
    info = subprocess.run([tool, "info", asset, "--json"], check=True, capture_output=True, text=True).stdout
    return seconds, json.loads(info)["certificate"]


def row(name, tools, poses, options, runs):
    """One line of the table; the bakes take turns, so that other work on the machine meets both."""
    with tempfile.TemporaryDirectory(prefix="pliant-bake-cost-") as folder:
        bakes = [[bake(tool, poses, options, pathlib.Path(folder) / "a.pliant") for tool in tools] for _ in range(runs)]
    seconds = [statistics.median(turn[i][0] for turn in bakes) for i in range(2)]
    cells = [name, f"{seconds[0]:.1f}", f"{seconds[1]:.1f}", f"{seconds[0] / seconds[1]:.1f}"]
    certificates = [certificate for _, certificate in bakes[0]]
    cells += [str(certificate["factorizations"]) for certificate in certificates]
    cells += [str(certificate["subspace"]["dimension"]) for certificate in certificates]
    measured = [certificate["measured"] for certificate in certificates]
    return cells + [f"{m['mean_error']:.1e} / {m['largest_error']:.1e}" for m in measured]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--against", default="cb03c8b", metavar="COMMIT")
    parser.add_argument("--only", default="", metavar="TEXT")
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    binary = build(ROOT, "pliant", "creature", "pliant_bar")
    tools = [build(checkout(arguments.against), "pliant") / "baker" / "pliant", binary / "baker" / "pliant"]
    print(continuity.line(HEAD), continuity.line(["---"] * len(HEAD)), sep="\n", flush=True)
    with tempfile.TemporaryDirectory(prefix="pliant-creature-") as folder:
        for name, poses, options in sets(binary, pathlib.Path(folder)):
            if arguments.only in name and all(map(os.path.exists, poses)):
                print(continuity.line(row(name, tools, poses, options, arguments.runs)), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
