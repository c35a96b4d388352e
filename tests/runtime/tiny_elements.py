"""Element numbers of a whole tiny mesh, from the energies themselves (Discrete Shells, ARAP), for tests only.

Every energy is written twice: absolute_energy() as a textbook has it, and the batches as SPEC.md section 4 wants them.
tiny_asset.make_model() insists that they differ by a constant.
"""
import math

import numpy as np

import pliant_reference_path  # noqa: F401
from pliant_reference import ARAP, EDGE, HINGE, NEO_HOOKEAN, STVK, TIE, Batch

MU = LAMBDA = 1.0
BENDING = 0.02  # thickness delta: larger than a real one, so that bending and membrane both matter in a small mesh


class Topology:
    """Faces, hinges (x0, x1, x2, x3 of the SPEC) and vertex fans."""

    def __init__(self, faces, vertex_count):
        self.faces = faces
        self.hinges, self.hinge_faces = self.find_hinges(faces)
        self.fans = [self.find_fan(faces, v) for v in range(vertex_count)]

    @staticmethod
    def find_hinges(faces):
        first, hinges, pairs = {}, [], []
        for f, face in enumerate(faces):
            for i in range(3):
                a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
                if (b, a) in first:
                    g, opposite = first[b, a]
                    hinges.append([b, a, opposite, c])
                    pairs.append([g, f])
                first[a, b] = (f, c)
        return np.array(hinges), np.array(pairs)

    @staticmethod
    def find_fan(faces, vertex):
        """(neighbours in order, is_closed)"""
        follow = {}
        for face in faces:
            for i in range(3):
                if face[i] == vertex:
                    follow[face[(i + 1) % 3]] = face[(i + 2) % 3]
        starts = set(follow) - set(follow.values())
        fan = [min(starts) if starts else min(follow)]
        while fan[-1] in follow and (follow[fan[-1]] != fan[0]):
            fan.append(follow[fan[-1]])
        return fan, not starts


def dot(a, b):
    return (a * b).sum(axis=-1)


def face_areas(x, faces):
    return np.linalg.norm(np.cross(x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]]), axis=1) / 2


def dihedral_angles(x, hinges):
    x0, x1, x2, x3 = (x[hinges[:, i]] for i in range(4))
    e, n1, n2 = x1 - x0, np.cross(x1 - x0, x2 - x0), np.cross(x3 - x0, x1 - x0)
    return np.arctan2(dot(e, np.cross(n1, n2)) / np.linalg.norm(e, axis=1), dot(n1, n2))


def metrics(x, faces):
    e, a = x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]]
    return np.stack([dot(e, e), dot(e, a), dot(a, a)])


def matrices(g):
    return np.moveaxis(np.array([[g[0], g[1]], [g[1], g[2]]]), 2, 0)


def face_lengths(x, faces):
    """|e|, |a|, |a-e| and the area."""
    x0, x1, x2 = (x[faces[:, i]] for i in range(3))
    return np.stack([np.linalg.norm(x1 - x0, axis=1), np.linalg.norm(x2 - x0, axis=1), np.linalg.norm(x2 - x1, axis=1),
                     face_areas(x, faces)])


def rows_of(topology, kind, fields, fan_class=None):
    """Differences of vertex fields [..., n, 3] at the elements of a kind: [..., R, E]."""
    if kind == HINGE:
        ends, starts = topology.hinges[:, [1, 2, 3]], topology.hinges[:, [0, 0, 0]]
    elif kind == ARAP:
        cells = [v for v, (fan, closed) in enumerate(topology.fans) if (len(fan), closed) == fan_class]
        ends = np.array([topology.fans[v][0] for v in cells])
        starts = np.repeat(np.array(cells)[:, None], ends.shape[1], axis=1)
    else:
        ends, starts = topology.faces[:, [1, 2]], topology.faces[:, [0, 0]]
    difference = fields[..., ends, :] - fields[..., starts, :]  # [..., E, V, 3]
    return np.moveaxis(difference, -3, -1).reshape(*fields.shape[:-2], -1, len(ends))


# --------------------------------------------------------------------------------------------------------- hinges --

