"""Small binary glTF: what tests write of it, and the chunk GLTF of a tiny asset (formats/SPEC.md)."""
import json
import struct
import zlib

import numpy as np

COMPONENTS = {"<f4": 5126, "<u2": 5123, "<i2": 5122}
STRIPES = [(230, 40, 30, 255), (40, 200, 60, 255), (40, 80, 230, 255), (240, 220, 40, 0)]


def png(rows):
    """rows: [height, width, 4] bytes."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    height, width = rows.shape[:2]
    raw = b"".join(b"\0" + row.tobytes() for row in rows)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def striped_image():
    """Red, green, blue, and yellow that is see-through."""
    return png(np.repeat(np.repeat(np.array(STRIPES, "u1")[None], 8, axis=0), 8, axis=1))


class Builder:
    """A binary glTF file while it grows: .json is the caller's to fill in."""

    def __init__(self):
        self.json = {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}
        self.binary = b""

    @classmethod
    def of(cls, glb):
        """One that goes on with a file of bytes()."""
        scene, text_size = cls(), struct.unpack_from("<I", glb, 12)[0]
        scene.json, scene.binary = json.loads(glb[20:20 + text_size]), glb[28 + text_size:]
        return scene

    def view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values, kind, component="<f4", **more):
        """values: [count, width]; SCALAR: any shape."""
        values = np.ascontiguousarray(values, component)
        self.json["accessors"].append({"bufferView": self.view(values.tobytes()), "componentType": COMPONENTS[component],
                                       "count": values.size if kind == "SCALAR" else len(values), "type": kind, **more})
        return len(self.json["accessors"]) - 1

    def indices(self, faces):
        return self.accessor(faces, "SCALAR", "<u2")

    def striped_material(self, **more):
        """Adds image, sampler, texture and material, each the only one so far."""
        self.json.update({
            "images": [{"bufferView": self.view(striped_image()), "mimeType": "image/png", "name": "stripes"}],
            "samplers": [{"magFilter": 9728, "minFilter": 9728, "wrapS": 10497, "wrapT": 33071}],
            "textures": [{"source": 0, "sampler": 0}],
            "materials": [{"name": "stripes", "doubleSided": True, "alphaMode": "MASK", "alphaCutoff": 0.4,
                           "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0,
                                                    "roughnessFactor": 1}}]})

    def bytes(self):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.json["buffers"] = [{"byteLength": len(self.binary)}]
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        total = 28 + len(text) + len(self.binary)
        return (struct.pack("<4sIII4s", b"glTF", 2, total, len(text), b"JSON") + text
                + struct.pack("<I4s", len(self.binary), b"BIN\0") + self.binary)


def scene_chunk(faces, vertex_count, moved=lambda places: places, transform=None):
    """moved: what to do to texture coordinates. transform: the texture's KHR_texture_transform. Two parts: the first half of
    the vertices with four stripes along them (the last see-through), the others in vertex colours, from cyan to magenta.
    Faces between the two belong to neither."""
    builder = Builder()
    builder.striped_material()
    if transform:
        texture = builder.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
        texture["extensions"] = {"KHR_texture_transform": transform}
        builder.json["extensionsUsed"] = ["KHR_texture_transform"]
    half = vertex_count // 2
    primitives = []
    for first, count in ((0, half), (half, vertex_count - half)):
        mine = faces[((faces >= first) & (faces < first + count)).all(axis=1)] - first
        along = np.arange(count) / max(count - 1, 1)
        if first == 0:
            places = moved(np.stack([along, np.full(count, 0.5)], axis=1))
            attributes = {"TEXCOORD_0": builder.accessor(places, "VEC2")}
        else:
            colours = np.stack([along, 1 - along, np.ones(count), np.ones(count)], axis=1)
            attributes = {"COLOR_0": builder.accessor(colours, "VEC4")}
        primitives.append({"attributes": attributes, "indices": builder.indices(mine),
                           "extras": {"name": "half", "first_vertex": first, "vertex_count": count}})
    primitives[0]["material"] = 0
    builder.json.update({"meshes": [{"primitives": primitives}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
                         "scene": 0})
    return builder.bytes()
