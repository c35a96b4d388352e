"""The chunk GLTF of an asset: binary glTF without positions, read with json and numpy."""
import json
import struct

import numpy as np

COMPONENTS = {5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Scene:
    """.parts: dictionaries with name, first_vertex, vertex_count, material (number or None), faces [t, 3] in vertices of the
    asset, and attributes {name: [vertex_count, width]}, normalised integers as numbers from -1 to 1. .materials, .textures,
    .samplers: the JSON as it is. .images: (MIME type, bytes). require(condition, rule, what) refuses what is wrong."""

    def __init__(self, data, vertex_count, require):
        require(len(data) >= 28, "GLTF", "no binary glTF")
        magic, version, total, size, kind = struct.unpack_from("<4sIII4s", data)
        require((magic, version, total, kind) == (b"glTF", 2, len(data), b"JSON") and size <= len(data) - 28, "GLTF",
                "no binary glTF")
        length, kind = struct.unpack_from("<I4s", data, 20 + size)
        require(kind == b"BIN\0" and length == len(data) - 28 - size, "GLTF", "no binary glTF")
        self.require, self.binary = require, data[28 + size:]
        try:
            self.json = json.loads(data[20:20 + size])
            self.materials, self.textures, self.samplers = (self.json.get(key, [])
                                                            for key in ("materials", "textures", "samplers"))
            self.images = [(image["mimeType"], self.view(image["bufferView"])) for image in self.json.get("images", [])]
            self.parts = [self.part(primitive) for primitive in self.json["meshes"][0]["primitives"]]
        except (ValueError, KeyError, IndexError, TypeError) as error:
            require(False, "GLTF", f"its JSON: {error!r}")
        self.check_parts(vertex_count)

    def view(self, index):
        view = self.json["bufferViews"][index]
        start, size = view.get("byteOffset", 0), view["byteLength"]
        self.require(0 <= start <= len(self.binary) and 0 <= size <= len(self.binary) - start, "GLTF",
                     f"view {index} leaves the buffer")
        return self.binary[start:start + size]

    def accessor(self, index):
        """[count, width]; a row may take more bytes than its numbers (byteStride)."""
        entry = self.json["accessors"][index]
        kind, width = np.dtype(COMPONENTS[entry["componentType"]]), WIDTHS[entry["type"]]
        data, row = self.view(entry["bufferView"]), kind.itemsize * width
        stride = self.json["bufferViews"][entry["bufferView"]].get("byteStride", row)
        start, count = entry.get("byteOffset", 0), entry["count"]
        self.require(start >= 0 and stride >= row and (count == 0 or start + stride * (count - 1) + row <= len(data)),
                     "GLTF", f"accessor {index} leaves its view")
        table = np.ndarray((count, width), kind, data, start, (stride, kind.itemsize))
        return np.maximum(table / np.iinfo(kind).max, -1.0) if entry.get("normalized") else table

    def part(self, primitive):
        extras = primitive["extras"]
        first = extras["first_vertex"]
        faces = self.accessor(primitive["indices"]).reshape(-1, 3) if "indices" in primitive else np.zeros((0, 3), "<u4")
        self.require((faces < extras["vertex_count"]).all(), "GLTF", "an index is beyond its part")
        return {"name": extras.get("name", ""), "first_vertex": first, "vertex_count": extras["vertex_count"],
                "material": primitive.get("material"), "faces": faces.astype(int) + first,
                "attributes": {name: self.accessor(index) for name, index in primitive["attributes"].items()}}

    def check_parts(self, vertex_count):
        at = 0
        for part in self.parts:
            self.require(part["first_vertex"] == at, "GLTF", "parts do not follow each other")
            self.require(part["material"] is None or 0 <= part["material"] < len(self.materials), "GLTF",
                         "there is no such material")
            self.require(all(len(rows) == part["vertex_count"] for rows in part["attributes"].values()), "GLTF",
                         "size of an attribute")
            at += part["vertex_count"]
        self.require(at == vertex_count, "GLTF", "its parts do not have all vertices")
