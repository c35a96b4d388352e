"""environment.py FOLDER: makes FOLDER, a virtual environment with what builds the site, once. Exit code 77, and the reason,
where pip cannot fetch."""
import pathlib
import subprocess
import sys
import venv

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "samples/site"))
from build import PACKAGES  # noqa: E402


def main(folder):
    complete = folder / "is_complete"
    if complete.exists() and complete.read_text() == " ".join(PACKAGES):
        return 0
    venv.create(folder, with_pip=True, clear=True)
    done = subprocess.run([str(folder / "bin/pip"), "install", "--quiet", "--retries", "1", "--timeout", "30", *PACKAGES],
                          capture_output=True, text=True)
    if done.returncode != 0:
        print("skipped: pip cannot fetch", *PACKAGES, done.stderr.strip()[-300:])
        return 77
    complete.write_text(" ".join(PACKAGES))
    return 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
