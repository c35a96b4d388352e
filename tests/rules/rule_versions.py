"""The version stands in one place, runtime/pliant.h. No other source, build file or configuration repeats it; the change log
names it, and the manifests of packages for other languages, which must, agree with it."""
import re
from pathlib import Path

from tree import CODE_SUFFIXES, Plant, Tree

HEADER = "runtime/pliant.h"
SUFFIXES = CODE_SUFFIXES | {"CMakeLists.txt", "CMakePresets.json", ".toml", ".in", ".json"}
PART = re.compile(r"^#define PLIANT_VERSION_(MAJOR|MINOR|PATCH) (\d+)\b", re.MULTILINE)
CHANGES = "CHANGELOG.md"
MANIFESTS = ("runtime/bindings/csharp/package.json", "runtime/bindings/web/package.json")
EXAMPLE = re.compile(r"say\b|like\b")  # a comment that shows what a version looks like


def version_of(tree):
    parts = dict(PART.findall(tree.text(HEADER)))
    return ".".join(parts[name] for name in ("MAJOR", "MINOR", "PATCH"))


def check(tree):
    version = version_of(tree)
    wanted = re.compile(rf"(?<![\d.]){re.escape(version)}(?![\d.]*\d)")
    faults = []
    for path in tree.files(suffixes=SUFFIXES):
        if "package-lock" in path or path.startswith("tests/golden/") or path in MANIFESTS:
            continue
        for number, line in tree.lines(path):
            if wanted.search(line) and not EXAMPLE.search(line):
                faults.append(f"{path}:{number}: repeats the version, which stands in {HEADER}")
    for path in MANIFESTS:
        if f'"version": "{version}"' not in tree.text(path):
            faults.append(f"{path}:1: does not have the version {version}")
    if f"## {version}" not in tree.text(CHANGES):
        faults.append(f"{CHANGES}:1: does not name the version {version}")
    return faults


VERSION = version_of(Tree(Path(__file__).parents[2]))

PLANTS = [
    Plant("baker/base/common/planted.cpp", f'const char* planted = "pliant {VERSION}";\n', "repeats the version"),
    Plant("baker/python/planted.toml", f'version = "{VERSION}"\n', "repeats the version"),
    Plant("CMakeLists.txt", f"project(planted VERSION {VERSION})\n", "repeats the version"),
]
