"""Crowds rebuilt by pliant::gl, and blended parts from back to front.

Usage: test_player_crowd.py CASE PLAYER (player_support.py).
"""
import json
import os
import struct
import sys
import tempfile
from pathlib import Path

from PIL import Image

from player_support import picture, read_picture, refused, run, skip, use_window, with_checksums, write_path

import numpy as np  # after player_support, which chooses its threads
import tiny_asset
import tiny_mesh
import tiny_scene

# Mesa can be told to offer less than it has: no compute shaders, or compute shaders without their language.
FEEDBACK = {"MESA_GL_VERSION_OVERRIDE": "3.3"}
REFUSING = {"MESA_GL_VERSION_OVERRIDE": "4.5", "MESA_GLSL_VERSION_OVERRIDE": "330"}


class Variables:
    """Of the environment, set while a block runs."""

    def __init__(self, values):
        self.values = values

    def __enter__(self):
        os.environ.update(self.values)

    def __exit__(self, *_):
        for name in self.values:
            del os.environ[name]


# ---------------------------------------------------------------------------------------------------------- assets --

def seamed_tube(columns, rows):
    """A tube that is split along its length, as at a texture seam: first and last vertex of a ring are at one place."""
    rings = tiny_mesh.tube(columns, rows)[0].reshape(columns, rows, 3)
    return np.concatenate([rings, rings[:, :1]], axis=1).reshape(-1, 3), tiny_mesh.grid_faces(columns, rows + 1, False)


def make_seamed(folder, columns=9, rows=8, **more):
    """The tube, painted, both sides of its seam sharing their normals."""
    tiny_mesh.seamed_tube = seamed_tube
    blob = bytearray(tiny_asset.make_asset("seamed_tube", (columns, rows), 3, 6, smoothing=True, scene=True, **more))
    groups = np.arange(columns * (rows + 1), dtype="<u4").reshape(columns, rows + 1)
    groups[:, -1] = groups[:, 0]
    for i in range(struct.unpack_from("<I", blob, 24)[0]):
        tag, _, offset, size = struct.unpack_from("<4sIQQ", blob, 64 + 32 * i)
        if tag == b"SMTH":
            blob[offset:offset + size] = groups.tobytes()
    path = folder / "tube.pliant"
    path.write_bytes(with_checksums(blob))
    return path


def panes(apart_along, apart):
    """Two upright panes of glass side by side (0) or one behind the other (2), so far apart."""
    points, faces = tiny_mesh.strip(5, 4)
    points[:, 1] *= 2  # as high as wide
    points[:, 0] *= 0.5
    other = points.copy()
    other[:, apart_along] += apart
    return np.vstack([points, other]), np.vstack([faces, faces + len(points)])


