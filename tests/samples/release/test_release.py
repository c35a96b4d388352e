"""samples/release/make_release.py in a small checkout of its own: the sources are the committed files, the same bytes twice
whatever the settings of git, with sums that sha256sum accepts; a tree that is not as committed, versions that disagree, a
heading without a date, a folder that is there, and a part that fails are refused with a message, and leave nothing; so does
SIGTERM. Exit code 77, and the reason, without git."""
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import time
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[3]
SCRIPT = "samples/release/make_release.py"
COPIED = [SCRIPT, "runtime/pliant.h", "runtime/bindings/web/build.py", "LICENSE"]
HEADER = (ROOT / "runtime/pliant.h").read_text()
VERSION = ".".join(re.search(rf"VERSION_{name} (\d+)", HEADER).group(1) for name in ("MAJOR", "MINOR", "PATCH"))
SOURCE_ONLY = [f"--without={part}" for part in ("blender", "npm", "sdist", "wheel")]
# Nothing is fetched: the part npm fails at once.
OFFLINE = dict(os.environ, PIP_INDEX_URL="http://127.0.0.1:9/", PIP_RETRIES="0", PIP_NO_CACHE_DIR="1")


def git(tree, *arguments):
    identity = ["-c", "user.name=test", "-c", "user.email=test@localhost"]
    return subprocess.run(["git", *identity, *arguments], cwd=tree, check=True, capture_output=True, text=True).stdout


def make_tree(tree):
    for path in COPIED:
        (tree / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / path, tree / path)
    (tree / "CHANGELOG.md").write_text(f"# Changes\n\n## {VERSION}, 2026-11-26\n")
    git(tree, "init", "--quiet")
    commit(tree)


def commit(tree):
    git(tree, "add", "--all")
    git(tree, "commit", "--quiet", "--message", "test")


def release(tree, out, *options, environment=OFFLINE):
    command = [sys.executable, "-B", tree / SCRIPT, out, *options]
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def check_good(tree, folder):
    outs = [folder / "first", folder / "second"]
    settings = tree.parent / "settings"  # of a user, which change what git writes
    settings.write_text("[core]\nautocrlf = true\n[tar]\numask = 0077\n")
    for out, configuration in zip(outs, (os.devnull, settings)):
        done = release(tree, out, *SOURCE_ONLY, environment={**OFFLINE, "GIT_CONFIG_GLOBAL": str(configuration)})
        assert done.returncode == 0 and "source: made" in done.stdout and "npm: left out" in done.stdout, done
        assert sorted(path.name for path in out.iterdir()) == ["SHA256SUMS", f"pliant-{VERSION}-source.tar.gz"]
        subprocess.run(["sha256sum", "--check", "--quiet", "--strict", "SHA256SUMS"], cwd=out, check=True)
    first, second = (out / f"pliant-{VERSION}-source.tar.gz" for out in outs)
    assert first.read_bytes() == second.read_bytes(), "two archives of one commit differ"
    with tarfile.open(first) as archive:
        names = sorted(member.name for member in archive if member.isfile())
    assert names == sorted(f"pliant-{VERSION}/{name}" for name in git(tree, "ls-files").split()), names


def check_refused(tree, folder, text, *options):
    before = sorted(folder.iterdir())
    done = release(tree, folder / "refused", *options)
    assert done.returncode == 1 and text in done.stderr, (text, done)
    assert sorted(folder.iterdir()) == before, "something was left"


def check_terminated(tree, folder):
    """While a git of our own takes long for the clone."""
    before = sorted(folder.iterdir())
    slow, started = tree.parent / "slow", tree.parent / "started"
    slow.mkdir()
    (slow / "git").write_text(f'#!/bin/sh\n[ "$1" != clone ] || {{ touch {started}; exec sleep 60; }}\n'
                              f'exec {shutil.which("git")} "$@"\n')
    (slow / "git").chmod(0o755)
    environment = {**OFFLINE, "PATH": f"{slow}{os.pathsep}{OFFLINE['PATH']}"}
    with subprocess.Popen([sys.executable, "-B", tree / SCRIPT, folder / "refused", *SOURCE_ONLY], env=environment) as run:
        limit = time.monotonic() + 30
        while not started.exists() and run.poll() is None and time.monotonic() < limit:
            time.sleep(0.01)
        run.terminate()
    assert run.returncode == 143, run.returncode
    assert sorted(folder.iterdir()) == before, "something was left"


BUILDER = """
import os, signal, sys
sys.path.insert(0, sys.argv[1])
import build_wheels
signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
build_wheels.run("sh", "-c", f"sleep 60 & echo $! > {sys.argv[2]}.part; mv {sys.argv[2]}.part {sys.argv[2]}; wait")
"""


def check_builder_terminated(folder):
    """What build_wheels.py has started ends with it, here a child of its child."""
    written = folder / "pid"
    command = [sys.executable, "-B", "-c", BUILDER, ROOT / "baker/python", written]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as run:
        limit = time.monotonic() + 30
        while not written.exists() and run.poll() is None and time.monotonic() < limit:
            time.sleep(0.01)
        run.terminate()
    assert run.returncode == 143, run.returncode
    command_line = Path("/proc", written.read_text().strip(), "cmdline")
    assert not command_line.exists() or not command_line.read_bytes(), "its child works on"
    written.unlink()


def check_full_disk(folder):
    """An archive that does not fit is not there, under no name."""
    sys.path.insert(0, str(ROOT / "baker/python"))
    import build_wheels

    def copy(source, target):
        Path(target, "half").touch()
        raise OSError(28, "No space left on device")

    before = sorted(folder.iterdir())
    with mock.patch("shutil.copy", copy), mock.patch("shutil.copyfile", copy):
        try:
            build_wheels.place([ROOT / "LICENSE"], folder)
        except OSError:
            assert sorted(folder.iterdir()) == before, "something was left"
            return
    raise AssertionError("no error")


def main():
    if not shutil.which("git"):
        print("skipped: git is not installed")
        return 77
    with tempfile.TemporaryDirectory(prefix="pliant-release-") as name:
        tree, folder = Path(name, "tree"), Path(name, "out")
        folder.mkdir()
        make_tree(tree)
        check_good(tree, folder)
        check_terminated(tree, folder)
        check_builder_terminated(folder)
        check_full_disk(folder)
        if shutil.which("npm"):
            check_refused(tree, folder, "ziglang", "--without=blender")  # pip finds nothing
        (folder / "refused").mkdir()
        check_refused(tree, folder, "is there already", *SOURCE_ONLY)
        (folder / "refused").rmdir()
        (tree / "notes.txt").write_text("not committed\n")
        check_refused(tree, folder, "notes.txt", *SOURCE_ONLY)
        (tree / "notes.txt").unlink()
        (tree / "CHANGELOG.md").write_text(f"# Changes\n\n## {VERSION}, unreleased\n")
        commit(tree)
        check_refused(tree, folder, "unreleased", *SOURCE_ONLY)
        assert release(tree, folder / "candidate", *SOURCE_ONLY, "--candidate").returncode == 0
        (tree / "CHANGELOG.md").write_text("# Changes\n\n## 9.9.9, 2026-11-26\n")
        commit(tree)
        check_refused(tree, folder, "the newest heading of CHANGELOG.md '9.9.9'", *SOURCE_ONLY)
    print("releases are whole, the same twice, or refused")
    return 0


if __name__ == "__main__":
    sys.exit(main())
