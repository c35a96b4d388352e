"""Runs the player as a user would: test_player.py CASE PLAYER.

Exit code 77: this machine cannot run the case (the reason is printed).

Assets come from tests/runtime/tiny_asset.py: small, but solved by the real runtime.
"""
import io
import json
import os
import re
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from PIL import Image

from player_support import (PLAYER, ROOT, hot, make_asset, make_truth, picture, read_picture, refused, run, shapes, skip,
                            thirds, use_window, warm, with_checksums, write_path)

import numpy as np  # after player_support, which chooses its threads
import tiny_scene
from asset_draft import Draft


def cool(image):
    """The pixels of the linear character: blue well above red, unlike the pale backdrop and the grey shadow."""
    return (image[..., 2] - image[..., 0] > 28) & (image.mean(axis=2) < 175)


def case_help(folder):
    out, _ = run("--help")
    for word in ("--screenshot", "--sheet", "--sequence", "--path", "--truth", "--heat", "--crowd", "--rebuild",
                 "--weights", "--frames",
                 "--up", "Exit code"):
        assert word in out, f"--help does not explain {word}"
    out, _ = run("--version")
    assert re.fullmatch(r"pliant-player \d+\.\d+\.\d+\n", out), out


def case_usage(folder):
    asset = make_asset(folder)
    out = folder / "x.png"
    refused(code=2, number=5901)
    refused(asset, "--no-such-option", code=2, number=5901)
    refused(asset, "--size", "0x10", code=2, number=5901)
    refused(asset, "--size", "1e9x10", code=2, number=5901)
    refused(asset, "--view", "1", code=2, number=5901)
    refused(asset, "--up", "w", code=2, number=5901)
    refused(asset, "--exit-after", "nan", code=2, number=5901)
    for option in ("--screenshot", "--sheet"):
        refused(asset, option, asset, code=2, number=5901)
    refused(asset, "--frames", "0", code=2, number=5901)
    refused(asset, "--screenshot", out, "--frames", "3", code=2, number=5901)
    for weights in ("1,x,0", "-1,1,1", "nan,1,1", "0,0,0", "1,,1", "1,1,1,"):
        refused(asset, "--screenshot", out, f"--weights={weights}", code=2, number=5902)
    line = refused(asset, "--screenshot", out, "--weights", "1,1", code=2, number=5902)
    assert "2 weights for 3 poses" in line, line
    assert not out.exists()


def case_bad_asset(folder):
    good = make_asset(folder).read_bytes()
    bad = folder / "bad.pliant"
    line = refused(folder / "missing\x1b[2J.pliant", "--frames", "1", code=3, number=5911)
    assert "missing\\x1b[2J.pliant" in line and "\x1b" not in line, line
    refused(folder, "--frames", "1", code=3, number=5911)
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 1  # only the checksums notice
    for content in (b"", b"PLIANT", bytes(4096), good[:-1], good[:100], bytes(flipped)):
        bad.write_bytes(content)
        line = refused(bad, "--frames", "1", code=3, number=5912)
        assert str(bad) in line, line


def glb_with(blob, before):
    """The smallest GLB file with an asset as the first thing in its binary chunk; `before`: bytes of JSON, for its place."""
    text = b'{"asset":{"version":"2.0"}}'.ljust(before)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def case_glb(folder):
    """An asset inside a GLB file is the same asset, wherever it lies."""
    asset = make_asset(folder)
    blob = asset.read_bytes()
    blob += bytes(-len(blob) % 4)
    glb = folder / "tube.glb"
    direct = picture(asset, folder, "--weights", "1,2,3")
    for before in (4096 - 28, 64 - 28 + 4, 32):
        glb.write_bytes(glb_with(blob, before))
        assert np.abs(picture(glb, folder, "--weights", "1,2,3") - direct).max() == 0, before
    whole = glb.read_bytes()
    for content in (whole[:-1], whole[:40], b"glTF", glb_with(bytes(64), 32), glb_with(b"", 32)):
        glb.write_bytes(content)
        line = refused(glb, "--frames", "1", code=3, number=5912)
        assert str(glb) in line, line


