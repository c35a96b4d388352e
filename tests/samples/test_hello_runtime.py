"""Runs hello_runtime on the golden asset: test_hello_runtime.py PROGRAM."""
import subprocess
import sys
from pathlib import Path

ASSET = Path(__file__).resolve().parents[1] / "golden" / "format_1_0.pliant"


def run(*arguments, stdout=subprocess.PIPE):
    return subprocess.run([sys.argv[1], *map(str, arguments)], stdout=stdout, stderr=subprocess.PIPE, text=True, timeout=60)


equal = run(ASSET)
assert equal.returncode == 0 and "converged" in equal.stdout and "first of 12 vertices" in equal.stdout, equal
corner = run(ASSET, 1, 0)
assert corner.returncode == 0 and corner.stdout != equal.stdout, corner
for wrong in ([], ["missing.pliant"], [__file__], [ASSET, 0, 0], [ASSET, -1, 1]):
    result = run(*wrong)
    assert result.returncode == 1 and result.stderr.startswith("hello_runtime: error: "), (wrong, result)
if Path("/dev/full").exists():
    with open("/dev/full", "w", encoding="utf-8") as full:
        unwritten = run(ASSET, stdout=full)
    assert unwritten.returncode == 1 and "standard output" in unwritten.stderr, unwritten
