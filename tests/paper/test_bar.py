"""pliant_bar on a coarse bar: the paper's ranking of subspaces, and what the adaptive one promises.
Usage: test_bar.py PLIANT_BAR"""
import csv
import subprocess
import sys
import tempfile

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
for d in (3, 9, 17):  # the paper: 8, 23 and 10 times
    assert 8 * mean["Algorithm 1", d] < mean["Barbic et al.", d]
assert mean["Algorithm 1", 9] < 0.1 * mean["Krylov of differences", 9]
assert mean["Algorithm 1", 9] < mean["Algorithm 1", 3]
assert mean["adaptive", 3] < mean["Algorithm 1", 3]
assert mean["adaptive", 5] < 0.1 * mean["Algorithm 1", 9]
assert mean["adaptive", 9] < 1e-7