def case_screenshot(folder):
    asset = make_asset(folder)
    image = picture(asset, folder)
    assert image.shape == (240, 320, 3), image.shape
    assert image.std() > 5, "the picture is constant"
    assert 0.02 < warm(image).mean() < 0.8, f"the character covers {warm(image).mean():.3f} of the picture"
    assert image[:4].min() > 150, "the backdrop is not pale"
    rows, columns = np.nonzero(warm(image))
    assert rows.min() > 2 and rows.max() < 237, "the character leaves the picture"
    assert columns.min() > 2 and columns.max() < 317, "the character leaves the picture"
    turned = picture(asset, folder, "--view=-60,40")
    assert np.abs(turned - image).mean() > 1, "--view changes nothing"


def case_corner(folder):
    """In a corner both blends are the pose itself: same outline, other colour. Between corners the shape is another one."""
    asset = make_asset(folder)
    elastic = warm(picture(asset, folder, "--weights", "0,1,0"))
    linear = cool(picture(asset, folder, "--weights", "0,1,0", "--linear"))
    other = warm(picture(asset, folder, "--weights", "0,0,1"))

    def outline(mask):
        """Row by row from the first pixel to the last: highlights inside have no colour."""
        return np.maximum.accumulate(mask, axis=1) & np.maximum.accumulate(mask[:, ::-1], axis=1)[:, ::-1]

    def overlap(a, b):
        a, b = outline(a), outline(b)
        return (a & b).sum() / (a | b).sum()

    assert overlap(elastic, linear) > 0.9, f"the corner's outlines overlap by {overlap(elastic, linear):.3f}"
    assert overlap(elastic, other) < 0.9, f"two poses overlap by {overlap(elastic, other):.3f}"


def case_panels(folder):
    asset = make_asset(folder)
    without = picture(asset, folder, "--no-hud", size="960x600")
    panels = picture(asset, folder, "--hud", size="960x600")
    both = picture(asset, folder, "--both", size="960x600")
    ink = [((image.max(axis=2) < 120) & (image[..., 0] < image[..., 2])).sum() for image in (without, panels)]
    assert ink[1] > ink[0] + 300, f"--hud writes no text: {ink} dark pixels without and with"
    half = both.shape[1] // 2
    assert cool(both[:, :half]).any() and warm(both[:, half:]).any(), "--both: linear left, elastic right"
    assert not warm(both[:, :half]).any(), "--both: the elastic character reaches into the left half"


def case_sheet(folder):
    asset = make_asset(folder)
    path = folder / "sheet.png"
    run(asset, "--sheet", path, "--size", "120x100")
    image = np.asarray(Image.open(path).convert("RGB")).astype(float)
    assert image.shape[0] > 200 and image.shape[1] > 400, image.shape
    assert warm(image).mean() > 0.01 and cool(image).mean() > 0.003, "a kind of blend is missing on the sheet"


def case_sequence(folder):
    asset = make_asset(folder)
    path = write_path(folder, [[1, 0, 0], [0, 2, 0], [0, 0, 1]])
    out = folder / "frames"
    out.mkdir()
    pattern = out / "f_%02d.png"
    _, err = run(asset, "--sequence", pattern, "--path", path, "--size", "160x120")
    assert sorted(p.name for p in out.iterdir()) == ["f_00.png", "f_01.png", "f_02.png"], list(out.iterdir())
    second = np.asarray(Image.open(out / "f_01.png").convert("RGB")).astype(float)
    run(asset, "--sequence", out / "t_%d.png", "--path", write_path(folder, [[0, 1, 0], [0, 0, 1], [1, 0, 0]], "turned.csv"),
        "--size", "160x120")
    corner, other = (read_picture(out / f"t_{i}.png") for i in (0, 1))
    assert np.abs(second - corner).mean() < 0.2 < np.abs(second - other).mean(), "frame 1 is not what line 1 says"
    run(asset, "--sequence", pattern, "--count", "4", "--size", "64x64", "--hud")
    assert Image.open(out / "f_03.png").size == (64, 64)
    run(asset, "--sequence", out / "p_%d.png", "--path", path, "--count", "6", "--size", "64x64", "--both")
    assert len(list(out.glob("p_?.png"))) == 6
    run(asset, "--path", path, "--frames", "5")

    bad = write_path(folder, [[1, 0, 0], [1, 0]], "bad.csv")
    line = refused(asset, "--sequence", pattern, "--path", bad, code=3, number=5913)
    assert "bad.csv:3: 2 weights for 3 poses" in line, line
    refused(asset, "--sequence", pattern, "--path", folder / "missing.csv", code=3, number=5913)
    refused(asset, "--sequence", out / "f.png", "--path", path, code=2, number=5941)
    refused(asset, "--sequence", pattern, code=2, number=5942)
    refused(asset, "--sequence", pattern, "--count", "0", code=2, number=5901)
    refused(asset, "--sequence", pattern, "--path", path, "--frames", "3", code=2, number=5901)
    for wrong in (["--path", path, "--screenshot", "x.png"], ["--path", path, "--weights", "1,1,1"], ["--fps", "3"],
                  ["--count", "3"], ["--sequence", pattern, "--count", "3", "--weights", "1,1,1"]):
        refused(asset, *wrong, code=2, number=5942)
    refused(asset, "--sequence", folder / "missing" / "f_%d.png", "--count", "2", "--size", "64x64", code=1, number=5931)


