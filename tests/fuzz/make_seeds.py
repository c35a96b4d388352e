"""Writes the seeds of the mesh readers, of glTF and of configurations into corpus/: small good files, made as
tests/bad_input makes its own.

    make_seeds.py CORPUS [GLB ...]

GLB: further seeds of glTF, such as small files with Draco and meshopt streams.
"""
import json
import struct
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "bad_input"))
import solids  # noqa: E402
from gltf_files import Gltf, draco_triangle  # noqa: E402

POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0.5), (0, 1, 0), (0.5, 0.5, 1)]
FACES = [(0, 1, 2, 3), (0, 1, 4), (1, 2, 4)]


def surfaces():
    obj = "".join(f"v {x} {y} {z}\n" for x, y, z in POINTS) + "vt 0 1\nvn 0 0 1\nusemtl skin\n" \
        + "".join("f " + " ".join(f"{i + 1}/1/1" for i in face) + "\n" for face in FACES) + "f -1 -2 -3\n"
    off = f"OFF\n{len(POINTS)} {len(FACES)} 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in POINTS) \
        + "".join(" ".join(map(str, (len(f), *f))) + "\n" for f in FACES)
    yield "obj", "mesh", obj
    yield "obj", "exponents", "v 100e9223372036854775807 0.001e-9223372036854775808 1e-400\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    yield "off", "mesh", off
    header = "ply\nformat {} 1.0\ncomment none\nelement vertex 5\nproperty {} x\nproperty float y\nproperty float z\n" \
        "property uchar red\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
    text = "".join(f"{x} {y} {z} 9\n" for x, y, z in POINTS) \
        + "".join(" ".join(map(str, (len(f), *f))) + "\n" for f in FACES)
    yield "ply", "ascii", header.format("ascii", "float") + text
    for order, name in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        body = b"".join(struct.pack(order + "dffB", *p, 9) for p in POINTS) \
            + b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in FACES)
        yield "ply", name, header.format(name, "double").encode() + body


def all_solids():
    points = POINTS[:3] + POINTS[4:] + [(2, 2, 2)]
    mesh = solids.Solid(points, [(0, 1, 2, 3), (1, 2, 3, 4)], [(2, (0, 1, 2)), (15, (0,))])
    yield "msh", "2", solids.msh_text(mesh)
    yield "msh", "4", solids.msh4_text(mesh)
    yield "msh", "4_binary", solids.msh4_bytes(mesh)
    yield "mesh", "mesh", solids.medit_text(mesh)
    yield "veg", "mesh", solids.vega_text(mesh)
    yield "vtk", "text", solids.vtk_text(mesh)
    head = "# vtk DataFile Version {}\nsolid\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
    body = b"".join(struct.pack(">3d", *p) for p in points)
    cells = b"\nCELLS 2 10\n" + b"".join(struct.pack(">5i", 4, *t) for t in mesh.tets) + b"\nCELL_TYPES 2\n"
    yield "vtk", "binary", head.format("3.0").encode() + body + cells + struct.pack(">2i", 10, 10) + b"\n"
    cells = b"\nCELLS 3 8\nOFFSETS vtktypeint64\n" + struct.pack(">3q", 0, 4, 8) + b"\nCONNECTIVITY vtktypeint64\n" \
        + b"".join(struct.pack(">4q", *t) for t in mesh.tets) + b"\nCELL_TYPES 2\n" + struct.pack(">2i", 10, 10) + b"\n"
    yield "vtk", "binary_5", head.format("5.1").encode() + body + cells


def gltf():
    """Two targets, a skin with two joints, an animation of both kinds, a sparse accessor, a texture."""
    faces = [(0, 1, 2), (0, 2, 3), (0, 1, 4), (1, 2, 4)]
    plain = Gltf()
    plain.mesh(POINTS, faces)
    out = Gltf()
    joints = out.accessor([(0, 1, 0, 0)] * 5, 5121)
    weights = out.accessor([(0.5, 0.5, 0.0, 0.0)] * 5)
    moved = [(0.0, 0.1 * i, 0.0) for i in range(5)]
    out.mesh(POINTS, faces, [moved, moved[::-1]], ["up", "down"], JOINTS_0=joints, WEIGHTS_0=weights,
             TEXCOORD_0=out.accessor([(0.0, 1.0)] * 5), NORMAL=out.accessor([(0.0, 0.0, 1.0)] * 5))
    unit = (1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    out.json["nodes"] = [{"mesh": 0, "skin": 0}, {"children": [2]}, {"rotation": [0, 0, 0, 1]}]
    out.json["scenes"] = [{"nodes": [0, 1]}]
    out.json["skins"] = [{"joints": [1, 2], "inverseBindMatrices": out.accessor([unit] * 2)}]
    out.animation("run", (2, "rotation", "LINEAR", [0.0, 1.0], [(0.0, 0, 0, 1), (0, 0, 1.0, 0)]),
                  (2, "translation", "CUBICSPLINE", [0.0, 1.0], [(0.0, 0, 0)] * 6),
                  (0, "weights", "STEP", [0.0, 1.0], [0.0, 1.0, 1.0, 0.0]))
    out.json["accessors"][2]["sparse"] = {
        "count": 1, "indices": {"bufferView": out.view(struct.pack("<H", 1)), "componentType": 5123},
        "values": {"bufferView": out.view(struct.pack("<3f", 1, 2, 3))}}
    out.json["images"] = [{"bufferView": out.view(b"\x89PNG\r\n\x1a\n"), "mimeType": "image/png"}]
    out.json["textures"] = [{"source": 0}]
    out.json["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]
    out.json["meshes"][0]["primitives"][0]["material"] = 0
    for name, stream in (("tables", draco_triangle(bytes([1, 1, 18, 1, 2, 0, 64, 1, 0]))),
                         ("bool", draco_triangle(b"\0", 11, bytes([0, 0, 0, 2, 0, 0, 0, 255, 0])))):
        packed = Gltf()
        primitive = packed.mesh(POINTS[:3], [(0, 1, 2)])
        primitive["extensions"] = {
            "KHR_draco_mesh_compression": {"bufferView": packed.view(stream), "attributes": {"POSITION": 0}}}
        yield "gltf", f"draco_{name}.glb", packed.glb()
    yield "gltf", "plain.glb", plain.glb()
    yield "gltf", "rich.glb", out.glb()
    yield "gltf", "plain.gltf", plain.gltf()


def configurations():
    bake = {"poses": ["rest.obj", "run.obj"], "dim": 3, "tolerance": 0.5, "best_effort": True, "range": ["a=0:1"]}
    yield "config", "config", json.dumps(bake, indent=1)
    manifest = {"defaults": {"dim": 8}, "bakes": [{"name": "a\u00e9", "config": "a.json", **bake}]}
    yield "config", "manifest", json.dumps(manifest)


def main(corpus, *further):
    seeds = [*surfaces(), *all_solids(), *gltf(), *configurations(),
             *(("gltf", Path(path).name, Path(path).read_bytes()) for path in further)]
    for target, name, content in seeds:
        folder = Path(corpus) / target
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"seed_{name}").write_bytes(content if isinstance(content, bytes) else content.encode())
    print(f"{len(seeds)} seeds")


if __name__ == "__main__":
    main(*sys.argv[1:])
