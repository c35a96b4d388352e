"""environment.py FOLDER: a virtual environment with the compilers that the tests of this room share, from the Python package
index: zig, a C compiler for all targets, and the oldest CMake that builds the runtime. Exit code 77, and the reason, where
they cannot be fetched. Made once: a second run finds it complete."""
import pathlib
import subprocess
import sys
import venv

PACKAGES = ["ziglang==0.17.0", "cmake==3.16.8"]


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
