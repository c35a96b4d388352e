"""run.py CHECK [PACKAGE]: CHECK is the build folder of CMakeLists.txt beside this file.

The blends of the assets in tests/golden must have the hashes in blends.txt there, on every system. With PACKAGE, the npm
package as runtime/bindings/web/build.py makes it, node must get the same, and the bits that this system's C library has for
the small assets of tests/runtime (numpy makes them, so they may differ between systems), and refuse the bad files made of
them."""
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/runtime"))
import compare_bits  # noqa: E402

SPOILED = ["strip_neo", "strip_load", "beam_mooney", "beam_quartic", "tube_compact_fine", "strip_tied", "beam_ranges",
           "strip_factored", "layers_mixed"]


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def compare(what, found, expected):
    wrong = compare_bits.first_difference(expected, found)
    print(f"{what}: {wrong or 'the same bits'}")
    if wrong:
        sys.exit(1)


def main(check, package=None):
    program = shutil.which("bits", path=str(check)) or sys.exit(f"no program bits in {check}")
    compare("golden assets", run(program, compare_bits.GOLDEN), compare_bits.blends())
    if package:
        assets, museum, tests = check / "assets", check / "museum", ROOT / "tests"
        run(sys.executable, "-B", tests / "runtime/make_test_assets.py", assets)
        spoiled = [assets / f"{name}.pliant" for name in SPOILED]
        run(sys.executable, "-B", tests / "runtime/make_bad_assets.py", *spoiled, museum)
        found = run("node", tests / "platforms/package.mjs", package, assets, compare_bits.GOLDEN, museum)
        compare("node", found, run(program, assets, compare_bits.GOLDEN))


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    main(*map(Path, sys.argv[1:]))
