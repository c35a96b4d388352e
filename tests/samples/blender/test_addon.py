"""test_addon.py CASE TOOL ENVIRONMENT [--bpy PYTHON]: the Blender add-on, installed from its zip.

CASE is a function of inside.py, which Blender runs: package, keys, errors without a window, window with one (under Xvfb).
ENVIRONMENT is a virtual environment with the Python package pliant. With --bpy the Python of an environment with the PyPI
package bpy takes the place of the program blender; there is no case window then.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
BUILD = HERE.parents[2] / "samples/blender/build.py"
SKIPPED = 77


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)


def command(case, python):
    if python:
        return [python, HERE / "inside.py", "--"] if case != "window" else skip("bpy has no window")
    if not shutil.which("blender"):
        skip("blender is not installed (group engines of samples/install_packages.sh)")
    blender = ["blender", "--factory-startup", "--python-exit-code", "9", "--python", HERE / "inside.py"]
    if case != "window":
        return [*blender, "--background", "--"]
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not installed (group player of samples/install_packages.sh)")
    return ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", *blender, "--enable-event-simulate", "--"]


def environment(case, packages, folder):
    """Of Blender: its user's files in a folder of the test, where it finds the package as README.md installs it."""
    result = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "TMPDIR": str(folder / "temporary")}
    for name in ("config", "scripts", "datafiles", "extensions"):
        result[f"BLENDER_USER_{name.upper()}"] = str(folder / name)
    for name in ("temporary", "config", "scripts/addons/modules"):
        (folder / name).mkdir(parents=True)
    result.pop("PYTHONPATH", None)
    if case in ("package", "window"):
        found = list(packages.glob("lib/python3*/site-packages/pliant"))
        if not found:
            skip(f"the Python package is not in {packages} (test python_wheel)")
        (folder / "scripts/addons/modules/pliant").symlink_to(found[0])
    return result


def main(case, tool, packages, *options):
    """Options: --bpy PYTHON."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        words = command(case, options[1] if options else None)
        subprocess.run([sys.executable, BUILD, folder / "pliant_blender.zip"], check=True)
        done = subprocess.run([*words, case, folder / "pliant_blender.zip", tool, folder], timeout=300, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env=environment(case, pathlib.Path(packages), folder))
        print(done.stdout)
        left = [path.name for path in (folder / "temporary").glob("pliant_*")]
        if done.returncode == 0 and left:
            print(f"FAILED: {left} left in the temporary folder")
        # Blender prints what went wrong in a handler or in the drawing of a panel, and goes on.
        has_passed = f"passed: {case}" in done.stdout and "Traceback" not in done.stdout
        return 0 if done.returncode == 0 and has_passed and not left else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
