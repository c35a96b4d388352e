"""Runs several builds of test_bits and wants the same hash from all: compare_bits.py FOLDER PROGRAM PROGRAM..."""
import subprocess
import sys

SKIPPED = 77


def main():
    folder, programs = sys.argv[1], sys.argv[2:]
    seen = {}
    for program in programs:
        run = subprocess.run([program, folder], capture_output=True, text=True)
        print(program, run.stdout.strip())
        if run.returncode not in (0, SKIPPED):
            print(run.stderr)
            return 1
        if run.returncode == 0:
            seen[program] = run.stdout
    if len(seen) < 2:
        print("skipped: only one of the builds runs on this processor")
        return SKIPPED
    return 0 if len(set(seen.values())) == 1 else 1


if __name__ == "__main__":
    sys.exit(main())
