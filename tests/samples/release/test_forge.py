"""test_forge.py BITS: what the workflow in .github says still holds. Actions have a version each and may only read; every
file of the project that a command names is there; BITS, which is test_bits of this machine, gets the hash that the workflow
expects on every system."""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
CHECK = ROOT / "tests/platforms/systems"
sys.path.insert(0, str(CHECK))
import run  # noqa: E402

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
    with tempfile.TemporaryDirectory() as folder:
        found = subprocess.run([program, run.golden_assets(Path(folder))], capture_output=True, text=True, check=True)
    expected = (CHECK / "bits.txt").read_text()
    assert found.stdout == expected, f"{found.stdout.strip()}, tests/platforms/systems/bits.txt says {expected.strip()}"
    print(f"{len(workflows)} workflow, {expected.strip()}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
