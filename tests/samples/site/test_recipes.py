"""test_recipes.py unity|unreal|bevy STAND_INS TOOL ASSET LAYERS: the code of a page about an engine does what the page says.
Unity's script and Unreal's C++ are compiled against stand-ins for the engine's classes and make the blend of `pliant blend`;
Bevy's function makes the table's morph weights. Exit code 77, and the reason, without the compiler."""
import os
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

from recipes import ROOT, blended, block, compare, extras, run, skip, table_weights

FLAGS = ["-O2", "-ffp-contract=off", "-fno-math-errno", "-fno-trapping-math"]
WEIGHTS = [0.2, 0.3, 0.5]


def unity(stand_ins, tool, asset, _layers, folder):
    if not shutil.which("mcs") or not shutil.which("mono"):
        skip("Mono is not installed (bash samples/install_packages.sh engines)")
    run(sys.executable, "-B", ROOT / "runtime/make_single.py", folder)
    run("cc", "-std=c99", "-shared", "-fPIC", *FLAGS, folder / "pliant.c", "-o", folder / "libpliant.so", "-lm")
    shutil.copy(asset, folder / "creature.pliant")
    (folder / "Recipe.cs").write_text(block("engines/unity.md", "csharp", "class PliantCharacter"))
    run("mcs", "-langversion:7.2", f"-out:{folder / 'Recipe.exe'}", folder / "Recipe.cs", stand_ins,
        ROOT / "runtime/bindings/csharp/Runtime/Pliant.cs")
    environment = {**os.environ, "LD_LIBRARY_PATH": str(folder), "LC_ALL": "C.UTF-8"}
    rows = run("mono", folder / "Recipe.exe", folder, *WEIGHTS, env=environment).splitlines()
    vertices = np.array([row.split()[1:] for row in rows if row.startswith("v ")], float)
    low, high = (np.array(row.split()[1:], float) for row in rows if row.startswith("bounds "))
    expected = blended(tool, asset, WEIGHTS, folder)
    compare("Unity", vertices * [-1, 1, 1], expected, 1e-6)
    size = np.ptp(vertices)
    assert (vertices.min(axis=0) >= low - 1e-5 * size).all() and (vertices.max(axis=0) <= high + 1e-5 * size).all()


def triangles(ply):
    head, body = ply.read_bytes().split(b"end_header\n", 1)
    count = int(head.split(b"element face ")[1].split()[0])
    return np.frombuffer(body, [("count", "u1"), ("corners", "<i4", 3)], count, len(body) - 13 * count)["corners"]


def normals_of(positions, corners):
    """Sums of the normals of the triangles at a vertex, weighted by area."""
    a, b, c = positions.astype(float)[corners.T]
    sums = np.zeros(positions.shape)
    for corner in corners.T:
        np.add.at(sums, corner, np.cross(b - a, c - a))
    return sums / np.linalg.norm(sums, axis=1, keepdims=True)


def unreal(stand_ins, tool, asset, _layers, folder):
    run(sys.executable, "-B", ROOT / "runtime/make_single.py", folder)
    run("cc", "-std=c99", *FLAGS, "-c", folder / "pliant.c", "-o", folder / "pliant.o")
    (folder / "Recipe.h").write_text(block("engines/unreal.md", "cpp", "FPliantCharacter"))
    run("c++", "-std=c++17", "-Wall", "-Wextra", "-Werror", f"-I{folder}", stand_ins, folder / "pliant.o",
        "-o", folder / "recipe", "-lm")
    rows = run(folder / "recipe", asset, *WEIGHTS).splitlines()
    made = np.array([row.split() for row in rows], float)
    expected = blended(tool, asset, WEIGHTS, folder)
    compare("Unreal", made[:, [0, 2, 1]] / 100, expected, 1e-6)
    compare("Unreal, normals", made[:, [3, 5, 4]], normals_of(expected, triangles(folder / "blend.ply")), 1e-4)


def bevy(_stand_ins, tool, asset, layers, folder):
    if not shutil.which("rustc"):
        skip("rustc is not installed")
    for path in asset, layers:
        run(tool, "export", path, "-o", folder / "hero.glb")
        pliant = extras(folder / "hero.glb")
        table, is_layers = pliant["pose_table"], pliant.get("blend") == "layers"
        d = len(pliant["poses"][0]["weights"])
        arrays = ", ".join("&[{}]".format(", ".join(repr(float(x)) for x in numbers))
                           for numbers in (table["centres"], table["coefficients"]))
        main = f"fn main() {{ println!(\"{{:?}}\", morph_weights({arrays}, {d}, &{WEIGHTS}, {str(is_layers).lower()})); }}\n"
        (folder / "recipe.rs").write_text(block("engines/bevy.md", "rust", "fn morph_weights") + main)
        run("rustc", "--edition", "2021", "-o", folder / "recipe", folder / "recipe.rs")
        compare("Bevy", eval(run(folder / "recipe")), table_weights(pliant, WEIGHTS), 1e-6)


def main(engine, stand_ins, tool, asset, layers):
    with tempfile.TemporaryDirectory(prefix="pliant-recipe-") as name:
        {"unity": unity, "unreal": unreal, "bevy": bevy}[engine](stand_ins, tool, Path(asset), Path(layers), Path(name))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
