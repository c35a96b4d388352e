"""gltf_game draws what `pliant blend` writes: test_gltf_game.py GLTF_GAME PLIANT. Without a display there is no picture."""
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "baker" / "output" / "engines"))
sys.path.insert(0, str(ROOT / "tests" / "paper"))
import textured  # noqa: E402
from shapes import read_ply  # noqa: E402

GAME, TOOL = sys.argv[1:]


def run(*command, expected=0):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    assert result.returncode == expected, f"{command}: {result.returncode}\n{result.stderr}"
    return result.stderr


def shown(glb, folder, *arguments):
    path = folder / "positions.f32"
    run(GAME, glb, "--headless", path, *arguments)
    return np.fromfile(path, "<f4").reshape(-1, 3)


def blended(asset, folder, weights):
    path = folder / "blend.ply"
    run(TOOL, "blend", asset, f"--weights={weights}", "-o", path)
    return read_ply(path)[0]


def rewrite(glb, to, change):
    """`change` gets the document, and returns JSON in its place."""
    data = glb.read_bytes()
    end = 20 + int.from_bytes(data[12:16], "little")
    text = change(json.loads(data[20:end])).encode()
    text += b" " * (-len(text) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + data[end:]
    to.write_bytes(b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks)


def image_moved(document):
    """The view of the first image to behind its buffer."""
    document["bufferViews"][document["images"][0]["bufferView"]]["byteOffset"] = 1000000000
    return json.dumps(document)


def nested(document, depth):
    document["extras"] = "here"
    return json.dumps(document).replace('"here"', "[" * depth + r'"\"]["' + "]" * depth)


def outside(document):
    document["buffers"].append({"uri": "changed.glb", "byteLength": 4})
    return json.dumps(document)


def shared(document):
    primitives = document["meshes"][0]["primitives"]
    primitives.extend(primitives[:1] * 2)
    return json.dumps(document)


def misplaced(document):
    document["meshes"][0]["primitives"][0]["extras"]["pliant"]["first_vertex"] = -1e30
    return json.dumps(document)


def unresolved(document):
    document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 1000
    return json.dumps(document)


def required(document):
    document["extensionsRequired"] = ["EXT_another"]
    return json.dumps(document)


def check_refusals(glb, folder):
    plain = folder / "plain.glb"
    run(TOOL, "export", folder / "tube.pliant", "-o", plain)
    assert "PLIANT_elastic_blend" in run(GAME, plain, "--headless", folder / "x", expected=1)
    assert "nothing.glb" in run(GAME, folder / "nothing.glb", "--headless", folder / "x", expected=1)
    assert "3 weights for 2 poses" in run(GAME, glb, "--headless", folder / "x", "--weights", "1,1,1", expected=1)
    assert "hint" in run(GAME, glb, "--weights", "1,x", expected=2)
    assert "hint" in run(GAME, expected=2)
    changed = folder / "changed.glb"
    for change, words in ((image_moved, "reaches beyond its buffer"), (outside, "callback"), (shared, "more triangles"),
                          (unresolved, "refers to nothing"), (required, "extension EXT_another"),
                          (misplaced, "out of range"), (lambda document: nested(document, 100000), "nested deeper")):
        rewrite(glb, changed, change)
        assert words in run(GAME, changed, "--headless", folder / "x", expected=1), words
    assert not (folder / "x").exists()
    rewrite(glb, changed, lambda document: nested(document, 60))
    run(GAME, changed, "--headless", folder / "x")
    before = glb.read_bytes()
    for option in ("--headless", "--picture"):
        assert "is the file to show" in run(GAME, glb, option, folder / "." / glb.name, expected=2)
    assert glb.read_bytes() == before, "the character is kept"


def check_picture(glb, folder):
    """The texture's stripes and the lid's own colour are there."""
    path = folder / "picture.ppm"
    result = subprocess.run(["xvfb-run", "-a", GAME, glb, "--picture", path], capture_output=True, text=True)
    if "no OpenGL" in result.stderr or "no display" in result.stderr:
        print("no picture here:", result.stderr)
        return
    assert result.returncode == 0, result.stderr
    head, size, _, pixels = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    picture = np.frombuffer(pixels, np.uint8).reshape(height, width, 3).astype(int)
    character = np.abs(picture - picture[0, 0]).sum(axis=2) > 30
    assert 0.02 < character.mean() < 0.6, character.mean()
    assert len(np.unique(picture[character] // 48, axis=0)) > 6, "one colour only"


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    source, asset, glb = folder / "source.glb", folder / "tube.pliant", folder / "tube.glb"
    textured.write(source)
    # The file's one target as a layer, then as a pose beside the rest shape, which has a weight, too.
    for kind, rows, initial in (("layers", ("1", "0.3", "-0.5"), "0"), ("average", ("1,1", "1,0", "0.3,0.7"), "1,1")):
        run(TOOL, "bake", source, "--blend", kind, "-o", asset, "--quiet")
        run(TOOL, "export", asset, "--embed", "--morph", "--quantize", "1e-4", "-o", glb)
        for weights in rows:
            difference = np.abs(shown(glb, folder, "--weights", weights) - blended(asset, folder, weights)).max()
            assert difference == 0, f"{kind}, weights {weights}: {difference}"
        assert (shown(glb, folder) == shown(glb, folder, "--weights", initial)).all(), f"{kind}: {initial} is the default"
    check_refusals(glb, folder)
    if shutil.which("xvfb-run"):
        check_picture(glb, folder)
print("gltf_game: ok")
