"""The package through pip: package.py SOURCE BINARY build BUILD_TREE COMPILER | configure | extras | run[-extras] SCRIPT

build      a wheel by `pip wheel`, and a virtual environment with it, numpy, mypy and Dask. The baker's library comes from
           BUILD_TREE, so that only the module is compiled
configure  the way of users, who have no build: the source distribution is made, and everything is configured from it;
           nothing is compiled
extras     an environment on top of that one with the packages that pliant works with where they are installed
run        a test, with the Python of the first environment; run-extras: with that of the second one

Exit code 77, and the reason, where the package index is out of reach or Python lacks what building needs.
"""
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
from pathlib import Path

SKIPPED = 77
EXTRAS = ["trimesh", "meshio", "scipy", "polyscope", "usd-core", "matplotlib"]
BUILD_REQUIREMENTS = ["nanobind >= 2.4", "scikit-build-core >= 0.10"]  # of pyproject.toml


def skip(reason):
    print("skipped:", reason)
    sys.exit(SKIPPED)


def call(*command, **options):
    print("+", *command, flush=True)
    subprocess.run([str(word) for word in command], check=True, **options)


def need_python():
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError:
        skip("this Python makes no virtual environments (Debian: python3-venv)")
    if not Path(sysconfig.get_paths()["include"], "Python.h").exists():
        skip("there is no Python.h (Debian: python3-dev)")


def need_index(pip):
    """One small package tells whether there is an index at all, in seconds."""
    with tempfile.TemporaryDirectory() as folder:
        probe = [str(pip), "download", "--quiet", "--no-deps", "--retries", "1", "--timeout", "20", "--dest", folder,
                 "nanobind"]
        done = subprocess.run(probe, capture_output=True, text=True)
    if done.returncode != 0:
        skip(f"the Python package index is out of reach: {done.stderr.strip().splitlines()[-1] if done.stderr else ''}")


def build(source, binary, tree, compiler):
    need_python()
    shutil.rmtree(binary / "environment", ignore_errors=True)
    shutil.rmtree(binary / "wheel", ignore_errors=True)
    call(sys.executable, "-m", "venv", binary / "environment")
    pip = binary / "environment/bin/pip"
    need_index(pip)
    settings = [f"cmake.define.PLIANT_BUILD_TREE={tree}", f"cmake.define.CMAKE_CXX_COMPILER={compiler}"]
    if shutil.which("ccache"):
        settings.append("cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache")
    call(pip, "wheel", "--quiet", "--no-deps", "--wheel-dir", binary / "wheel",
         *(f"--config-settings={setting}" for setting in settings), source / "baker/python")
    (wheel,) = (binary / "wheel").glob("pliant-*.whl")
    print(wheel.name, wheel.stat().st_size, "bytes")
    call(pip, "install", "--quiet", wheel)
    listed = subprocess.run([str(pip), "list", "--format=freeze"], capture_output=True, text=True, check=True).stdout
    names = {line.split("==")[0] for line in listed.splitlines()} - {"pip", "setuptools"}
    if names != {"pliant", "numpy"}:
        sys.exit(f"the package is to need numpy and nothing else, installed are {sorted(names)}")
    call(pip, "install", "--quiet", "mypy")
    if subprocess.run([str(pip), "install", "--quiet", f"{wheel}[batch]"]).returncode != 0:
        print("Dask cannot be installed here: tests of pliant.batch will be skipped")
    (binary / "environment/is_complete").touch()


def unpacked_sdist(source, python, work):
    """The folder of a source distribution, made as build_wheels.py does and unpacked."""
    sys.path.insert(0, str(source / "baker/python"))
    import build_wheels

    build_wheels.stage(work / "staged")
    call(python, "-c", "from scikit_build_core.build import build_sdist; build_sdist('../sdist')", cwd=work / "staged")
    (made,) = (work / "sdist").glob("pliant-*.tar.gz")
    shutil.unpack_archive(made, work / "unpacked")
    (folder,) = (work / "unpacked").iterdir()
    if f"Version: {folder.name.split('-')[1]}\n" not in (folder / "PKG-INFO").read_text(encoding="utf-8"):
        sys.exit(f"{made.name} has another version in its PKG-INFO")
    return folder


def configure(source, binary):
    pip = python_of(binary).with_name("pip")
    call(pip, "install", "--quiet", *BUILD_REQUIREMENTS)
    folder = binary / "configured"
    shutil.rmtree(folder, ignore_errors=True)
    tree = unpacked_sdist(source, pip.with_name("python"), folder)
    found = subprocess.run([str(pip.with_name("python")), "-m", "nanobind", "--cmake_dir"], capture_output=True, text=True,
                           check=True)
    call("cmake", "-G", "Ninja", "-S", tree / "baker/python", "-B", folder, f"-Dnanobind_DIR={found.stdout.strip()}",
         f"-DPython_EXECUTABLE={pip.with_name('python')}", "-DCMAKE_UNITY_BUILD=OFF")
    planned = subprocess.run(["ninja", "-C", str(folder), "-n", "_core"], capture_output=True, text=True, check=True).stdout
    for needed in ("baker/bake/bake.cpp", "bfgs.c"):
        if Path(needed).name + ".o" not in planned:
            sys.exit(f"{needed} is not part of the module")
    for other in ("cli/main.cpp", "pliant_gl"):
        if other in planned:
            sys.exit(f"{other} would be built for the module")


def extras(binary):
    """Kept from one run to the next, as it is large; links to the first environment stay right. Packages that cannot be had
    are left out: the tests that need them say so."""
    base = python_of(binary)
    folder = binary / "extras"
    if (folder / "is_complete").exists() and (folder / "is_complete").read_text() == repr(EXTRAS):
        return
    shutil.rmtree(folder, ignore_errors=True)
    call(base, "-m", "venv", "--without-pip", folder)
    (site,) = (folder / "lib").glob("python3*/site-packages")
    (site / "base.pth").write_text(str(next((binary / "environment/lib").glob("python3*/site-packages"))) + "\n")
    install = [base.with_name("pip"), "--python", folder / "bin/python", "install", "--quiet", "--no-compile"]
    if subprocess.run([*install, *EXTRAS]).returncode == 0:
        (folder / "is_complete").write_text(repr(EXTRAS))
        return
    for extra in EXTRAS:
        if subprocess.run([*install, extra]).returncode != 0:
            print(f"{extra} cannot be installed here: what needs it will be skipped")


def python_of(binary):
    if not (binary / "environment/is_complete").exists():
        skip("there is no wheel (test python_wheel)")
    return binary / "environment/bin/python"


def run(binary, script, has_extras):
    python = python_of(binary)
    if has_extras:
        python = binary / "extras/bin/python"
    with tempfile.TemporaryDirectory() as folder:  # nothing of the tree is on the path
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        done = subprocess.run([str(python), "-B", script], cwd=folder, env=environment)
    sys.exit(done.returncode)


def main(source, binary, task, *rest):
    source, binary = Path(source).resolve(), Path(binary).resolve()
    if task == "build":
        build(source, binary, *rest)
    elif task == "configure":
        configure(source, binary)
    elif task == "extras":
        extras(binary)
    else:
        run(binary, *rest, has_extras=task == "run-extras")


if __name__ == "__main__":
    main(*sys.argv[1:])
