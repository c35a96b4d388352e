"""test_depfile.py PLIANT CHECKOUT: `pliant bake --depfile` names every file that was read, whatever it is called,
as Make and Ninja read it."""
import functools
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import support
from support import QUICK, QUICK_OPTIONS, check, write_gltf, write_json

TOOL = support.Tool(sys.argv[1])


def read_depfile(path):
    """Target and files of one rule, by the rules of Make."""
    text = path.read_text(encoding="utf-8").replace("\\\n", " ")
    words, word, i = [], "", 0
    while i < len(text):
        if text[i] == "\\" and text[i + 1] in " #":
            word, i = word + text[i + 1], i + 2
        elif text[i] == "$":
            word, i = word + "$", i + 2
        elif text[i] in " \n":
            words, word, i = words + ([word] if word else []), "", i + 1
        else:
            word, i = word + text[i], i + 1
    return words[0].removesuffix(":"), words[1:]


def test_plain(folder):
    support.sheet(folder / "a pose#1.obj", 0)
    support.sheet(folder / "b$\\pose.obj", 1)
    # The row in the middle, where the strip is not bent.
    (folder / "fixed.txt").write_text("5\n16\n27\n38\n49\n60\n", encoding="utf-8")
    config = write_json(folder / "my config.json", {"poses": ["a pose#1.obj", "b$\\pose.obj"], "fix": "fixed.txt", **QUICK})
    result = TOOL.run("bake", "--config", config.name, "-o", "out put.pliant", "--depfile", "x.d", cwd=folder)
    check(result.returncode == 0, f"baked {result.stderr}")
    target, files = read_depfile(folder / "x.d")
    check(target == "out put.pliant", f"target {target}")
    check(sorted(files) == sorted(["my config.json", "a pose#1.obj", "b$\\pose.obj", "fixed.txt"]), f"files {files}")
    check(not list(folder.glob("*.tmp*")) and not list(folder.glob(".*")), "no temporary is left")


def test_gltf(folder):
    write_gltf(folder / "a.gltf", folder)
    result = TOOL.run("bake", "a.gltf#rest", "a.gltf#target=target_1", "-o", "x.pliant", "--depfile", "x.d", *QUICK_OPTIONS,
                      cwd=folder)
    check(result.returncode == 0 and "P2328" in result.stderr, f"a .gltf with parts beside it {result.stderr}")
    _, files = read_depfile(folder / "x.d")
    names = sorted(pathlib.Path(file).name for file in files)
    check(names == ["a.gltf", "mesh data.bin", "skin.png"],
          f"its buffer and its image, but no image that is not there: {names}")


def test_programs(folder):
    """Make and Ninja themselves see a change of a pose with a space in its name."""
    support.sheet(folder / "my rest.obj", 0)
    support.sheet(folder / "bent.obj", 1)
    options = " ".join(QUICK_OPTIONS)
    command = f'"{TOOL.path}" bake "my rest.obj" bent.obj -o x.pliant --depfile x.d -q {options}'
    (folder / "Makefile").write_text(f"x.pliant: ; {command}\n-include x.d\n", encoding="utf-8")
    (folder / "build.ninja").write_text(f"rule bake\n command = {command}\n depfile = x.d\n deps = gcc\n"
                                        "build x.pliant: bake\n", encoding="utf-8")
    for program in ("make", "ninja"):
        if not shutil.which(program):
            print(f"skipped: {program} is not installed")
            continue
        (folder / "x.pliant").unlink(missing_ok=True)

        def rebuilt():
            before = (folder / "x.pliant").stat().st_ino if (folder / "x.pliant").exists() else 0
            result = subprocess.run([program], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                    timeout=280)
            check(result.returncode == 0, f"{program} {result.stdout} {result.stderr}" if result.returncode else program)
            return (folder / "x.pliant").stat().st_ino != before

        check(rebuilt(), f"{program} bakes")
        check(not rebuilt(), f"{program} does nothing the second time")
        support.sheet(folder / "my rest.obj", 0)
        check(rebuilt(), f"{program} bakes again after a change")


def test_race(folder):
    """A pose or configuration that is written again while its bake runs: the next build bakes again."""
    for name, bend in (("rest", 0), ("bent", 1.5)):
        support.sheet(folder / f"{name}.obj", bend, n=24)
    support.sheet(folder / "old.obj", 1, n=24)
    os.utime(folder / "old.obj", (1e9, 1e9))
    configure = functools.partial(write_json, folder / "c.json", {"poses": ["rest.obj", "bent.obj"]})
    configure()
    for name, replace in (("bent.obj", lambda: support.sheet(folder / "bent.obj", 1, n=24)),
                          ("bent.obj", lambda: shutil.copy2(folder / "old.obj", folder / "bent.obj")), # with its time
                          ("c.json", configure)):
        process = TOOL.start("bake", "--config", "c.json", "-o", "x.pliant", "--report", "x.json", cwd=folder)
        while "mean" not in (line := process.stderr.readline()) and line:
            pass
        replace()
        errors = process.communicate(timeout=280)[1]
        check(process.returncode == 0 and f"warning P4606: {name} was written again" in errors, f"told {errors}")
        check("4606" in (folder / "x.json").read_text(encoding="utf-8"), "in the report, too")
        times = [(folder / name).stat().st_mtime_ns for name in ("x.pliant", name)]
        check(times[0] < times[1], f"the asset is older than {name} {times}")


