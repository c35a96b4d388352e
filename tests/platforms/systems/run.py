"""run.py CHECK [PACKAGE]: CHECK is the build folder of CMakeLists.txt beside this file.

The blends of the assets in tests/golden must have the hash in bits.txt, on every system. With PACKAGE, the npm package as
runtime/bindings/web/build.py makes it, node must get the bits that this system's C library has for the small assets of
tests/runtime (numpy makes them, so they may differ between systems), and refuse the bad files made of them."""
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SPOILED = ["strip_neo", "strip_load", "beam_mooney", "beam_quartic", "tube_compact_fine", "strip_tied", "beam_ranges",
           "strip_factored", "layers_mixed"]


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def compare(what, found, expected):
    print(f"{what}: {found}, expected {expected}")
    if found != expected:
        sys.exit(1)


def golden_assets(folder):
    folder.mkdir(exist_ok=True)
    paths = sorted((ROOT / "tests/golden").glob("*.pliant"))
    for path in paths:
        shutil.copy(path, folder)
    (folder / "assets.txt").write_text("\n".join(path.stem for path in paths) + "\n")
    return folder


def main(check, package=None):
    program = shutil.which("bits", path=str(check)) or sys.exit(f"no program bits in {check}")
    compare("golden assets", run(program, golden_assets(check / "golden")), (HERE / "bits.txt").read_text().strip())
    if package:
        assets, museum, tests = check / "assets", check / "museum", ROOT / "tests"
        run(sys.executable, "-B", tests / "runtime/make_test_assets.py", assets)
        spoiled = [assets / f"{name}.pliant" for name in SPOILED]
        run(sys.executable, "-B", tests / "runtime/make_bad_assets.py", *spoiled, museum)
        compare("node", run("node", tests / "platforms/package.mjs", package, assets, museum), run(program, assets))


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*map(Path, sys.argv[1:]))
