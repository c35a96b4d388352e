"""pliant_bar on a coarse bar, and the kept results of the fine one: the paper's figures within a band, its ranking of
subspaces, and what the adaptive one promises.
Usage: test_bar.py PLIANT_BAR"""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path


def check_ranking(mean):
    """Of mean errors by basis and dimension."""
    for d in (3, 9, 17):  # the paper: 8, 23 and 10 times at 90 degrees
        assert 8 * mean["Algorithm 1", d] < mean["Barbic et al.", d]
    assert mean["Algorithm 1", 9] < 0.1 * mean["Krylov of differences", 9]
    assert mean["Algorithm 1", 9] < mean["Algorithm 1", 3]
    assert mean["adaptive", 3] < mean["Algorithm 1", 3]
    assert mean["adaptive", 5] < 0.1 * mean["Algorithm 1", 9]


def check_kept(rows, angle):
    """The bar of tests/paper/README.md: Algorithm 1's mean error is a sixth to twice that of the paper."""
    mean = {(row["basis"], int(row["d"])): float(row[f"{angle} degrees, mean"]) for row in rows}
    for row in rows:
        if row["basis"] == "Algorithm 1":
            ratio = float(row[f"{angle} degrees, mean"]) / float(row[f"{angle} degrees, paper"])
            print(f"Algorithm 1, d = {row['d']}, {angle} degrees: {ratio:.2f} of the paper's error")
            assert 1 / 6 < ratio < 2
    check_ranking(mean)


with tempfile.TemporaryDirectory() as folder:
    path = folder + "/bar.csv"
    subprocess.run([sys.argv[1], "--cells", "2", "--length-cells", "12", "--samples", "21", "--degrees", "90", "-o", path],
                   check=True)
    errors = {}
    for row in csv.DictReader(open(path)):
        errors.setdefault((row["basis"], int(row["d"])), []).append(float(row["relative_l2"]))

assert all(len(values) == 21 for values in errors.values()), errors.keys()
mean = {key: sum(values) / len(values) for key, values in errors.items()}
for key, value in sorted(mean.items()):
    print("%-14s d = %2d: %.2e" % (*key, value))
assert all(values[0] < 1e-7 and values[-1] < 1e-7 for values in errors.values()), "a pose itself is not reproduced"
assert 0.35e-4 < mean["Algorithm 1", 3] < 1.4e-4, "the paper has 0.7e-4"
# The paper has 0.14e-4 for both. At d = 17 the kernels of OpenBLAS decide: 1.32e-5 to 1.52e-5 (Sandybridge, SkylakeX).
assert mean["Algorithm 1", 9] < 0.14e-4 and mean["Algorithm 1", 17] < 0.2e-4
check_ranking(mean)
assert mean["adaptive", 9] < 1e-7

kept = Path(__file__).parent / "results" / "table2.csv"
for angle in (90, 180):
    check_kept(list(csv.DictReader(open(kept))), angle)
