"""Scripts that write into a folder, or beside a file, leave alone what they have not made.

test_foreign_files.py [CREATURE]: CREATURE is the sample of that name. Exit code: 0, or 1 with the file that was changed.
"""
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Each with the files that it would replace.
FOLDERS = {
    "runtime/bindings/web/build.py": ["package.json", "README.md", "LICENSE", "objects"],
    "samples/web/build.py": ["index.html", "style.css"],
    "samples/site/build.py": ["index.html", "CNAME"],
    "tests/paper/keep.py": ["README.md", "notes.txt"],
}

# What a user may have that looks like ours.
LIKE_OURS = {"package.json": '{"name": "pliant"}', "README.md": "# Results of the study\n"}


def fill(folder, names):
    for name in names:
        (folder / name).write_text(LIKE_OURS.get(name, f"of the user: {name}"))
    return {path: path.read_bytes() for path in folder.iterdir()}


def run(*command, cwd=None):
    """Without a network: what begins to work ends soon."""
    offline = {**os.environ, "npm_config_offline": "true", "PIP_INDEX_URL": "http://127.0.0.1:9/"}
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, env=offline, timeout=300, cwd=cwd)


def check_folder(script, names, folder):
    before = fill(folder, names)
    arguments = ["study", "-o", folder] if script == "tests/paper/keep.py" else [folder]
    done = run(sys.executable, "-B", ROOT / script, *arguments)
    assert done.returncode in (1, 2) and "name a new folder" in done.stderr, (script, done)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before, f"{script} changed a folder of the user"


def check_kept_inside(top):
    """Results that are kept again from within their folder: their relative name leads through what is replaced."""
    study, results = top / "study", top / "results"
    study.mkdir()
    (study / "log.txt").write_text("log")
    for output, place in ((results, top), ("../results", results)):
        done = run(sys.executable, "-B", ROOT / "tests/paper/keep.py", study, "-o", output, cwd=place)
        assert done.returncode == 0 and (results / "README.md").exists(), done


def check_neighbours(output, names, *command):
    before = fill(output.parent, names)
    done = run(*command)
    assert done.returncode == 0, done
    for path, content in before.items():
        assert path.exists() and path.read_bytes() == content, f"{path.name} was changed"
    assert output.stat().st_size > 0
    left = [path.name for path in output.parent.iterdir() if path not in before and path.suffix not in (".zip", ".ply")]
    assert not left, left


def main(creature=None):
    with tempfile.TemporaryDirectory() as name:
        top = Path(name)
        for k, (script, names) in enumerate(FOLDERS.items()):
            (top / str(k)).mkdir()
            check_folder(script, names, top / str(k))
        check_kept_inside(top)
        for k in ("zip", "ply"):
            (top / k).mkdir()
        output = top / "zip/add_on.zip"
        check_neighbours(output, ["add_on.zip.part"], sys.executable, "-B", ROOT / "samples/blender/build.py", output)
        if creature:
            output = top / "ply/creature_rest.ply"
            check_neighbours(output, ["creature_rest.ply.tmp"], creature, "-o", output.parent)
    print("files of the user stay")


if __name__ == "__main__":
    main(*sys.argv[1:])
