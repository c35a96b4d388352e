"""Assets of many numbers in few bytes: vertices that no coordinate moves, for tests of limits."""
import struct

import numpy as np
import tiny_scene
from tiny_asset import assemble, floats

BLOCK = 65536  # vertices


def element_chunk(dimension, poses):
    """One tetrahedron of St. Venant-Kirchhoff material, which the first coordinates stretch."""
    rows = np.zeros((1 + dimension, 6, 16))
    rows[0, 0] = rows[0, 4] = 1
    rows[1:, 0] = 0.01
    pose = np.zeros((poses, 9, 16))
    pose[:, 3, 0] = pose[:, 6, 0] = pose[:, 8, 0] = 1
    pose[1, 0, 0] = 0.1
    first, second = 128, 128 + (4 * rows.size + 63) // 64 * 64
    head = struct.pack("<I60x4I4QI12x", 1, 3, 1, 0, 0, first, second, second, 0, 0)
    return (head + floats(rows)).ljust(second, b"\0") + floats(pose)


def shape_chunk(vertex_count, dimension):
    """BASF of still tiles."""
    records, data, blocks = b"", b"", [0]
    for first in range(0, vertex_count, BLOCK):
        for start in range(first, min(first + BLOCK, vertex_count), 64):
            size = min(64, first + BLOCK - start, vertex_count - start)
            records += struct.pack("<IHH3ff", len(data) // 4, size, 0, 0, 0, 0, 0)
            numbers = np.zeros(-(-size // 16) * 16, "<u2")
            numbers[:size] = np.arange(start - first, start - first + size)
            places = np.zeros((len(numbers) // 16, 3, 16))
            places[:, 0] = start / 64 + np.arange(16) ** 2
            places[:, 1] = np.arange(16)
            data += numbers.tobytes() + floats(places)
        blocks.append(len(records) // 24)
    chunk = struct.pack("<IfI52x", blocks[-1], 1e-4, BLOCK)
    for part in (struct.pack("<fIff", 1, 0, 0, 1) * dimension, np.array(blocks, "<u4").tobytes(), records):
        chunk += part
        chunk += bytes(-len(chunk) % 64)
    return chunk + data


def make_still_asset(vertex_count, dimension, part_count=0):
    """Bytes of an asset of two poses and one triangle. part_count: its GLTF has so many parts of three vertices, and another
    one of all the rest."""
    poses, width = 2, (dimension + 15) // 16 * 16
    coordinates = np.zeros((poses, width))
    coordinates[1, :dimension] = 0.01
    chunks = [("SOLV", 1, struct.pack("<f60x", 1) + floats(np.zeros(width)) + floats(np.eye(dimension, width))
               + floats(coordinates)),
              ("ELEM", 1, element_chunk(dimension, poses)),
              ("TRIS", 1, struct.pack("<3I", 0, 1, 2)),
              ("MRNG", 0, floats(np.stack([np.full(width, -0.1), np.full(width, 0.1)]) * (np.arange(width) < dimension))),
              ("NAME", 1, b"a\0b\0"),
              ("ANSW", 1, struct.pack("<I60x", 1) + floats(np.concatenate([[0.5, 0.5], np.zeros(dimension)]))),
              ("CERT", 1, b"{}")]
    if part_count:
        scene = tiny_scene.Builder()
        faces, rest = scene.indices(np.array([[0, 1, 2]])), vertex_count - 3 * part_count
        parts = [(0, rest)] + [(rest + 3 * i, 3) for i in range(part_count)]
        scene.json["meshes"] = [{"primitives": [{"attributes": {}, "indices": faces,
                                                 "extras": {"name": str(at), "first_vertex": at, "vertex_count": size}}
                                                for at, size in parts]}]
        scene.json.update({"nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})
        chunks.append(("GLTF", 0, scene.bytes()))
    chunks.append(("BASF", 1, shape_chunk(vertex_count, dimension)))
    return assemble((vertex_count, 1, dimension, poses), (0, 0, 0), chunks)