def test_race_while_reading(folder):
    """The same while the file is read: 100 MB take long enough."""
    for name, bend in (("rest", 0), ("bent", 1.5), ("new", 1)):
        support.sheet(folder / f"{name}.obj", bend, n=6)
    with open(folder / "bent.obj", "ab") as large:
        large.write((b"#" * 99 + b"\n") * 1_000_000)
    process = TOOL.start("bake", "rest.obj", "bent.obj", "-o", "x.pliant", "-q", *QUICK_OPTIONS, cwd=folder)
    while process.poll() is None and not support.has_open(process, folder / "bent.obj"):
        pass
    os.replace(folder / "new.obj", folder / "bent.obj")
    errors = process.communicate(timeout=280)[1]
    check(process.returncode == 0 and "warning P4606: bent.obj was written again" in errors, f"told {errors}")
    check((folder / "x.pliant").stat().st_mtime_ns < (folder / "bent.obj").stat().st_mtime_ns, "the asset is older")


def test_any_bytes(folder):
    """A name that is not UTF-8 stands in the dependencies as it is; JSON has a replacement for it."""
    support.poses(folder)
    name = os.fsdecode(b"r\xffst.obj")
    (folder / "rest.obj").rename(folder / name)
    result = TOOL.run("bake", name, "bent.obj", "-o", "x.pliant", "--depfile", "x.d", "--stamp", "x.stamp", "-q",
                      *QUICK_OPTIONS, cwd=folder)
    check(result.returncode == 0 and b"r\xffst.obj" in (folder / "x.d").read_bytes(),
          f"a name that is not UTF-8 {result.stderr}")
    check(json.loads((folder / "x.stamp").read_text(encoding="utf-8"))["inputs"][1]["path"] == "bent.obj",
          "and a stamp that is JSON")


def test_never_half(folder):
    support.poses(folder)
    (folder / "x.d").write_text("old", encoding="utf-8")
    missed = TOOL.run("bake", "rest.obj", "bent.obj", "-o", "x.pliant", "--depfile", "x.d", "--tolerance", "1e-8",
                      *QUICK_OPTIONS, cwd=folder)
    check(missed.returncode == 4 and (folder / "x.d").read_text(encoding="utf-8") == "old",
          "a bake that fails leaves the old one")
    same = TOOL.run("bake", "rest.obj", "bent.obj", "-o", "x.pliant", "--depfile", "rest.obj", cwd=folder)
    check(same.returncode == 1 and "error P4004" in same.stderr, f"it may not replace an input {same.stderr}")
    write_gltf(folder / "hero.gltf", folder)
    text = (folder / "hero.gltf").read_text(encoding="utf-8")
    (folder / "hero.gltf").write_text(text.replace("skin.png", "x;touch$%7BIFS%7DPWNED;.png"), encoding="utf-8")
    stranger = TOOL.run("bake", "rest.obj", "hero.gltf#rest", "-o", "x.pliant", "--depfile", "x.d", *QUICK_OPTIONS,
                        cwd=folder)
    check(stranger.returncode == 1 and "error P4604" in stranger.stderr and "contains ';'" in stranger.stderr,
          f"a name that Make would run is refused {stranger.stderr}")
    (folder / "hero.gltf").write_text(text.replace("skin.png", "!=touch$IFS%22PWNED%22"), encoding="utf-8")
    (folder / '!=touch$IFS"PWNED"').write_bytes((folder / "skin.png").read_bytes())
    assigned = TOOL.run("bake", "hero.gltf#rest", "rest.obj", "-o", "x.pliant", "--depfile", "x.d", *QUICK_OPTIONS,
                        cwd=folder)
    check(assigned.returncode == 1 and "error P4604" in assigned.stderr and "contains '='" in assigned.stderr,
          f"and one that Make would assign {assigned.stderr}")
    for image, part in (("hero's.png", "contains '''"), ("'skin.png", "contains '''"), ("a<b.png", "contains '<'"),
                        ("skin%20", "ends with a space")):
        (folder / "hero.gltf").write_text(text.replace("skin.png", image), encoding="utf-8")
        (folder / image.replace("%20", " ")).write_bytes((folder / "skin.png").read_bytes())
        lost = TOOL.run("bake", "hero.gltf#rest", "rest.obj", "-o", "x.pliant", "--depfile", "x.d", *QUICK_OPTIONS,
                        cwd=folder)
        check(lost.returncode == 1 and "error P4604" in lost.stderr and part in lost.stderr,
              f"and one that Ninja would lose: {image} {lost.stderr}")
    folder = folder / "line\nbreak"
    support.poses(folder)
    broken = TOOL.run("bake", folder / "rest.obj", folder / "bent.obj", "-o", "x.pliant", "--depfile", "x.d", *QUICK_OPTIONS,
                      cwd=folder)
    check(broken.returncode == 1 and "error P4604" in broken.stderr and not (folder / "x.pliant").exists(),
          "a line break in a name is refused")


with tempfile.TemporaryDirectory(prefix="pliant-depfile-") as name:
    for number, test in enumerate((test_plain, test_gltf, test_programs, test_race, test_race_while_reading,
                                   test_any_bytes, test_never_half)):
        place = pathlib.Path(name) / str(number)
        place.mkdir()
        test(place)
support.finish()
