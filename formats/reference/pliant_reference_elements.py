"""Elements of shells for the reference: hinges, faces, ARAP cells and ties, kinds 1 to 5 and 8 of SPEC.md.

Each function evaluate_... takes differences [R, E] and returns the energy of the whole batch and its derivatives by the
differences, [R, E]."""
import numpy as np


def vectors_of(rows):
    return rows.reshape(-1, 3, rows.shape[1])


def dot(a, b):
    return (a * b).sum(axis=0)


def cross(a, b):
    # np.cross takes twice as long for so few columns
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def combined(batch, weights):
    return np.tensordot(weights, batch.poses, 1)


def wrapped(angle):
    return angle - 2 * np.pi * np.round(angle / (2 * np.pi))


def measure_angles(differences):
    """Dihedral angles and their derivatives by the differences."""
    e, a, b = vectors_of(differences)
    n1, n2, length = cross(e, a), cross(b, e), np.sqrt(dot(e, e))
    theta = np.arctan2(dot(e, cross(n1, n2)) / length, dot(n1, n2))
    # The opposite vertices move the angle by length / |N|^2 along the normals; the edge's end takes the share that its
    # position along the edge demands, as a rotation of the whole leaves the angle alone.
    u1, u2 = n1 * (length / dot(n1, n1)), n2 * (length / dot(n2, n2))
    along1, along2 = dot(a, e) / dot(e, e), dot(b, e) / dot(e, e)
    return theta, np.stack([along1 * u1 + along2 * u2, -u1, -u2]).reshape(9, -1)


def evaluate_hinges(batch, differences, weights):
    centre, t0 = batch.fixed
    beta, gamma = combined(batch, weights)
    theta, slope = measure_angles(differences)
    t = wrapped(theta - centre)
    return ((t - t0) * (beta * (t + t0) - 2 * gamma)).sum(), 2 * (beta * t - gamma) * slope


def face_metric(batch, differences):
    """e, a and the change of the metric since z = 0."""
    e, a = vectors_of(differences)
    e0, a0 = vectors_of(batch.rows[0])
    de, da = e - e0, a - a0
    return e, a, dot(e + e0, de), dot(de, a) + dot(e0, da), dot(a + a0, da)


def face_force(e, a, f11, f12, f22):
    return np.stack([2 * f11 * e + f12 * a, f12 * e + 2 * f22 * a]).reshape(6, -1)


def evaluate_neo_hookean(batch, differences, weights):
    e, a, g11, g12, g22 = face_metric(batch, differences)
    i11, i12, i22, r = batch.fixed
    l11, l12, l22, area, barrier = combined(batch, weights)
    det = g11 * g22 - g12 ** 2
    u = i11 * g11 + 2 * i12 * g12 + i22 * g22 + r * det
    if (u <= -1).any():
        return np.inf, None
    energy = (l11 * g11 + l12 * g12 + l22 * g22 + area * det - barrier * (np.log1p(u) - u)).sum()
    fu = barrier * (1 - 1 / (1 + u))
    f11 = l11 + area * g22 + fu * (i11 + r * g22)
    f12 = l12 - 2 * area * g12 + fu * (2 * i12 - 2 * r * g12)
    f22 = l22 + area * g11 + fu * (i22 + r * g11)
    return energy, face_force(e, a, f11, f12, f22)


def evaluate_stvk(batch, differences, weights):
    e, a, *g = face_metric(batch, differences)
    g, c = np.array(g), combined(batch, weights)
    linear, matrix = c[:3], c[[[3, 4, 5], [4, 6, 7], [5, 7, 8]]]
    product = (matrix * g).sum(axis=1)
    return (linear * g + g * product / 2).sum(), face_force(e, a, *(linear + product))


def evaluate_edge(batch, differences, weights):
    e, a = vectors_of(differences)
    normal = cross(e, a)
    lengths = np.sqrt(np.stack([dot(e, e), dot(a, a), dot(a - e, a - e), dot(normal, normal) / 4]))
    c, b = combined(batch, weights).reshape(4, 2, -1).transpose(1, 0, 2)
    energy = ((lengths - batch.fixed) * (c * (lengths + batch.fixed) - 2 * b)).sum()
    slope = 2 * (c * lengths - b)
    f1, f2, f3 = slope[0] * e / lengths[0], slope[1] * a / lengths[1], slope[2] * (a - e) / lengths[2]
    unit = slope[3] * normal / (4 * lengths[3])  # d area = n . d(e x a) / (2 |e x a|)
    return energy, np.stack([f1 - f3 + cross(a, unit), f2 + f3 - cross(e, unit)]).reshape(6, -1)


def edges_of(batch, rows):
    """Spokes and rims of ARAP cells, [N, 3, E]."""
    spokes = vectors_of(rows)
    rims = np.roll(spokes, -1, axis=0) - spokes
    return np.concatenate([spokes, rims if batch.is_closed else rims[:-1]])


def best_rotations(edges, p):
    """R that is the best for M = sum of edge p^T, and sigma(M), of every cell."""
    left, values, right = np.linalg.svd(np.einsum("nie,nje->eij", edges, p))
    sign = np.sign(np.linalg.det(left @ right))
    left[:, :, 2] *= sign[:, None]
    return left @ right, values[:, 0] + values[:, 1] + sign * values[:, 2]


def force_of_edges(batch, edge_force):
    force = edge_force[:batch.valence].copy()
    for i, rim in enumerate(edge_force[batch.valence:]):
        force[(i + 1) % batch.valence] += rim
        force[i] -= rim
    return force.reshape(3 * batch.valence, -1)


def evaluate_arap(batch, differences, weights):
    edges, edges0 = edges_of(batch, differences), edges_of(batch, batch.rows[0])
    growth = (edges ** 2 - edges0 ** 2).sum(axis=1)
    energy, edge_force = 0.0, np.zeros_like(edges)
    for weight, numbers in zip(weights, batch.poses):
        per_edge, sigma0 = numbers[:-1].reshape(len(edges), 4, -1), numbers[-1]
        c, p = per_edge[:, 0], per_edge[:, 1:]
        rotation, sigma = best_rotations(edges, p)
        energy += weight * ((c * growth).sum() - 2 * (sigma - sigma0).sum())
        edge_force += weight * 2 * (c[:, None] * edges - np.einsum("eij,nje->nie", rotation, p))
    return energy, force_of_edges(batch, edge_force)


def evaluate_tie(batch, differences, weights):
    def place(rows):
        r, e1, e2 = vectors_of(rows)
        return np.stack([dot(r, e1), dot(r, e2), dot(r, cross(e1, e2))])

    r, e1, e2 = vectors_of(differences)
    kappa, pull = np.split(combined(batch, weights), [1])
    moved = place(differences) - place(batch.rows[0])
    f1, f2, f3 = 2 * kappa * moved + pull
    force = np.stack([f1 * e1 + f2 * e2 + f3 * cross(e1, e2), f1 * r + f3 * cross(e2, r), f2 * r + f3 * cross(r, e1)])
    return (moved * (kappa * moved + pull)).sum(), force.reshape(9, -1)