def rest_angles(topology, poses):
    """Unwrapped to lie within pi of pose 0's, and their centres."""
    angles = np.array([dihedral_angles(pose, topology.hinges) for pose in poses])
    angles -= 2 * np.pi * np.round((angles - angles[0]) / (2 * np.pi))
    return angles, (angles.min(axis=0) + angles.max(axis=0)) / 2


def bending_stiffness(topology, pose):
    edge = pose[topology.hinges[:, 1]] - pose[topology.hinges[:, 0]]
    return BENDING ** 2 * 3 * dot(edge, edge) / face_areas(pose, topology.faces)[topology.hinge_faces].sum(axis=1)


def wrapped(angle):
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))


def hinge_numbers(topology, poses, base):
    angles, centre = rest_angles(topology, poses)
    beta = np.array([bending_stiffness(topology, pose) for pose in poses])
    t0 = wrapped(dihedral_angles(base, topology.hinges) - centre)
    return np.stack([centre, t0]), np.stack([beta, beta * (angles - centre)], axis=1)


# ---------------------------------------------------------------------------------------------------------- faces --

def neo_hookean_numbers(topology, poses, base):
    g0 = metrics(base, topology.faces)
    det0 = g0[0] * g0[2] - g0[1] ** 2
    inverse0 = np.stack([g0[2], -g0[1], g0[0]]) / det0
    twice = np.array([1.0, 2.0, 1.0])[:, None]  # off-diagonal terms of a symmetric matrix count twice
    numbers = []
    for pose in poses:
        g, area = metrics(pose, topology.faces), face_areas(pose, topology.faces)
        det = g[0] * g[2] - g[1] ** 2
        inverse = np.stack([g[2], -g[1], g[0]]) / det
        cofactor0 = np.stack([g0[2], -g0[1], g0[0]])
        p, pd, pl = MU / 2 * area * inverse, area * LAMBDA / 4 / det, area * (MU / 2 + LAMBDA / 4)
        linear = (p + pd * cofactor0 - pl * inverse0) * twice
        numbers.append(np.concatenate([linear, [pd - pl / det0], [pl]]))
    return np.concatenate([inverse0, [1 / det0]]), np.array(numbers)


def stvk_numbers(topology, poses, base):
    g0 = matrices(metrics(base, topology.faces))
    units = np.array([[[1, 0], [0, 0]], [[0, 1], [1, 0]], [[0, 0], [0, 1]]], float)
    numbers = []
    for pose in poses:
        area, inverse = face_areas(pose, topology.faces), np.linalg.inv(matrices(metrics(pose, topology.faces)))
        strain0 = (inverse @ g0 - np.eye(2)) / 2
        trace = np.einsum("fij,aji->af", inverse, units)
        mixed = np.einsum("fij,fjk,aki->af", strain0, inverse, units)
        linear = area * (LAMBDA / 2 * np.trace(strain0, axis1=1, axis2=2) * trace + MU * mixed)
        product = np.einsum("fij,ajk,fkl,bli->abf", inverse, units, inverse, units)
        q = area * (LAMBDA / 4 * trace[:, None] * trace[None] + MU / 2 * product)
        numbers.append(np.concatenate([linear, [q[0, 0], q[0, 1], q[0, 2], q[1, 1], q[1, 2], q[2, 2]]]))
    return np.zeros((0, len(topology.faces))), np.array(numbers)


def edge_numbers(topology, poses, base):
    numbers = []
    for pose in poses:
        lengths, area = face_lengths(pose, topology.faces), face_areas(pose, topology.faces)
        # A face's share of each edge term is a third of its area; kL = kA = 1.
        share = np.stack([area / 3] * 3 + [area])
        numbers.append(np.stack([share / lengths ** 2, share / lengths], axis=1).reshape(8, -1))
    return face_lengths(base, topology.faces), np.array(numbers)


# ----------------------------------------------------------------------------------------------------------- ARAP --

def cell_edges(spokes, closed):
    """spokes [E, V, 3] to edges [E, N, 3]"""
    rims = np.roll(spokes, -1, axis=1) - spokes
    return np.concatenate([spokes, rims if closed else rims[:, :-1]], axis=1)