def green(image):
    """The pixels of the unreduced character."""
    return (image[..., 1] - image[..., 0] > 8) & (image[..., 1] - image[..., 2] > 3)


def case_truth(folder):
    asset = make_asset(folder)
    truth = make_truth(asset, folder)
    image = picture(asset, folder, "--truth", *truth, size="900x300")
    linear, elastic, unreduced = thirds(image)
    assert cool(linear).any() and warm(elastic).any(), "linear and elastic side by side"
    assert green(unreduced).mean() > 0.01, "the unreduced average beside them"
    assert not warm(linear).any() and not warm(unreduced).any()
    # All are shown at the nearest weights of the list.
    snapped = picture(asset, folder, "--truth", *truth, "--weights", "0.8,0.2,0", size="900x300")
    corner = picture(asset, folder, "--truth", *truth, "--weights", "1,0,0", size="900x300")
    assert np.abs(snapped - corner).max() == 0, "the weights are not those of the nearest unreduced average"
    assert np.abs(snapped - image).mean() > 0.5
    panels = picture(asset, folder, "--truth", *truth, "--hud", size="960x600")
    assert green(panels[:, :320]).sum() > 40, "the panels do not say where the unreduced average is"

    refused(asset, "--truth", truth[0], folder / "truth.ply", "--screenshot", "x.png", code=2, number=5941)
    refused(asset, "--truth", truth[0], folder / "other_%d.ply", "--screenshot", "x.png", code=3, number=5914)
    refused(asset, "--truth", folder / "no.csv", truth[1], "--screenshot", "x.png", code=3, number=5913)
    refused(asset, "--truth", *truth, "--frames", "3", code=2, number=5942)
    damaged = folder / "truth_3.ply"
    damaged.write_bytes(damaged.read_bytes()[:-1])
    line = refused(asset, "--truth", *truth, "--screenshot", folder / "x.png", code=3, number=5914)
    assert "truth_3.ply" in line, line
    few = folder / "few"
    few.mkdir()
    (few / "truth_0.ply").write_bytes(
        b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        b"element face 0\nproperty list uchar int vertex_indices\nend_header\n" + bytes(12))
    one = write_path(few, [[1, 1, 1]])
    refused(asset, "--truth", one, few / "truth_%d.ply", "--screenshot", "x.png", code=3, number=5915)


def case_heat(folder):
    asset = make_asset(folder)
    truth = make_truth(asset, folder)
    # Between legend and captions. At the poses all three are the same shape: nothing is warm. In between the linear blend
    # is further off.
    corner = shapes(picture(asset, folder, "--truth", *truth, "--heat", "--weights", "1,0,0", size="900x450"))
    assert not hot(corner).any(), f"{hot(corner).sum()} warm pixels at a pose"
    linear, elastic, unreduced = thirds(shapes(picture(asset, folder, "--truth", *truth, "--heat", size="900x450")))
    assert hot(linear).mean() > 0.005, "the linear blend is not warm"
    assert not hot(elastic).any() and not hot(unreduced).any(), "the elastic blend is the truth here and must not be warm"
    difference = shapes(picture(asset, folder, "--heat", size="450x450"))
    assert hot(difference).mean() > 0.005, "without a truth: the distance from the linear blend"
    moved = make_truth(asset, folder, shift=0.2)
    elastic = thirds(shapes(picture(asset, folder, "--truth", *moved, "--heat", size="900x450")))[1]
    assert not hot(elastic).any(), "a difference of place is shown as one of shape"
    large = make_truth(asset, folder, stretch=1.5)
    far = shapes(picture(asset, folder, "--truth", *large, "--heat", "--both", size="900x450"))
    assert (far.max(axis=2) < 110).mean() > 0.05 > (elastic.max(axis=2) < 110).mean(), "what is far off is not dark"
    refused(asset, "--heat", "--frames", "3", code=2, number=5942)


