"""Tiny shells and their poses, from formulas: a strip (open fans at its rim) and a tube (closed fans)."""
import numpy as np


def grid_faces(columns, rows, closed):
    """Two triangles a cell, diagonals alternating; vertex (i, j) is i * rows + j; `closed` joins last and first row."""
    faces = []
    for i in range(columns - 1):
        for j in range(rows if closed else rows - 1):
            a, b = i * rows + j, (i + 1) * rows + j
            c, d = (i + 1) * rows + (j + 1) % rows, i * rows + (j + 1) % rows
            faces += [[a, b, c], [a, c, d]] if (i + j) % 2 == 0 else [[a, b, d], [b, c, d]]
    return np.array(faces)


def strip(columns, rows):
    u, v = np.meshgrid(np.linspace(0, 3, columns), np.linspace(-0.4, 0.4, rows), indexing="ij")
    # Not exactly flat: a flat strip has no preferred side to bend to.
    return np.stack([u, v, 0.05 * np.sin(2 * u) + 0.1 * v * v], axis=-1).reshape(-1, 3), grid_faces(columns, rows, False)


def tube(columns, rows):
    u, v = np.meshgrid(np.linspace(0, 3, columns), np.arange(rows) * 2 * np.pi / rows, indexing="ij")
    radius = 0.4 + 0.1 * np.sin(1.3 * u)
    return np.stack([u, radius * np.cos(v), radius * np.sin(v)], axis=-1).reshape(-1, 3), grid_faces(columns, rows, True)


def deform(x, bend, twist, stretch, bulge):
    """Bends the axis (x) to an arc, twists about it, stretches along and bulges across."""
    length = x[:, 0].max()
    s = x[:, 0] / length
    y = x[:, 1:] * (1 + bulge * np.sin(np.pi * s))[:, None]
    angle = twist * s
    cos, sin = np.cos(angle), np.sin(angle)
    y = np.stack([cos * y[:, 0] - sin * y[:, 1], sin * y[:, 0] + cos * y[:, 1]], axis=1)
    arc = bend * s
    # sin(arc)/bend and (1-cos(arc))/bend, also for bend = 0
    run = length * (1 + stretch) * s * np.sinc(arc / np.pi)
    rise = length * (1 + stretch) * s * np.sin(arc / 2) * np.sinc(arc / 2 / np.pi)
    return np.stack([run - y[:, 1] * np.sin(arc), y[:, 0], rise + y[:, 1] * np.cos(arc)], axis=1)


def make_poses(rest, count, random):
    """Pose 0 and count-1 others, moderately far from it and from each other."""
    fixed = [(0, 0, 0, 0), (1.2, 0, 0, 0), (0, 1.0, 0.1, 0), (-0.8, 0.5, 0, 0.15), (0.6, -0.9, -0.1, 0.1)]
    while len(fixed) < count:
        fixed.append(tuple(random.uniform(-1, 1, 4) * (1.2, 1.0, 0.15, 0.2)))
    return np.array([deform(rest, *fixed[k]) for k in range(count)])


def make_subspace(poses, rest, dimension, random):
    """Orthonormal directions [dimension, n, 3] that contain all differences x_k - x_0, filled up with smooth fields."""
    if dimension < len(poses) - 1:
        raise ValueError(f"{len(poses)} poses need at least {len(poses) - 1} dimensions")
    differences = [pose - poses[0] for pose in poses[1:]]
    centred = rest - rest.mean(axis=0)
    x, y, z = (centred / abs(centred).max(axis=0)).T
    fields = [np.stack([f * (i == axis) for i in range(3)], axis=1)
              for f in (x * x, x * y, x * z, y * z, x ** 3, x * x * y, x * x * z, x * y * z, x ** 4, x ** 3 * y, x ** 3 * z,
                        x ** 5, x ** 4 * y, x ** 6) for axis in (2, 1, 0)]
    basis = []
    for vector in differences + fields:
        v = vector.reshape(-1)
        v = v / np.linalg.norm(v)
        for _ in range(2):
            for u in basis:
                v = v - (u @ v) * u
        if np.linalg.norm(v) > 1e-4:
            basis.append(v / np.linalg.norm(v))
        if len(basis) == dimension:
            return np.array(basis).reshape(dimension, -1, 3)
    raise ValueError(f"this mesh has no {dimension} independent smooth directions")
