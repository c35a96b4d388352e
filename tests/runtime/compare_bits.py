"""compare_bits.py ASSETS PROGRAM PROGRAM...: several builds of test_bits must print the same hashes, for the assets in
tests/golden those in blends.txt there."""
import itertools
import pathlib
import subprocess
import sys

GOLDEN = pathlib.Path(__file__).resolve().parents[1] / "golden"
SKIPPED = 77


def blends():
    """The hashes that every build must print for the folder GOLDEN."""
    return (GOLDEN / "blends.txt").read_text(encoding="ascii")


def first_difference(expected, found):
    """What differs, or nothing."""
    for a, b in itertools.zip_longest(expected.splitlines(), found.splitlines(), fillvalue="nothing"):
        if a != b:
            return f"expected: {a}\nfound:    {b}"
    return ""


def main():
    assets, *programs = sys.argv[1:]
    first = None
    count = 0
    for program in programs:
        run = subprocess.run([program, assets, GOLDEN], capture_output=True, text=True)
        if run.returncode == SKIPPED:
            print(program, run.stdout.strip())
            continue
        if run.returncode != 0:
            print(program, run.stderr)
            return 1
        first = first or run.stdout
        golden = "".join(line for line in run.stdout.splitlines(keepends=True) if line.startswith("format_"))
        wrong = first_difference(blends(), golden) or first_difference(first, run.stdout)
        print(program, wrong or f"{len(run.stdout.splitlines())} lines, the same")
        if wrong:
            return 1
        count += 1
    if count < 2:
        print("skipped: only one of the builds runs on this processor")
        return SKIPPED
    return 0


if __name__ == "__main__":
    sys.exit(main())