def case_crowd(folder):
    asset = make_asset(folder)
    out, _ = run(asset, "--crowd", "7", "--frames", "20", "--json")
    report = json.loads(out)
    assert report["characters"] == 7 and report["frames"] == 20 and report["poses"] == 3, out
    assert report["solves_not_converged"] == 0 and report["evaluations"]["median"] >= 7, out
    for name in ("solve_us", "reconstruct_us", "normals_us"):
        assert 0 < report[name]["median"] <= report[name]["p95"], out
    text, _ = run(asset, "--crowd", "2", "--frames", "3", "--linear")
    assert "2 characters" in text, text
    one = picture(asset, folder, "--crowd", "1", "--view=0,10", size="300x200")
    many = picture(asset, folder, "--crowd", "9", "--view=0,10", size="300x200")
    assert warm(one).any() and warm(many).any() and np.abs(one - many).mean() > 1
    panels = picture(asset, folder, "--crowd", "3", "--hud", size="480x300")
    assert (panels[170:, :160].std(axis=2) > 20).sum() > 20, "no bars in the graph"
    path = write_path(folder, [[1, 0, 0], [0, 1, 0]])
    run(asset, "--crowd", "3", "--sequence", folder / "c_%d.png", "--path", path, "--size", "64x64")
    assert (folder / "c_1.png").exists()
    refused(asset, "--crowd", "0", code=2, number=5901)
    for wrong in (["--both"], ["--heat"], ["--weights", "1,1,1"], ["--sheet", "x.png"]):
        refused(asset, "--crowd", "3", *wrong, code=2, number=5942)


def saturated(image, channel):
    """The pixels of a pure colour: one channel well above both others, bright or in the shade."""
    others = [image[..., c] for c in range(3) if c != channel]
    return (image[..., channel] > 1.6 * others[0] + 12) & (image[..., channel] > 1.6 * others[1] + 12)


