"""test_commands.py TOOL ASSET: runs the commands of the site's own pages, in a folder that looks like the project after its
demo, with TOOL and ASSET in the places of the built tool and of the example characters. NOT_RUN lists the others, and why.
Every command must end well, and the file after its -o be there."""
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from recipes import PAGES, ROOT

BUILDS = "it builds, or fetches, for minutes"
WINDOW = "it opens a window, or serves until it is stopped"
NOT_RUN = {
    "bash samples/demo.sh": BUILDS, "bash samples/install_packages.sh": BUILDS, "cmake ": BUILDS, "python3 -m venv": BUILDS,
    "build/venv/bin/pip": BUILDS, "build/venv/bin/python": BUILDS,
    "python3 samples/web/build.py": BUILDS, "python3 -m http.server": WINDOW,
    "PATH=$PWD/build/release/baker:$PATH blender": WINDOW,
    "build/pliant/bin/pliant-player": WINDOW, "build/release/samples/gltf_game/gltf_game": WINDOW,
}
ASSETS = ["build/demo/creature.pliant", "build/assets/strip.pliant", "hero.pliant"]
TOOLS = ["build/release/baker/pliant", "build/pliant/bin/pliant", "bin/pliant"]


def commands(text):
    """Those of shell blocks, which may go over lines, and `pliant ...` in a sentence or table that names a file."""
    for block in re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S):
        command = ""
        for line in block.replace("\\\n", " ").strip().splitlines():
            command += line
            if command.count('"') % 2 == 0:
                yield command
                command = ""
            else:
                command += "\n"
    for span in re.findall(r"`(pliant \w+ [^`]*\w\.\w+[^`]*)`", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
        yield span.replace("\n", " ")


def place(folder, asset, tool):
    for name in ("baker", "formats", "runtime", "samples"):
        (folder / name).symlink_to(ROOT / name)
    for targets, source in ((ASSETS, asset), (TOOLS, tool)):
        for target in targets:
            (folder / target).parent.mkdir(parents=True, exist_ok=True)
            (folder / target).symlink_to(source)


def check_files(command):
    """What a command that is not run names in the project."""
    for word in shlex.split(command):
        if word.startswith(("samples/", "./baker/", "runtime/")):
            assert (ROOT / word.split("[")[0]).exists(), f"{command}: there is no {word}"


def run(command, folder, environment):
    done = subprocess.run(["bash", "-euc", command], cwd=folder, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    words = shlex.split(command)
    if "-o" in words:
        assert (folder / words[words.index("-o") + 1]).is_file(), command


def main(tool, asset):
    used, have_run = set(), set()
    with tempfile.TemporaryDirectory(prefix="pliant-commands-") as name:
        folder = Path(name)
        place(folder, asset, tool)
        environment = {**os.environ, "PATH": f"{folder}/bin:{os.environ['PATH']}", "PYTHONDONTWRITEBYTECODE": "1"}
        for page in sorted(PAGES.rglob("*.md")):
            for command in commands(page.read_text(encoding="utf-8")):
                reasons = [start for start in NOT_RUN if command.startswith(start)]
                used.update(reasons)
                check_files(command)
                if not reasons and command not in have_run:
                    run(command, folder, environment)
                    have_run.add(command)
    unused = set(NOT_RUN) - used
    assert not unused, f"no page has these commands any more: {unused}"
    assert len(have_run) >= 8, have_run
    print(f"{len(have_run)} commands run, {len(used)} kinds not run")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
