#!/usr/bin/env python3
"""What a release publishes: make_release.py OUT [--without PART]... [--candidate]

Makes the folder OUT with
    part `source`    pliant-VERSION-source.tar.gz    the same bytes for the same commit
    part `sdist`     pliant-VERSION.tar.gz           what pip builds; part `wheel`: the wheel, which takes minutes
    part `npm`       pliant-VERSION-npm.tgz          the package for browsers and node
    part `blender`   pliant-VERSION-blender.zip      the add-on
    SHA256SUMS       for sha256sum --check
Tools of the parts come from PyPI. Everything is made in a clone of the last commit, so the working tree must hold nothing
else. OUT appears whole or not at all. The version of runtime/pliant.h must be the newest heading of CHANGELOG.md, with a
date; --candidate accepts one that says "unreleased".
Exit code: 0, 1 if something failed, 2 for a wrong argument, 143 after SIGTERM, which leaves nothing behind.
"""
import argparse
import gzip
import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class Failure(Exception):
    """What failed, with a remedy."""


def run(*command, cwd=ROOT):
    child = subprocess.Popen([str(word) for word in command], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        said, errors = child.communicate()
    except BaseException:
        child.terminate()  # not killed, so that it removes what it has made
        child.wait()
        raise
    if child.returncode != 0:
        text = (said + errors).decode(errors="replace")[-3000:]
        raise Failure(f"{' '.join(map(str, command))}: exit code {child.returncode}\n{text}")
    return said


def version_of(tree):
    text = (tree / "runtime/pliant.h").read_text(encoding="utf-8")
    parts = dict(re.findall(r"^#define PLIANT_VERSION_(MAJOR|MINOR|PATCH) (\d+)\b", text, re.M))
    return ".".join(parts[name] for name in ("MAJOR", "MINOR", "PATCH"))


def check_tree(candidate):
    """The version of what may be released."""
    changed = run("git", "status", "--porcelain").decode().splitlines()
    if changed:
        raise Failure(f"{len(changed)} files are not as committed, such as {changed[0][3:]}\nhint: commit or remove them")
    version = version_of(ROOT)
    heading = re.search(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    number, _, state = (heading.group(1) if heading else "").partition(", ")
    if number != version:
        raise Failure(f"runtime/pliant.h has the version {version}, the newest heading of CHANGELOG.md '{number}'\n"
                      "hint: one of them was forgotten")
    if not re.fullmatch(r"\d{4}-\d\d-\d\d", state) and not candidate:
        raise Failure(f"CHANGELOG.md says '{number}, {state}'\nhint: write the date of the release, or take --candidate")
    return version


def make_source(clone, out, version):
    name = f"pliant-{version}"
    tar = run("git", "-c", "tar.umask=0002", "archive", "--format=tar", f"--prefix={name}/", "HEAD", cwd=clone)
    (out / f"{name}-source.tar.gz").write_bytes(gzip.compress(tar, 9, mtime=0))


def make_sdist(clone, out, _version):
    run(sys.executable, "-B", "baker/python/build_wheels.py", out, "--sdist", cwd=clone)


def make_wheel(clone, out, _version):
    """It is made from a source distribution, which comes along."""
    made = clone.parent / "wheel"
    run(sys.executable, "-B", "baker/python/build_wheels.py", made, cwd=clone)
    for path in made.glob("*.whl"):
        shutil.copy(path, out)


def make_blender(clone, out, version):
    run(sys.executable, "-B", "samples/blender/build.py", out / f"pliant-{version}-blender.zip", cwd=clone)


def make_npm(clone, out, version):
    package = clone.parent / "npm"
    run(sys.executable, "-B", clone / "runtime/bindings/web/build.py", package)
    run("npm", "pack", "--offline", "--silent", "--pack-destination", clone.parent, cwd=package)
    shutil.copy(clone.parent / f"pliant-{version}.tgz", out / f"pliant-{version}-npm.tgz")


# In the order that they are made in: those that fail early come first.
PARTS = {"source": make_source, "blender": make_blender, "npm": make_npm, "sdist": make_sdist, "wheel": make_wheel}


def write_sums(out):
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in sorted(out.iterdir())]
    (out / "SHA256SUMS").write_text("".join(lines))


def make_all(out, without, version):
    """In a folder beside OUT, which gets its name at the end."""
    out.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".release-", dir=out.parent) as name:
        work = Path(name)
        staging, clone = work / "out", work / "clone"
        staging.mkdir()
        (work / "tmp").mkdir()
        os.environ["TMPDIR"] = str(work / "tmp")  # of the tools
        run("git", "clone", "--quiet", "--no-hardlinks", "--config", "core.autocrlf=false", ROOT, clone)
        for part, make in PARTS.items():
            if part not in without:
                make(clone, staging, version)
            print(f"{part}: {'left out' if part in without else 'made'}", flush=True)
        write_sums(staging)
        os.rename(staging, out)


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--without", action="append", default=[], choices=PARTS, metavar="PART")
    parser.add_argument("--candidate", action="store_true")
    options = parser.parse_args(arguments)
    out = options.out.resolve()
    if out.exists():
        raise Failure(f"{out} is there already\nhint: name a new folder, or remove it")
    for tool in ["git"] + ["npm"] * ("npm" not in options.without):
        if not shutil.which(tool):
            raise Failure(f"{tool} is not installed\nhint: install it" + ", or take --without npm" * (tool == "npm"))
    make_all(out, options.without, check_tree(options.candidate))
    for path in sorted(out.iterdir()):
        print(f"{path.stat().st_size:>12,}  {path.name}")
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # an exception: folders are removed
    try:
        sys.exit(main(sys.argv[1:]))
    except Failure as failure:
        print(f"make_release.py: error: {failure}", file=sys.stderr)
        sys.exit(1)
