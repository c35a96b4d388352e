"""test_rivals.py PLIANT_RIVALS: on a bar, each way to blend does what its paper says, and fails where it must."""
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).parent


def measure(folder, bar):
    prefix = Path(folder) / bar
    subprocess.run([sys.argv[1], "-o", prefix, "--bar", bar, "--cells", "3", "--fresh", "0"], check=True)
    with open(f"{prefix}.csv", newline="") as file:
        return {row["way"]: {key: float(row[key]) for key in ("strain", "volume", "limb_length", "from_elastic")}
                for row in csv.DictReader(file)}


with tempfile.TemporaryDirectory() as folder:
    bend, half, whole = (measure(folder, bar) for bar in ("bend120", "twist180", "twist360"))
    for ways in (bend, half, whole):
        assert ways["linear"]["volume"] < -0.08, "linear blends shrink"
        assert abs(ways["elastic average"]["volume"]) < 0.25 * abs(ways["linear"]["volume"])
        assert ways["lengths and angles"]["strain"] < 0.1 * ways["linear"]["strain"]
        assert ways["lengths and angles"]["from_elastic"] < 0.2 * ways["linear"]["from_elastic"]
    for way in ("gradient domain", "connection maps", "as-rigid-as-possible"):
        assert bend[way]["from_elastic"] < 0.2 * bend["linear"]["from_elastic"], way
    # A triangle that turns by more than half a turn: its rotation is taken the short way.
    assert whole["gradient domain"]["from_elastic"] > 0.5 * whole["linear"]["from_elastic"]
    # Frames only know their neighbours.
    assert whole["connection maps"]["from_elastic"] < 0.2 * whole["linear"]["from_elastic"]
    table = Path(folder) / "table"
    subprocess.run([sys.executable, HERE / "rivals" / "table.py", "-o", table, "--pictures", folder,
                    f"bend={folder}/bend120"], check=True)
    assert table.read_text().count("\n| ") >= 7 and (Path(folder) / "bend.png").stat().st_size > 1000
print("test_rivals: ok")
