#!/usr/bin/env python3
"""Runs the commands of samples/TUTORIAL.md: test_tutorial.py TUTORIAL.md BUILD_DIR

Every ```sh block but the first (which builds what this test is part of) runs as it stands, one shell after the other, in an
empty folder with the tutorial's Wolf.glb, HOME being that folder and ~/pliant what this build installs. The block with
Blender gets a small hero.blend and is left out, and said so, where Blender is missing. Exit code 77: Wolf.glb is not at
hand."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

MAKE_BLEND = """
import bpy, os
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.mesh.primitive_uv_sphere_add(segments=16, ring_count=12)
hero = bpy.context.object
hero.shape_key_add(name='Basis')
for name, axis in (('tall', 2), ('wide', 0)):
    key = hero.shape_key_add(name=name, from_mix=False)
    for point in key.data:
        point.co[axis] *= 1.5
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath('hero.blend'))
"""


def run(command, folder, environment):
    answer = subprocess.run(["bash", "-euc", command], cwd=folder, env=environment, capture_output=True, text=True)
    print(f"$ {command}\n{answer.stdout}{answer.stderr}", flush=True)
    if answer.returncode:
        sys.exit(f"test_tutorial: a command of the tutorial ended with exit code {answer.returncode}")
    return answer.stdout


def main():
    tutorial, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    data = os.environ.get("PLIANT_DATA", tutorial.parents[2] / "shared/data")
    wolf = pathlib.Path(data) / "gltf_skin/Wolf.glb"
    if not wolf.is_file():
        print(f"skipped: no {wolf} (PLIANT_DATA names the folder of test data)")
        return 77
    blocks = re.findall(r"^```sh\n(.*?)^```", tutorial.read_text(), re.M | re.S)
    assert len(blocks) == 7 and "install" in blocks[0], "the tutorial has other blocks than this test knows"
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        environment = dict(os.environ, HOME=str(folder), PATH=f"{folder}/pliant/bin:{os.environ['PATH']}", LC_ALL="C.UTF-8")
        run(f"cmake --install '{build}' --prefix ~/pliant > /dev/null; pliant --version", folder, environment)
        shutil.copy(wolf, folder / "Wolf.glb")
        printed = {}
        for number, block in enumerate(blocks[1:], start=2):
            if "blender" in block:
                if not shutil.which("blender"):
                    print("left out: no blender\n")
                    continue
                (folder / "make.py").write_text(MAKE_BLEND)
                run("blender --background --python make.py", folder, environment)
            printed[number] = run(block, folder, environment)
        assert "3 poses of 3994 vertices" in printed[2] and "ready to bake" in printed[2]
        lines = printed[6].strip().splitlines()[-5:]
        assert all("vertex 0 at" in line for line in lines) and lines[0][6:] != lines[4][6:], "the blend does not move"
        assert (folder / "wolf_blends.glb").read_bytes()[:4] == b"glTF"
        if 3 in printed:
            assert "3 poses of" in printed[3]
    return 0


if __name__ == "__main__":
    sys.exit(main())
