"""Small meshes to bake, the files that the command line takes them from, and what it writes, read back."""
import json
import struct

import numpy as np


def tube(angle, rings=14, sides=8):
    """A tube of length 4 and radius 0.5, bent by `angle` over its length: positions (n, 3), triangles (f, 3)."""
    along = np.linspace(-2, 2, rings)
    round_ = np.arange(sides) * (2 * np.pi / sides)
    curvature = angle / 4
    x, y, z = along[:, None], 0.5 * np.cos(round_), 0.5 * np.sin(round_)
    if angle:
        radius = 1 / curvature - y
        positions = np.stack([radius * np.sin(x * curvature), 1 / curvature - radius * np.cos(x * curvature), z + 0 * x], -1)
    else:
        positions = np.stack([x + 0 * y, y + 0 * x, z + 0 * x], -1)
    faces = []
    for i in range(rings - 1):
        for j in range(sides):
            a, b = i * sides + j, i * sides + (j + 1) % sides
            faces += [(a, a + sides, b), (b, a + sides, b + sides)]
    return positions.reshape(-1, 3), np.array(faces)


def tubes(angles=(0.0, 1.2), **size):
    """Poses (m, n, 3) and their faces."""
    made = [tube(angle, **size) for angle in angles]
    return np.stack([positions for positions, _ in made]), made[0][1]


def quads(faces):
    """The triangles of a tube, two by two."""
    return np.stack([faces[0::2, 0], faces[0::2, 1], faces[1::2, 2], faces[1::2, 0]], 1)


def bars(angles=(0.0, 0.9), cells=(6, 2, 2)):
    """A solid bar: poses (m, n, 3) and tetrahedra (t, 4), numbered so that its boundary does not come first."""
    nx, ny, nz = (count + 1 for count in cells)
    grid = np.stack(np.meshgrid(np.linspace(-1.5, 1.5, nx), np.linspace(-0.5, 0.5, ny), np.linspace(-0.5, 0.5, nz),
                                indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(grid)).reshape(nx, ny, nz)
    tets = []
    for x, y, z in np.ndindex(cells):
        for order in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
            corner = np.array([x, y, z])
            tet = [number[tuple(corner)]]
            for axis in order:
                corner[axis] += 1
                tet.append(number[tuple(corner)])
            a, b, c, d = grid[tet]
            tets.append(tet if np.linalg.det([b - a, c - a, d - a]) > 0 else [tet[0], tet[2], tet[1], tet[3]])
    shuffle = np.random.default_rng(3).permutation(len(grid))
    place = np.argsort(shuffle)
    poses = []
    for angle in angles:
        turn = angle * grid[:, 0] / 3  # twisted, which keeps volumes positive
        y, z = grid[:, 1], grid[:, 2]
        poses.append(np.stack([grid[:, 0], y * np.cos(turn) - z * np.sin(turn), y * np.sin(turn) + z * np.cos(turn)], -1))
    return np.stack(poses)[:, shuffle], place[np.array(tets)]


def write_obj(path, positions, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in positions.tolist()]
    lines += ["f " + " ".join(str(v + 1) for v in face) for face in faces.tolist()]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def write_medit(path, positions, tets):
    lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(positions))]
    lines += [f"{x!r} {y!r} {z!r} 0" for x, y, z in positions.tolist()]
    lines += ["Tetrahedra", str(len(tets))] + [" ".join(str(v + 1) for v in tet) + " 0" for tet in tets.tolist()] + ["End"]
    path.write_text("\n".join(lines) + "\n")
    return str(path)


def write_glb(path, positions, faces, targets):
    """A GLB with morph targets: {name: positions}."""
    base = positions.astype("<f4")
    blocks = [base] + [(shape - positions).astype("<f4") for shape in targets.values()] + [faces.astype("<u4")]
    views, accessors, data = [], [], b""
    for k, block in enumerate(blocks):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": block.nbytes})
        data += block.tobytes()
        if block is blocks[-1]:
            accessors.append({"bufferView": k, "componentType": 5125, "count": block.size, "type": "SCALAR"})
        else:
            accessors.append({"bufferView": k, "componentType": 5126, "count": len(block), "type": "VEC3",
                              "min": block.min(0).tolist(), "max": block.max(0).tolist()})
    primitive = {"attributes": {"POSITION": 0}, "indices": len(blocks) - 1,
                 "targets": [{"POSITION": k + 1} for k in range(len(targets))]}
    document = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
                "meshes": [{"primitives": [primitive], "extras": {"targetNames": list(targets)}}],
                "buffers": [{"byteLength": len(data)}], "bufferViews": views, "accessors": accessors}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) + struct.pack("<I4s", len(text), b"JSON")
                     + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
    return str(path)


def read_ply(path):
    """Positions (n, 3) float32 of a PLY that the command line wrote."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    count = int(header.split(b"element vertex ")[1].split()[0])
    return np.frombuffer(body, "<f4", 3 * count).reshape(-1, 3)
