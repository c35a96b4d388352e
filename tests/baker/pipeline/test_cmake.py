"""test_cmake.py CHECKOUT BUILD CMAKE GENERATOR: the sample project samples/cmake_project bakes with an installed package:
all at first, nothing the second time, and after a touch only what has to be."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import support
from support import check

SOURCE, BUILD, CMAKE, GENERATOR = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3], sys.argv[4]
PROGRAM = {"Ninja": "ninja", "Unix Makefiles": "make"}[GENERATOR]


def run(*command):
    result = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                            timeout=280)
    if result.returncode != 0:
        print(result.stdout, result.stderr)
    check(result.returncode == 0, " ".join(map(str, command[:4])))
    return result.stdout + result.stderr


def install(prefix):
    """Only the parts that are built for this test: the runtime library and the tool."""
    for part in ("runtime", "baker"):
        run(CMAKE, "--install", BUILD / part, "--prefix", prefix)


def later(path):
    """The file as if written now, and later than everything there is, whatever the file system's clock resolves."""
    time.sleep(0.02)
    now = time.time() + 0.02
    os.utime(path, (now, now))
    time.sleep(0.05)


def check_choice(source, build, tool):
    """Poses of a GLB file, one by the name of a target that must arrive as it is written."""
    model = source / "strip.glb"
    run(tool, "export", build / "strip.pliant", "-o", model)
    exported, names = model.read_bytes(), b'"q0","q1","q2"'
    check(exported.count(names) == 1, "three targets")
    model.write_bytes(exported.replace(names, b'"..//","q","r"'))
    project = source / "CMakeLists.txt"
    project.write_text(project.read_text(encoding="utf-8") + 'pliant_bake(OUTPUT chosen.pliant POSES "strip.glb" '
                       '"poses/../strip.glb#target=..//" OPTIONS ${quick})\n', encoding="utf-8")
    log = run(CMAKE, "--build", build)
    check("Baking chosen.pliant" in log and (build / "chosen.pliant").exists(), "a pose with a choice")
    check("Baking" not in run(CMAKE, "--build", build), "and then nothing, with a choice")


def main():
    if not shutil.which(PROGRAM):
        print(f"skipped: {PROGRAM} is not installed")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="pliant cmake ") as name:
        # A space in all paths, as it is where people keep projects.
        folder = pathlib.Path(name)
        prefix, source, build = folder / "prefix", folder / "source", folder / "build"
        shutil.copytree(SOURCE / "samples/cmake_project", source)
        install(prefix)
        run(CMAKE, "-S", source, "-B", build, "-G", GENERATOR, f"-DCMAKE_PREFIX_PATH={prefix}")
        strip, twisted = build / "strip.pliant", build / "twisted.pliant"

        def baked(text):
            """Builds; which of the two assets were written, checked against the lines that the build prints."""
            before = {path: path.stat().st_ino if path.exists() else 0 for path in (strip, twisted)}
            log = run(CMAKE, "--build", build)
            written = {path.name for path in before if path.stat().st_ino != before[path]} # a new file takes the name
            told = {path.name for path in before if f"Baking {path.name}" in log}
            check(written == told, f"{text}: written {sorted(written)}, told {sorted(told)}")
            return written

        both = {"strip.pliant", "twisted.pliant"}
        check(baked("first build") == both, "the first build bakes both")
        check(baked("second build") == set(), "the second does nothing")
        later(source / "poses/strip_bent.obj")
        check(baked("a pose of CMakeLists.txt") == {"strip.pliant"}, "a pose is touched: only its asset is baked")
        check(baked("again") == set(), "and then nothing")
        later(source / "poses/strip_twisted.obj")
        check(baked("a pose of the configuration") == {"twisted.pliant"}, "a pose that only twisted.json names: only that")
        later(source / "poses/strip_rest.obj")
        check(baked("a pose of both") == both, "a pose of both: both")
        later(source / "twisted.json")
        check(baked("the configuration") == {"twisted.pliant"}, "the configuration: only its asset")
        later(prefix / "bin/pliant")
        check(baked("the tool") == both, "another tool: both")
        check(baked("at last") == set(), "and then nothing")
        check_choice(source, build, prefix / "bin/pliant")
        (source / "poses/strip_bent.obj").write_text("v 0 0 0\n", encoding="utf-8")
        broken = subprocess.run([CMAKE, "--build", str(build)], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                timeout=280)
        check(broken.returncode != 0 and "error P" in broken.stdout + broken.stderr,
              "a broken pose breaks the build, and says why")
    support.finish()


main()