def half_cotangent(pose, c, a, b):
    """Of the angle at c."""
    u, v = pose[a] - pose[c], pose[b] - pose[c]
    return 0.5 * (u @ v) / math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def cotangent_weights(topology, pose):
    weights = {}
    for face in topology.faces:
        for i in range(3):
            a, b, c = face[i], face[(i + 1) % 3], face[(i + 2) % 3]
            cotangent = half_cotangent(pose, c, a, b)
            for key in ((a, b), (b, a)):
                weights[key] = weights.get(key, 0.0) + cotangent
    return weights


def cell_data(topology, pose, fan_class):
    """c [E, N] and edges [E, N, 3] of one pose for the cells of one class."""
    weights, rows = cotangent_weights(topology, pose), []
    for v, (fan, closed) in enumerate(topology.fans):
        if (len(fan), closed) == fan_class:
            rims = list(zip(fan, fan[1:] + fan[:1]))[:len(fan) if closed else len(fan) - 1]
            rows.append([weights[v, u] for u in fan] + [half_cotangent(pose, v, a, b) for a, b in rims])
    spokes = rows_of(topology, ARAP, pose, fan_class).reshape(fan_class[0], 3, -1).transpose(2, 0, 1)
    return np.array(rows), cell_edges(spokes, fan_class[1])


def best_rotation(moments):
    left, _, right = np.linalg.svd(moments)
    left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    return left @ right


def arap_numbers(topology, poses, base, fan_class):
    _, edges0 = cell_data(topology, base, fan_class)
    numbers = []
    for pose in poses:
        c, edges = cell_data(topology, pose, fan_class)
        p = c[:, :, None] * edges
        moments = np.einsum("eni,enj->eij", edges0, p)
        sigma0 = np.einsum("eij,eij->e", best_rotation(moments), moments)
        per_edge = np.concatenate([c[:, :, None], p], axis=2).reshape(len(c), -1)
        numbers.append(np.concatenate([per_edge.T, [sigma0]]))
    return np.zeros((0, len(edges0))), np.array(numbers)


# ----------------------------------------------------------------------------------------------------------- ties --

TIE_STIFFNESS = 0.7


def tie_vertices(topology):
    """Tied vertex and three anchors: nothing says that they must be of different parts."""
    return np.array([[face[0], *topology.faces[(f + 3) % len(topology.faces)]] for f, face in enumerate(topology.faces)])


def tie_frames(topology, poses):
    """f00, f01, f11 [3, E]: e1 = f00 (b - a), e2 = f01 (b - a) + f11 (c - a) are orthonormal in pose 0."""
    _, a, b, c = (poses[0][corner] for corner in tie_vertices(topology).T)
    first, second = b - a, c - a
    length = np.sqrt(dot(first, first))
    across = second - first * (dot(first, second) / dot(first, first))[:, None]
    height = np.sqrt(dot(across, across))
    return np.stack([1 / length, -dot(first, second) / dot(first, first) / height, 1 / height])


def tie_rows(topology, frames, fields):
    """r, e1, e2 of vertex fields [..., n, 3]: [..., 9, E]."""
    x, a, b, c = (fields[..., corner, :] for corner in tie_vertices(topology).T)
    f00, f01, f11 = frames[:, :, None]
    rows = np.stack([x - a, f00 * (b - a), f01 * (b - a) + f11 * (c - a)], axis=-3)  # [..., 3, E, 3]
    return np.moveaxis(rows, -1, -2).reshape(*rows.shape[:-3], 9, -1)


def tie_places(topology, frames, x):
    r, e1, e2 = np.moveaxis(tie_rows(topology, frames, x).reshape(3, 3, -1), 1, -1)
    return np.stack([dot(r, e1), dot(r, e2), dot(r, np.cross(e1, e2))])


def tie_numbers(topology, poses, base):
    frames, stiffness = tie_frames(topology, poses), np.full((1, len(topology.faces)), TIE_STIFFNESS)
    start = tie_places(topology, frames, base)
    numbers = [np.concatenate([stiffness, 2 * TIE_STIFFNESS * (start - tie_places(topology, frames, pose))])
               for pose in poses]
    return np.zeros((0, len(topology.faces))), np.array(numbers)