def shared_triangles(blob):
    """The asset with a scene of two parts that name the same triangles, which are all bytes of the scene."""
    start = blob.index(b"glTF")
    size = struct.unpack_from("<I", blob, start + 8)[0]
    parts = [{"attributes": {}, "material": 0, "indices": 0, "extras": {"name": "", "first_vertex": v, "vertex_count": n}}
             for v, n in ((0, 1), (1, struct.unpack_from("<I", blob, 32)[0] - 1))]
    for count in range(size // 2, 0, -1):
        text = json.dumps({"meshes": [{"primitives": parts}], "materials": [{}], "bufferViews": [{"byteLength": 2 * count}],
                           "accessors": [{"bufferView": 0, "componentType": 5123, "count": count}]}).encode()
        text += b" " * (-len(text) % 4)
        if count % 6 == 0 and len(text) + 2 * count + 28 <= size:
            binary = bytes(size - 28 - len(text))
            return blob[:start + 12] + struct.pack("<II", len(text), 0x4E4F534A) + text \
                + struct.pack("<II", len(binary), 0x004E4942) + binary + blob[start + size:]
    raise AssertionError("no room for the scene")


def with_png_size(data, width, height):
    """The bytes with another size in the header of the first PNG file in them."""
    at = data.index(b"IHDR")
    header = b"IHDR" + struct.pack(">II", width, height) + data[at + 12:at + 17]
    return data[:at] + header + struct.pack(">I", zlib.crc32(header)) + data[at + 21:]


def case_materials(folder):
    """Texture and vertex colours are drawn, masked parts are not; --plain omits materials, heat replaces them."""
    asset = make_asset(folder, "--scene")
    painted = picture(asset, folder, "--weights", "1,0,0")
    plain = picture(asset, folder, "--weights", "1,0,0", "--plain")
    bare = picture(make_asset(folder), folder, "--weights", "1,0,0")
    assert np.abs(plain - bare).max() == 0, "--plain is not what an asset without materials looks like"
    for channel, name in enumerate(("red", "green", "blue")):
        assert saturated(painted, channel).sum() > 150, f"{saturated(painted, channel).sum()} {name} pixels of the texture"
        assert channel == 0 or not saturated(plain, channel).any(), f"{name} without materials"
    magenta = (painted[..., 0] > painted[..., 1] + 30) & (painted[..., 2] > painted[..., 1] + 30)
    cyan = (painted[..., 1] > painted[..., 0] + 20) & (painted[..., 2] > painted[..., 0] + 20)
    assert magenta.sum() > 100, f"vertex colours: {magenta.sum()} magenta pixels"
    assert cyan.sum() > 100, f"vertex colours: {cyan.sum()} cyan pixels"
    yellow = (painted[..., 0] > 150) & (painted[..., 1] > 150) & (painted[..., 2] < 90)
    assert not yellow.any(), f"{yellow.sum()} pixels of what the mask leaves out"
    asset = make_asset(folder, "--scene")
    assert saturated(picture(asset, folder, "--crowd", "3"), 2).any(), "a crowd has no materials"
    heat = shapes(picture(asset, folder, "--heat", "--weights", "1,0,0", size="450x450"))
    assert not saturated(heat, 0).any() and not saturated(heat, 1).any(), "colours by distance do not go before materials"

    blob = asset.read_bytes()
    for damaged, what in ((with_png_size(blob, 16384, 16384), "larger"),
                          (shared_triangles(blob), "share their triangles")):
        asset.write_bytes(with_checksums(damaged))
        line = refused(asset, "--screenshot", folder / "x.png", "--size", "64x64", code=3, number=5912)
        assert what in line, line
    for old, new in ((b'"material": 0', b'"material": 7'), (b'"byteOffset": 0,', b'"byteOffset":-4,'),
                     (b'"componentType": 5123', b'"componentType": 5121'),
                     (b'"first_vertex": 0', b'"first_vertex": 1'), (b'"mesh": 0}', b'"mesh": 0)'), (b'"VEC4"', b'"VEC2"'),
                     (b'"source": 0', b'"source": 1'), (b'"index": 0', b'"index": 1'),
                      (b'[{"primitives"', b'[["primitives"')):
        assert blob.count(old), old
        asset.write_bytes(with_checksums(blob.replace(old, new)))
        line = refused(asset, "--screenshot", folder / "x.png", "--size", "64x64", code=3, number=5912)
        assert "chunk GLTF" in line, line
    run(asset, "--screenshot", folder / "x.png", "--size", "64x64", "--plain")


def with_images(blob, image, image_count=1, texture_count=1, shorter=0):
    """The asset with so many images that share their bytes, each `shorter` than the one before, and so many textures that
    show the first one."""
    draft = Draft(blob)
    scene = tiny_scene.Builder.of(bytes(draft.data[b"GLTF"]))
    view = scene.json["bufferViews"][scene.view(image)]
    first = len(scene.json["bufferViews"])
    scene.json["bufferViews"] += [{**view, "byteLength": len(image) - shorter * i} for i in range(image_count)]
    scene.json["images"] = [{"bufferView": first + i} for i in range(image_count)]
    scene.json["textures"] = [{"source": 0}] * texture_count
    draft.data[b"GLTF"] = bytearray(scene.bytes())
    return draft.join()


def image_bomb():
    """A PNG file of one pixel, whose data unpack to 100 MiB."""
    return with_png_size(tiny_scene.png(np.zeros((5120, 5120, 4), "u1")), 1, 1)


def with_scans(side, count):
    """A progressive JPEG file of that many pixels squared, and as many scans that change nothing, of twelve bytes each."""
    def segment(marker, body):
        return struct.pack(">BBH", 255, marker, len(body) + 2) + body

    one_code = bytes([0, 1] + [0] * 14)
    scans = [segment(0xDA, bytes([1, 1, 0, *spectral])) + b"\0\0"
             for spectral in [(0, 0, 0), (1, 63, 1)] + [(1, 63, 16)] * count]
    return (b"\xff\xd8" + segment(0xDB, bytes([0] + [1] * 64))
            + segment(0xC2, struct.pack(">BHHB", 8, side, side, 1) + bytes([1, 17, 0]))
            + segment(0xC4, b"\0" + one_code + b"\0") + segment(0xC4, b"\x10" + one_code + b"\xe0")
            + b"".join(scans) + b"\xff\xd9")


def pictured(asset, content, folder):
    asset.write_bytes(content)
    return picture(asset, folder, "--weights", "1,0,0")


def case_jpeg(folder):
    """A texture in a JPEG file is drawn, but not of one with arithmetic coding, which may be read for ever."""
    asset, file = make_asset(folder, "--scene"), io.BytesIO()
    Image.new("RGB", (16, 16), (255, 0, 0)).save(file, "JPEG", progressive=True)
    blob, jpeg = asset.read_bytes(), file.getvalue()
    red, arithmetic, none = (pictured(asset, with_images(blob, image), folder)
                             for image in (jpeg, jpeg.replace(b"\xff\xc2", b"\xff\xca"), jpeg[:2]))
    assert saturated(red, 0).sum() > 500, "no red texture"
    assert (arithmetic == none).all(), "a texture with arithmetic coding"


def case_image_bombs(folder):
    """An image is unpacked as far as its pixels need, and kept once; all of them are not larger than the file allows."""
    asset = make_asset(folder, "--scene")
    blob, bomb, before = asset.read_bytes(), image_bomb(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    for image, count in ((bomb, 500), (with_scans(4096, 5000), 1)):
        asset.write_bytes(with_images(blob, image, count))
        picture(asset, folder)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
    assert seconds < 20, f"{seconds:.1f} s for an image of 100 MiB that 500 have, and one of 5,000 scans"
    asset.write_bytes(with_images(blob, tiny_scene.png(np.zeros((2048, 2048, 4), "u1")), texture_count=60))
    picture(asset, folder)
    size = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    assert size < 1000, f"{size:.0f} MiB for an image of 16 MiB that 60 textures show"
    asset.write_bytes(with_images(blob, bomb, 10, shorter=1))
    line = refused(asset, "--screenshot", folder / "x.png", "--size", "64x64", code=3, number=5912)
    assert "larger" in line, line


def case_texture_transform(folder):
    """KHR_texture_transform is as if the texture coordinates were others, and repeats beyond the texture's edge."""
    import tiny_asset
    original = tiny_scene.scene_chunk

    def drawn(**scene):
        tiny_scene.scene_chunk = lambda faces, count: original(faces, count, **scene)
        asset = folder / "tube.pliant"
        asset.write_bytes(tiny_asset.make_asset("tube", poses=2, scene=True))
        return picture(asset, folder, "--weights", "1,0")

    def moved(places):
        # Counter-clockwise where v points down: the u axis turns towards -v.
        u, v, c, s = 2.5 * places[:, 0], 0.8 * places[:, 1], np.cos(0.4), np.sin(0.4)
        return np.stack([c * u + s * v + 0.3, c * v - s * u + 0.1], axis=1)

    explicit, plain = drawn(moved=moved), drawn()
    extension = drawn(transform={"offset": [0.3, 0.1], "rotation": 0.4, "scale": [2.5, 0.8]})
    assert (np.abs(extension - explicit).max(axis=2) > 8).mean() < 1e-3, "the transform places the texture elsewhere"
    assert (np.abs(extension - plain).max(axis=2) > 8).mean() > 0.02, "the transform changes nothing"


def case_many_poses(folder):
    """The polygon's panel has labels for many poses, and nothing of them leaves it."""
    for poses in (2, 12, 20):
        asset = make_asset(folder, poses=poses)
        weights = ",".join(["1", "2"] + (poses - 2) * ["0"])
        image = picture(asset, folder, "--hud", "--weights", weights, size="960x600")
        panel = image[372:588, 12:223]  # of a picture of 600 rows
        assert (panel.max(axis=2) < 150).sum() > 60, f"{poses} poses: no labels"
        beyond = image[380:580, 226:240]
        assert beyond.min() > 150, f"{poses} poses: something sticks out of the panel"


def case_drop(folder):
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not installed (packages xvfb xauth)")
    asset = make_asset(folder)
    good, bad = folder / "other one.pliant", folder / "bad.pliant"
    good.write_bytes(asset.read_bytes())
    bad.write_bytes(asset.read_bytes()[:-1])
    script = ('"$0" "$1" --size 480x320 & player=$!; "$2" "$3" "$4" "$5" "$4"; code=$?; '
              'kill -0 $player || code=9; kill $player; exit $code')
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", "bash", "-c", script, PLAYER, asset, sys.executable,
               Path(__file__).with_name("drop_file.py"), bad, good]
    result = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=240)
    if "P5921" in result.stderr:
        skip("no window here: " + result.stderr)
    assert result.returncode == 0, (result.returncode, result.stdout, result.stderr)
    titles = result.stdout.splitlines()
    assert titles == ["tube · Pliant", "other one · Pliant", "other one · Pliant"], titles


