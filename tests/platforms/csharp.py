"""csharp.py ASSETS MUSEUM PROGRAM COMPILER: the C# file by Mono, on the one-file form of the runtime as a shared library.
Its blends have the bits of PROGRAM, which is test_bits of this machine, and those in tests/golden/blends.txt (Bits.cs). Exit
code 77, and the reason, without Mono."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests/runtime"))
import compare_bits  # noqa: E402

FLAGS = ["-shared", "-fPIC", "-O3", "-std=c99", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
SOURCES = [ROOT / "runtime/bindings/csharp/Runtime/Pliant.cs", HERE / "Bits.cs"]


def run(*command, **options):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout.strip()


def main():
    assets, museum, program, compiler = sys.argv[1:]
    if not shutil.which("mcs") or not shutil.which("mono"):
        print("skipped: Mono is not installed (bash samples/install_packages.sh engines)")
        return 77
    with tempfile.TemporaryDirectory(prefix="pliant-csharp-") as name:
        folder = pathlib.Path(name)
        run(sys.executable, "-B", ROOT / "runtime/make_single.py", folder)
        run(compiler, *FLAGS, folder / "pliant.c", "-o", folder / "libpliant.so", "-lm")
        run("mcs", "-warnaserror+", f"-out:{folder / 'Bits.exe'}", *SOURCES)
        here = run(program, assets) + "\n" + compare_bits.blends()
        there = run("mono", folder / "Bits.exe", assets, compare_bits.GOLDEN, museum,
                    env={**os.environ, "LD_LIBRARY_PATH": name})
    wrong = compare_bits.first_difference(here, there)
    print(wrong or f"{len(there.splitlines())} lines, the same")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
