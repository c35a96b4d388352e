"""test_forge.py BITS: what the workflow in .github says still holds. Actions have a version each and may only read; every
file of the project that a command names is there; BITS, which is test_bits of this machine, gets the hashes that the
workflow expects on every system."""
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/runtime"))
import compare_bits  # noqa: E402

FILE = re.compile(r"(?<![\w./-])((?:\.ci|\.github|baker|formats|runtime|samples|tests)/[\w./-]+)")


def check_workflow(path):
    text = path.read_text()
    for action in re.findall(r"uses: (\S+)", text):
        assert re.fullmatch(r"[\w-]+/[\w-]+@v\d+", action), f"{path.name}: {action} has no version"
    assert re.findall(r"^permissions:\n((?:  .*\n)+)", text, re.M) == ["  contents: read\n"], f"{path.name}: permissions"
    assert "concurrency:" in text, path.name
    files = FILE.findall(text)
    assert len(files) > 4, files
    for name in files:
        assert (ROOT / name).exists(), f"{path.name}: there is no {name}"


def main(program):
    workflows = sorted((ROOT / ".github/workflows").glob("*.yml"))
    assert workflows, "no workflow"
    for path in workflows:
        check_workflow(path)
    found = subprocess.run([program, compare_bits.GOLDEN], capture_output=True, text=True, check=True)
    wrong = compare_bits.first_difference(compare_bits.blends(), found.stdout)
    assert not wrong, f"tests/golden/blends.txt: {wrong}"
    print(f"{len(workflows)} workflow, the blends of tests/golden")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
