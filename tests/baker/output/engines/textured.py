"""A small textured character as a GLB: a striped tube that bends, in three primitives.
0 the side: a texture of four stripes, the last see-through (alpha mask), split at the seam of its texture coordinates.
1 the lid: vertex colours and a base colour factor, no texture. 2 the bottom: no material, nothing but positions."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "runtime"))
from tiny_scene import Builder  # noqa: E402

ROUND, ALONG, LENGTH, RADIUS, BEND = 16, 9, 2.0, 0.5, 0.9
LID = (0.9, 0.6, 1.0, 1.0)


def bent(points):
    """The tube's axis, along y, becomes an arc in the plane of x and y."""
    angle = BEND * points[:, 1] / LENGTH
    reach = LENGTH / BEND - points[:, 0]
    return np.stack([LENGTH / BEND - reach * np.cos(angle), reach * np.sin(angle), points[:, 2]], axis=1)


def side():
    u, v = np.meshgrid(np.arange(ROUND + 1) / ROUND, np.arange(ALONG + 1) / ALONG)
    angle = 2 * np.pi * (u % 1)
    points = np.stack([RADIUS * np.cos(angle), LENGTH * v, -RADIUS * np.sin(angle)], axis=-1).reshape(-1, 3)
    faces = []
    for i in range(ALONG):
        for j in range(ROUND):
            a, b = i * (ROUND + 1) + j, (i + 1) * (ROUND + 1) + j
            faces += [(a, a + 1, b + 1), (a, b + 1, b)]
    return points, np.array(faces), np.stack([u, v], axis=-1).reshape(-1, 2)


def cap(height, is_top):
    angle = 2 * np.pi * np.arange(ROUND) / ROUND
    rim = np.stack([RADIUS * np.cos(angle), np.full(ROUND, height), -RADIUS * np.sin(angle)], axis=1)
    faces = np.array([(ROUND, j, (j + 1) % ROUND) for j in range(ROUND)])
    return np.vstack([rim, [[0, height, 0]]]), faces if is_top else faces[:, ::-1]


def primitive(builder, points, faces, **attributes):
    def places(values):
        values = values.astype("<f4")
        return builder.accessor(values, "VEC3", min=values.min(axis=0).tolist(), max=values.max(axis=0).tolist())
    kinds = {2: "VEC2", 4: "VEC4"}
    others = {name: builder.accessor(values, kinds[values.shape[1]]) for name, values in attributes.items()}
    return {"attributes": {"POSITION": places(points), **others},
            "targets": [{"POSITION": places(bent(points).astype("<f4") - points.astype("<f4"))}],
            "indices": builder.indices(faces)}


def write(path, with_transform=False):
    """Writes the file. Its two poses: as modelled, and bent. with_transform: the file requires KHR_texture_transform."""
    builder = Builder()
    points, faces, places = side()
    lid, lid_faces = cap(LENGTH, True)
    colours = np.ones((len(lid), 4))
    colours[-1] = (0, 0, 0, 1)  # dark in the middle
    bottom, bottom_faces = cap(0, False)
    primitives = [primitive(builder, points, faces, TEXCOORD_0=places), primitive(builder, lid, lid_faces, COLOR_0=colours),
                  primitive(builder, bottom, bottom_faces)]
    primitives[0]["material"], primitives[1]["material"] = 0, 1
    builder.striped_material()
    if with_transform:
        builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = ["KHR_texture_transform"]
        builder.json["textures"][0]["source"] = 0.0  # whole numbers may be written so
        texture = builder.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
        texture["extensions"] = {"KHR_texture_transform": {"offset": [0.25, 0]}}
    builder.json["materials"].append({"name": "lid", "pbrMetallicRoughness": {"baseColorFactor": LID, "metallicFactor": 0,
                                                                              "roughnessFactor": 1}})
    builder.json.update({
        "meshes": [{"name": "tube", "primitives": primitives, "extras": {"targetNames": ["bend"]}}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})
    path.write_bytes(builder.bytes())
