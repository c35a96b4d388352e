"""Shapes in numpy: reading and writing the PLY files of poses and blends, masses, rigid alignment, the relative L2 error,
subdivision."""
import numpy as np

SCALARS = {"char": "i1", "uchar": "u1", "short": "i2", "ushort": "u2", "int": "i4", "uint": "u4", "float": "f4",
           "double": "f8",
           "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4",
           "float64": "f8"}


def read_ply(path):
    """Positions (n x 3) and triangles of a binary little-endian PLY whose faces are triangles or quads."""
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    elements = []
    for line in data[:end].decode("ascii", "replace").splitlines():
        word = line.split()
        if word[:1] == ["format"] and word[1] != "binary_little_endian":
            raise ValueError(f"{path}: only binary little-endian files are read here")
        if word[:1] == ["element"]:
            elements.append((word[1], int(word[2]), []))
        elif word[:1] == ["property"]:
            elements[-1][2].append(word[1:])
    positions, triangles = None, None
    for name, count, properties in elements:
        if name == "vertex":
            kind = np.dtype([(p[-1], "<" + SCALARS[p[0]]) for p in properties])
            rows = np.frombuffer(data, kind, count, end)
            positions = np.stack([rows[axis].astype(np.float64) for axis in "xyz"], axis=1)
            end += kind.itemsize * count
        elif name == "face":
            _, size_type, index_type, _ = properties[0]
            triangles = read_faces(data, end, count, SCALARS[size_type], SCALARS[index_type])
            break
    return positions, triangles


def read_faces(data, offset, count, size_type, index_type):
    """Polygons as fans of triangles. Files with one kind of polygon, nearly all, are read at once."""
    size_bytes = np.dtype(size_type).itemsize
    first = int(np.frombuffer(data, "<" + size_type, 1, offset)[0])
    kind = np.dtype([("size", "<" + size_type), ("corners", "<" + index_type, (first,))])
    if offset + kind.itemsize * count <= len(data):
        rows = np.frombuffer(data, kind, count, offset)
        if (rows["size"] == first).all():
            corners = rows["corners"].astype(np.int64)
            return np.concatenate([corners[:, [0, i, i + 1]] for i in range(1, first - 1)])
    triangles = []
    for _ in range(count):
        size = int(np.frombuffer(data, "<" + size_type, 1, offset)[0])
        corners = np.frombuffer(data, "<" + index_type, size, offset + size_bytes)
        offset += size_bytes + size * np.dtype(index_type).itemsize
        triangles += [(corners[0], corners[i], corners[i + 1]) for i in range(1, size - 1)]
    return np.array(triangles, np.int64)


def lumped_masses(positions, triangles):
    """A third of the area of the triangles around each vertex."""
    a, b, c = (positions[triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    return np.bincount(triangles.ravel(), np.repeat(areas / 3, 3), len(positions))


def best_motion(source, target, masses):
    """Rotation and translation that bring source closest to target in the masses (Kabsch 1976)."""
    weights = masses / masses.sum()
    source_centre, target_centre = weights @ source, weights @ target
    u, _, v = np.linalg.svd((target - target_centre).T @ (weights[:, None] * (source - source_centre)))
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    return rotation, target_centre - rotation @ source_centre


def align(source, target, masses):
    rotation, translation = best_motion(source, target, masses)
    return source @ rotation.T + translation


def relative_l2(blend, truth, masses):
    """The error of baker/elastic/average/shape_error.h: the truth moved rigidly onto the blend,
    mass norm over its own about the centroid."""
    moved = align(truth, blend, masses)
    centroid = masses @ moved / masses.sum()
    norm = lambda x: np.sqrt((masses[:, None] * x ** 2).sum())
    return norm(moved - blend) / norm(moved - centroid)


def largest_distance(blend, truth, masses, diagonal):
    return np.linalg.norm(align(truth, blend, masses) - blend, axis=1).max() / diagonal


def diagonal_of(positions):
    return np.linalg.norm(positions.max(axis=0) - positions.min(axis=0))


def midpoints(triangles, vertex_count):
    """The pairs of vertices (e, 2) with a new vertex between them, and the triangles (4 f, 3) that they make."""
    corners = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges, inverse = np.unique(np.sort(corners, axis=1), axis=0, return_inverse=True)
    ab, bc, ca = (inverse.reshape(-1, 3) + vertex_count).T
    a, b, c = triangles.T
    parts = [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
    return edges, np.concatenate([np.stack(part, axis=1) for part in parts])


def subdivide(poses, triangles):
    edges, finer = midpoints(triangles, len(poses[0]))
    return [np.concatenate([pose, pose[edges].mean(axis=1)]) for pose in poses], finer


def write_ply(path, positions, triangles, scalar="float"):
    """`scalar`: "float" or "double", what the positions are stored as."""
    faces = np.empty(len(triangles), [("count", "u1"), ("vertices", "<i4", 3)])
    faces["count"], faces["vertices"] = 3, triangles
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
              + "".join(f"property {scalar} {axis}\n" for axis in "xyz")
              + f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    path.write_bytes(header.encode() + positions.astype("<" + SCALARS[scalar]).tobytes() + faces.tobytes())