def tie_energy(topology, poses, pose, y):
    frames = tie_frames(topology, poses)
    return TIE_STIFFNESS * ((tie_places(topology, frames, y) - tie_places(topology, frames, pose)) ** 2).sum()


# -------------------------------------------------------------------------------------------------------- material --

def fan_classes(topology):
    return sorted({(len(fan), closed) for fan, closed in topology.fans})


def make_batches(topology, poses, material, base, directions):
    """The surrogate energy of a material: all elements, weight 1, relative to the shape `base`;
    z runs along `directions`."""
    fields = np.concatenate([base[None], directions])
    batches = []
    if material != "arap":
        batches.append(Batch(HINGE, 0, False, rows_of(topology, HINGE, fields), *hinge_numbers(topology, poses, base)))
    for name, kind, numbers in (("neo-hookean", NEO_HOOKEAN, neo_hookean_numbers), ("stvk", STVK, stvk_numbers),
                                ("edge", EDGE, edge_numbers)):
        if material in (name, "mixed"):
            batches.append(Batch(kind, 0, False, rows_of(topology, kind, fields), *numbers(topology, poses, base)))
    if material in ("arap", "mixed"):
        batches += [Batch(ARAP, fan_class[0], fan_class[1], rows_of(topology, ARAP, fields, fan_class),
                          *arap_numbers(topology, poses, base, fan_class)) for fan_class in fan_classes(topology)]
    if material == "tied":
        batches += make_batches(topology, poses, "neo-hookean", base, directions)[1:]
        batches.append(Batch(TIE, 0, False, tie_rows(topology, tie_frames(topology, poses), fields),
                             *tie_numbers(topology, poses, base)))
    return batches


def absolute_energy(topology, poses, material, weights, y):
    """sum_k w_k W_k(y), constants included, straight from the definitions. Material "mixed" is the sum of all."""
    total = 0.0
    for weight, pose in zip(weights, poses):
        if material != "arap":
            total += weight * bending_energy(topology, poses, pose, y)
        for name in ("neo-hookean", "stvk", "edge"):
            if material in (name, "mixed"):
                total += weight * membrane_energy(topology, pose, name, y)
        if material in ("arap", "mixed"):
            total += weight * arap_energy(topology, pose, y)
        if material == "tied":
            total += weight * (membrane_energy(topology, pose, "neo-hookean", y) + tie_energy(topology, poses, pose, y))
    return total


def bending_energy(topology, poses, pose, y):
    _, centre = rest_angles(topology, poses)
    angle, rest = (wrapped(dihedral_angles(x, topology.hinges) - centre) for x in (y, pose))
    return (bending_stiffness(topology, pose) * (angle - rest) ** 2).sum()


def membrane_energy(topology, pose, material, y):
    area = face_areas(pose, topology.faces)
    if material == "edge":
        strain = face_lengths(y, topology.faces) / face_lengths(pose, topology.faces) - 1
        return (np.stack([area / 3] * 3 + [area]) * strain ** 2).sum()
    c = np.linalg.inv(matrices(metrics(pose, topology.faces))) @ matrices(metrics(y, topology.faces))
    trace, det = np.trace(c, axis1=1, axis2=2), np.linalg.det(c)
    if material == "neo-hookean":
        density = MU / 2 * trace + LAMBDA / 4 * det - (MU / 2 + LAMBDA / 4) * np.log(det) - MU - LAMBDA / 4
    else:
        strain = (c - np.eye(2)) / 2
        density = LAMBDA / 2 * np.trace(strain, axis1=1, axis2=2) ** 2 + MU * np.trace(strain @ strain, axis1=1, axis2=2)
    return (area * density).sum()


def arap_energy(topology, pose, y):
    total = 0.0
    for fan_class in fan_classes(topology):
        c, rest = cell_data(topology, pose, fan_class)
        _, edges = cell_data(topology, y, fan_class)
        rotation = best_rotation(np.einsum("en,eni,enj->eij", c, edges, rest))
        total += (c * ((edges - np.einsum("eij,enj->eni", rotation, rest)) ** 2).sum(axis=2)).sum()
    return total
