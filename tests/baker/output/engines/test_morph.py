"""test_morph.py TOOL SHAPES ASSET...: the GLB of `pliant export` says the same as the C runtime: base + sum w_j target_j,
with the w of pliant_morph_weights, is what pliant_reconstruct makes; the weights are in [0,1]; the fitted normals have the
errors that the tool states; the animation goes through the poses. No engine is needed: the GLB is read with numpy alone."""
import json
import pathlib
import re
import subprocess
import sys

import numpy as np

from support import Glb, check, export, weight_count


def floats_of(path, counts):
    return np.split(np.fromfile(path, "<f4").reshape(-1, sum(counts)).astype(float), np.cumsum(counts)[:-1], axis=1)


def normals_of(positions, triangles):
    corners = positions[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(positions)
    for c in range(3):
        np.add.at(normals, triangles[:, c], area)
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def check_shapes(name, glb, morph, shapes, stated):
    positions, normals = [glb.attribute(kind) for kind in ("POSITION", "NORMAL")]
    targets = [np.stack([glb.attribute(kind, j) for j in range(morph.shape[1])]) for kind in ("POSITION", "NORMAL")]
    triangles = glb.accessor(glb.primitive()["indices"]).astype(int).reshape(-1, 3)[:-1]
    diagonal = np.linalg.norm(shapes.max(axis=(0, 1)) - shapes.min(axis=(0, 1)))
    worst, angles = 0.0, []
    for weights, shape in zip(morph, shapes):
        found = positions + np.tensordot(weights, targets[0], 1)
        worst = max(worst, abs(found - shape).max())
        fitted = normals + np.tensordot(weights, targets[1], 1)
        fitted /= np.linalg.norm(fitted, axis=1, keepdims=True)
        angles.append(np.degrees(np.arccos(np.clip((fitted * normals_of(shape, triangles)).sum(axis=1), -1, 1))))
    check(worst < 1e-5 * diagonal, f"{name}: positions differ by {worst / diagonal:.1e} of the diagonal")
    check(abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-4, f"{name}: base normals are not of unit length")
    # Other weights than those that the tool judged at, so about the same, not the same.
    check(np.mean(angles) < 2 * stated["mean"] + 0.05,
          f"{name}: normals are {np.mean(angles):.3f} degrees off, {stated} stated")
    check(np.max(angles) < 3 * stated["worst"] + 0.5,
          f"{name}: normals are {np.max(angles):.2f} degrees off, {stated} stated")
    check_box(name, glb)
    box = glb.json["meshes"][0]["extras"]["pliant"]["bounds"]
    check((shapes.min(axis=(0, 1)) >= box["min"]).all() and (shapes.max(axis=(0, 1)) <= box["max"]).all(), f"{name}: bounds")
    return worst / diagonal, np.mean(angles), np.max(angles)


def check_box(name, glb):
    """Two vertices and a triangle behind the asset's own: the bounds of positions are a box around all blends."""
    box, n = glb.json["meshes"][0]["extras"]["pliant"]["bounds"], glb.own_count()
    positions = glb.accessor(glb.primitive()["attributes"]["POSITION"])
    check(len(positions) == n + 2 and np.allclose(positions[n:], [box["min"], box["max"]], rtol=1e-6), f"{name}: box")
    corners = glb.accessor(glb.primitive()["indices"]).reshape(-1, 3).astype(int)
    check(corners[:-1].max() < n and corners[-1].tolist() == [n, n + 1, n], f"{name}: the box's triangle")
    for target in glb.primitive()["targets"]:
        check(not glb.accessor(target["POSITION"])[n:].any(), f"{name}: a target moves the box")


def check_animation(name, glb, dimension, corners):
    """corners: the morph weights that the runtime gives for poses."""
    sampler = glb.json["animations"][0]["samplers"][0]
    times = glb.accessor(sampler["input"])[:, 0]
    frames = glb.accessor(sampler["output"]).reshape(-1, dimension)
    check(len(times) == len(frames) == 181 and abs(times[-1] - 6) < 1e-6, f"{name}: {len(times)} frames")
    check(frames.min() >= 0 and frames.max() <= 1, f"{name}: animation leaves [0,1]")
    for corner in corners:
        nearest = abs(frames - corner).max(axis=1).min()
        check(nearest < 1e-2, f"{name}: the animation stays {nearest} away from a pose")


def check_asset(tool, program, path, folder):
    name = pathlib.Path(path).stem
    output, binary = folder / f"{name}.glb", folder / f"{name}.bin"
    said = export(tool, path, output)
    glb = Glb(output)
    extras = glb.json["meshes"][0]["extras"]
    n, d, m = len(glb.attribute("POSITION")), len(extras["targetNames"]), weight_count(extras["pliant"])
    check(extras["targetNames"] == [f"q{j}" for j in range(d)], f"{name}: target names")
    code = subprocess.run([program, path, binary], timeout=60).returncode
    check((code == 3) == bool(re.search("warning P5205", said.stderr)),
          f"{name}: exit code {code}, and the tool says {said.stderr}")
    if code == 3:
        return f"{name}: no ranges in the asset"
    check(code == 0, f"{name}: {program} exits with {code}")
    weights, q, morph, shapes = floats_of(binary, [m, d, d, 3 * n])
    shapes = shapes.reshape(len(shapes), n, 3)
    check(morph.min() >= 0 and morph.max() <= 1, f"{name}: morph weights from {morph.min()} to {morph.max()}")
    low, high = (np.array(extras["pliant"][key]) for key in ("q_min", "q_max"))
    check(abs(low + morph * (high - low) - q).max() < 1e-5 * abs(q).max(), f"{name}: the ranges in the extras are others")
    figures = check_shapes(name, glb, morph, shapes, extras["pliant"]["normal_error_degrees"])
    # Two poses: on its way to the third the tube buckles, as it may, and stays so.
    check_animation(name, glb, d, morph[:2])
    again = folder / "again.glb"
    export(tool, path, again, "--quiet")
    check(again.read_bytes()[4096:] == output.read_bytes()[4096:], f"{name}: a second export has other bytes")
    return "{}: positions {:.1e} of the diagonal, normals mean {:.3f}, worst {:.2f} degrees".format(name, *figures)


def check_path(tool, path, folder):
    pliant = Glb(folder / f"{pathlib.Path(path).stem}.glb").json["meshes"][0]["extras"]["pliant"]
    count, step = weight_count(pliant), -0.5 if "layers" in pliant else 1
    rows = folder / "path.csv"
    rows.write_text("# frames\n" + "\n".join(",".join(str(step) if k == i % count else "0" for k in range(count))
                                              for i in range(5)) + "\n")
    output = folder / "path.glb"
    export(tool, path, output, "--path", rows, "--fps", "10")
    sampler = Glb(output).json["animations"][0]["samplers"][0]
    times = Glb(output).accessor(sampler["input"])[:, 0]
    check(np.allclose(times, [0, 0.1, 0.2, 0.3, 0.4]), f"times {times}")
    rows.write_text(",".join(["1"] * (count + 1)) + "\n")
    said = export(tool, path, output, "--path", rows, code=3).stderr
    check("P1222" in said and f"{count + 1} weights given for {count} {'layers' if step < 0 else 'poses'}" in said, said)


def check_layers(tool, path, folder):
    """What the extras and the other kinds of file say of layers."""
    layers = Glb(folder / f"{pathlib.Path(path).stem}.glb").json["meshes"][0]["extras"]["pliant"]["layers"]
    check([(layer["low"], layer["high"], layer["initial"]) for layer in layers]
          == [(-1, 1, 0), (0, 1.5, 0.25), (-0.5, 2, -0.25)] and all(layer["name"] for layer in layers), f"{layers}")
    said = export(tool, path, folder / "skin.glb", "--skin", "6", "--embed").stdout
    check(" bones" in said and "animation of 181 frames" in said and "embedded" in said, said)


def main():
    tool, program, *assets = sys.argv[1:]
    folder = pathlib.Path("morph")
    folder.mkdir(exist_ok=True)
    for path in assets:
        print(check_asset(tool, program, path, folder))
    check_path(tool, assets[0], folder)
    check_path(tool, assets[-1], folder)
    check_layers(tool, assets[-1], folder)
    print(json.dumps({"assets": len(assets)}))
    return 0


sys.exit(main())