def case_key(folder):
    """M takes the materials away in the window; W draws edges, and then edges only."""
    asset = make_asset(folder, "--scene")
    use_window(folder, [asset, "--weights", "1,0,0"], "save:before.png", "key:M", "save:plain.png", "key:W", "save:over.png",
               "key:W", "save:only.png")
    before, plain, over, only = (read_picture(folder / f"{name}.png")[:, 340:]
                                 for name in ("before", "plain", "over", "only"))
    assert saturated(before, 2).sum() > 100, f"{saturated(before, 2).sum()} blue pixels of the texture"
    assert not saturated(plain, 2).any(), f"{saturated(plain, 2).sum()} blue pixels after the key"
    assert (np.abs(over - plain).max(axis=2) > 30).sum() > 100, "W draws no edges"
    assert warm(only).sum() < 0.1 * warm(over).sum(), "the second W leaves the surfaces"


def case_whole_or_nothing(folder):
    asset = make_asset(folder)
    refused(asset, "--screenshot", folder / "missing" / "x.png", "--size", "64x64", code=1, number=5931)
    place = folder / "place.png"
    place.mkdir()
    refused(asset, "--screenshot", place, "--size", "64x64", code=1, number=5931)
    pipe = folder / "pipe.png"
    os.mkfifo(pipe)
    refused(pipe, "--frames", "1", code=3, number=5911)
    refused(asset, "--frames", "1", "--path", pipe, code=3, number=5913)
    refused(asset, "--screenshot", pipe, "--size", "64x64", code=1, number=5931)
    assert pipe.is_fifo(), "the pipe was replaced by a file"
    assert sorted(p.name for p in folder.iterdir()) == ["pipe.png", "place.png", "tube.pliant"], "something was left behind"