def panes_scene(faces, vertex_count):
    """The first pane red, the second blue, both let half of what is behind them through."""
    builder, half, primitives = tiny_scene.Builder(), vertex_count // 2, []
    for part in range(2):
        mine = faces[(faces // half == part).all(axis=1)] - part * half
        primitives.append({"attributes": {}, "indices": builder.indices(mine), "material": part,
                           "extras": {"name": "pane", "first_vertex": part * half, "vertex_count": half}})
    builder.json.update({
        "materials": [{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": colour}}
                      for colour in ((1.0, 0.0, 0.0, 0.6), (0.0, 0.0, 1.0, 0.6))],
        "meshes": [{"primitives": primitives}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})
    return builder.bytes()


def make_panes(folder, apart_along, apart):
    tiny_mesh.panes, original = panes, tiny_scene.scene_chunk
    tiny_scene.scene_chunk = panes_scene
    try:
        blob = tiny_asset.make_asset("panes", (apart_along, apart), 2, 4, scene=True)
    finally:
        tiny_scene.scene_chunk = original
    path = folder / "panes.pliant"
    path.write_bytes(blob)
    return path


# ----------------------------------------------------------------------------------------------------------- cases --

def apart(a, b):
    """The share of pixels that differ by more than rounding may do: 4 of 255 levels."""
    return (np.abs(a - b).max(axis=2) > 4).mean()


def case_rebuild(folder):
    """The graphics card's crowd is the processor's: shapes, seams, materials, shadows, and the floor under their feet."""
    for more, arguments in (({}, ()), ({"compact": 1e-5}, ("--up", "z", "--linear")), ({}, ("--plain",))):
        asset = make_seamed(folder, **more)
        command = (asset, folder, "--crowd", "7", *arguments, "--rebuild")
        cpu, gpu = picture(*command, "cpu"), picture(*command, "gpu")
        with Variables(FEEDBACK):
            feedback = picture(*command, "gpu")
        assert cpu.std() > 5, "nothing is drawn"
        assert apart(cpu, gpu) < 1e-4, f"{apart(cpu, gpu):.5f} of the pixels differ"
        assert apart(cpu, feedback) < 1e-4, f"{apart(cpu, feedback):.5f} of the pixels differ with transform feedback"
    assert apart(cpu, picture(*command, "gpu", "--linear")) > 5e-3, "the comparison sees no difference where there is one"
    picture(asset, folder, "--crowd", "3", "--rebuild", "gpu", "--hud")
    out, _ = run(asset, "--crowd", "3", "--frames", "4", "--json", "--rebuild", "gpu")
    report = json.loads(out)
    assert report["rebuilt_by"].startswith("OpenGL") and report["driver"], out
    for name in ("solve_us", "placing_us", "update_us"):
        assert 0 < report[name]["median"] <= report[name]["p95"], out
    text, _ = run(asset, "--crowd", "2", "--frames", "3", "--rebuild", "gpu")
    assert "pliant::gl" in text and "update" in text and "normals" not in text, text
    refused(asset, "--rebuild", "gpu", code=2, number=5942)
    refused(asset, "--crowd", "3", "--rebuild", "abacus", code=2, number=5901)


def need_mesa(asset):
    out, _ = run(asset, "--crowd", "1", "--frames", "1", "--json", "--rebuild", "gpu")
    if "llvmpipe" not in json.loads(out)["driver"]:
        skip("only Mesa's llvmpipe is known to refuse on demand")


def case_rebuild_refused(folder):
    """Asked for, what the driver cannot do is an error; its words are in the line."""
    asset = make_seamed(folder)
    need_mesa(asset)
    with Variables(REFUSING):
        line = refused(asset, "--crowd", "3", "--rebuild", "gpu", "--screenshot", folder / "x.png", code=1, number=5923)
        assert "the driver refuses a shader (" in line, line
        assert not (folder / "x.png").exists()
        picture(asset, folder, "--crowd", "3", "--rebuild", "cpu")


def press_g(asset, folder, variables):
    with Variables(variables):
        err = use_window(folder, [asset, "--crowd", "3", "--rebuild", "cpu"], "key:G", "save:after.png", size="800x620")
    return err, read_picture(folder / "after.png")


def case_rebuild_key(folder):
    """G hands the shapes over; where the driver refuses, a line says so, and the processor goes on."""
    asset = make_seamed(folder)

    def width_of_name(image):
        """Of who rebuilds, in the third row of the panel: "OpenGL, compute" is longer than "processor"."""
        ink = (image[140:162, 170:322].max(axis=2) < 110).any(axis=0).nonzero()[0]
        assert len(ink), "the panel names nobody"
        return ink[-1] - ink[0]

    err, after = press_g(asset, folder, {})
    assert "P5923" not in err, err
    need_mesa(asset)
    err, refused_after = press_g(asset, folder, REFUSING)
    assert err.count("pliant-player: warning P5923: ") == 1 and "the CPU is used instead" in err, err
    widths = width_of_name(after), width_of_name(refused_after)
    assert widths[0] > 1.3 * widths[1], f"the names of who rebuilds are {widths} pixels wide"


def colours_at(image, box):
    """Means of red and blue in a box, in shares of the picture: left, top, right, bottom."""
    height, width = image.shape[:2]
    left, top, right, bottom = (int(share * side) for share, side in zip(box, (width, height, width, height)))
    part = image[top:bottom, left:right]
    return part[..., 0].mean(), part[..., 2].mean()


def case_layers(folder):
    """Of two panes one behind the other the nearer one colours what is seen through both, from both sides."""
    asset = make_panes(folder, 2, 1.0)
    for who in (("--weights", "1,0"), ("--crowd", "1", "--rebuild", "gpu")):
        for view, nearer in (("0,5", "blue"), ("180,5", "red")):
            red, blue = colours_at(picture(asset, folder, *who, f"--view={view}"), (0.47, 0.45, 0.53, 0.55))
            assert (blue > red + 20) if nearer == "blue" else (red > blue + 20), (
                f"{who}, {view}: red {red:.0f}, blue {blue:.0f}")


def case_layers_crowd(folder):
    """Where the red half of one character overlaps the blue half of another, the nearer one is drawn over the other."""
    asset = make_panes(folder, 0, 1.5)
    path = write_path(folder, [[1, 0]])
    for rebuild in ("cpu", "gpu"):
        for view, nearer in (("0,5", "red"), ("180,5", "blue")):
            run(asset, "--crowd", "4", "--rebuild", rebuild, f"--view={view}", "--sequence", folder / "c_%d.png",
                "--path", path, "--size", "320x240")
            image = np.asarray(Image.open(folder / "c_0.png").convert("RGB")).astype(float)
            red, blue = colours_at(image, (0.47, 0.43, 0.53, 0.50))
            assert (blue > red + 20) if nearer == "blue" else (red > blue + 20), (
                f"{rebuild}, {view}: red {red:.0f}, blue {blue:.0f}")


with tempfile.TemporaryDirectory(prefix="pliant_player_") as temporary:
    globals()["case_" + sys.argv[1]](Path(temporary))
