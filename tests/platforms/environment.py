"""environment.py FOLDER: makes what the tests of this room share. FOLDER is a virtual environment with zig, a C compiler for
all targets, and the oldest CMake that builds the runtime, from the Python package index; FOLDER/package is the npm package.
The environment is made once, the package every time. Exit code 77, and the reason, where pip cannot fetch."""
import pathlib
import shutil
import subprocess
import sys
import venv

PACKAGES = ["ziglang==0.17.0", "cmake==3.16.8"]


ROOT = pathlib.Path(__file__).resolve().parents[2]


def fetch(folder):
    complete = folder / "is_complete"
    if complete.exists() and complete.read_text() == " ".join(PACKAGES):
        return
    venv.create(folder, with_pip=True, clear=True)
    done = subprocess.run([str(folder / "bin/pip"), "install", "--quiet", "--retries", "1", "--timeout", "30", *PACKAGES],
                          capture_output=True, text=True)
    if done.returncode != 0:
        print("skipped: pip cannot fetch", *PACKAGES, done.stderr.strip()[-300:])
        sys.exit(77)
    complete.write_text(" ".join(PACKAGES))


def main(folder):
    fetch(folder)
    shutil.rmtree(folder / "package", ignore_errors=True)
    build = ROOT / "runtime/bindings/web/build.py"
    return subprocess.run([str(folder / "bin/python"), "-B", str(build), str(folder / "package")]).returncode


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