def case_benchmark(folder):
    asset = make_asset(folder)
    out, _ = run(asset, "--frames", "50", "--json")
    report = json.loads(out)
    assert report["frames"] == 50 and report["poses"] == 3 and report["dimension"] == 6 and report["blend"] == "elastic", out
    for name in ("solve_us", "reconstruct_us", "normals_us"):
        assert 0 < report[name]["median"] <= report[name]["p95"], out
    assert report["evaluations"]["median"] >= 1, out
    linear, _ = run(asset, "--frames", "50", "--json", "--linear")
    assert json.loads(linear)["evaluations"]["p95"] == 0, linear
    text, _ = run(asset, "--frames", "3")
    assert "median" in text and "reconstruct" in text, text
    for arguments in ([asset, "--frames", "3", "--json"], ["--help"]):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([PLAYER, *arguments], stdout=full, stderr=subprocess.PIPE, text=True, check=False)
        assert done.returncode == 1 and "P5932" in done.stderr, f"{done.returncode}: {done.stderr}"


def case_window(folder):
    if not shutil.which("xvfb-run"):
        skip("xvfb-run is not installed (packages xvfb xauth)")
    asset = make_asset(folder, poses=5)
    command = ["xvfb-run", "-a", "-s", "-screen 0 1280x1024x24", PLAYER, asset, "--size", "480x320", "--exit-after", "1"]
    result = subprocess.run(command, capture_output=True, text=True, timeout=240)
    assert result.returncode == 0, result.stderr


def case_error_numbers(folder):
    """The table in the player's README lists the numbers of error.h and main.cpp, no more and no fewer."""
    player = ROOT / "samples" / "player"
    enumeration = re.search(r"enum class ErrorNumber[^}]*}", (player / "blend" / "error.h").read_text()).group()
    used = set(re.findall(r"= (\d{4})", enumeration))
    used |= set(re.findall(r"error P(\d{4})", (player / "run" / "main.cpp").read_text()))
    listed = set(re.findall(r"^\| P(\d{4}) \|", (player / "README.md").read_text(), re.MULTILINE))
    assert used == listed, f"only in the code: {used - listed}, only in the table: {listed - used}"


with tempfile.TemporaryDirectory(prefix="pliant_player_") as temporary:
    globals()["case_" + sys.argv[1]](Path(temporary))
