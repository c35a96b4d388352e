"""Element numbers of a whole tiny solid, from the energies themselves (StVK and Mooney-Rivlin on linear tetrahedra), for
tests only. The counterpart of tiny_elements.py, and written twice like it: absolute_energy() as a textbook has it, and the
batches as SPEC.md section 4 wants them."""
import itertools

import numpy as np

import pliant_reference_path  # noqa: F401
from pliant_reference import TET_MOONEY_RIVLIN, TET_STVK, Batch
from pliant_reference_solid import Layout, Quartic, gradients_of

MU = LAMBDA = 1.0
MU_1, MU_2, BULK = 0.7, 0.3, 2.0
SIX = list(itertools.combinations_with_replacement(range(3), 2))


def edge_matrices(x, tets):
    """[..., n, 3] to [..., E, 3, 3], columns x1-x0, x2-x0, x3-x0."""
    return np.moveaxis(x[..., tets[:, 1:], :] - x[..., tets[:, :1], :], -2, -1)


def volumes(x, tets):
    return np.linalg.det(edge_matrices(x, tets)) / 6


def cofactors(a):
    return np.linalg.det(a)[:, None, None] * np.linalg.inv(a).transpose(0, 2, 1)


def transpose(a):
    return a.transpose(0, 2, 1)


def trace(a):
    return np.trace(a, axis1=-2, axis2=-1)


def six_of(a):
    """Entries 11, 12, 13, 22, 23, 33 of [E, 3, 3]."""
    return np.array([a[:, i, j] for i, j in SIX])


def rows_of(tets, base, directions):
    """Deformation gradients relative to the shape `base`: the identity, and what each direction adds."""
    inverse = np.linalg.inv(edge_matrices(base, tets))
    fields = edge_matrices(directions, tets) @ inverse
    fields = np.concatenate([np.tile(np.eye(3), (1, len(tets), 1, 1)), fields])
    return fields.transpose(0, 3, 2, 1).reshape(len(fields), 9, -1)


def stvk_numbers(tets, poses, base):
    units = np.zeros((6, 3, 3))
    for a, (i, j) in enumerate(SIX):
        units[a, i, j] = units[a, j, i] = 1
    numbers = []
    for pose in poses:
        h, volume = edge_matrices(base, tets) @ np.linalg.inv(edge_matrices(pose, tets)), volumes(pose, tets)
        strain = (transpose(h) @ h - np.eye(3)) / 2
        unit = np.einsum("eki,akl,elj->aeij", h, units, h) / 2  # the strain of a unit of metric
        linear = volume * (LAMBDA * trace(strain) * trace(unit) + 2 * MU * np.einsum("eij,aeij->ae", strain, unit))
        q = volume * (LAMBDA * trace(unit)[:, None] * trace(unit) + 2 * MU * np.einsum("aeij,beij->abe", unit, unit))
        numbers.append(np.concatenate([linear, [q[a, b] for a in range(6) for b in range(a, 6)]]))
    return np.array(numbers)


def mooney_rivlin_numbers(tets, poses, base):
    numbers = []
    for pose in poses:
        h, volume = edge_matrices(base, tets) @ np.linalg.inv(edge_matrices(pose, tets)), volumes(pose, tets)
        det, cofactor = np.linalg.det(h), cofactors(h)
        a = (volume * MU_1 * det ** (-2 / 3))[:, None, None] * (h @ transpose(h))
        b = (volume * MU_2 * det ** (-4 / 3))[:, None, None] * (cofactor @ transpose(cofactor))
        square = volume * BULK * det ** 2
        centred = square - volume * BULK * det
        linear = a - b + (trace(b) / 3 - trace(a) / 3 + centred)[:, None, None] * np.eye(3)
        numbers.append(np.concatenate([six_of(linear), six_of(a), six_of(b), [square, centred]]))
    return np.array(numbers)


def make_batches(tets, poses, material, base, directions):
    """The surrogate energy of a material: all tetrahedra, weight 1, relative to the shape `base`;
    z runs along `directions`."""
    batches, rows = [], rows_of(tets, base, directions)
    for name, kind, numbers in (("tet-stvk", TET_STVK, stvk_numbers),
                                ("mooney-rivlin", TET_MOONEY_RIVLIN, mooney_rivlin_numbers)):
        if material in (name, "tet-mixed"):
            batches.append(Batch(kind, 0, False, rows, np.zeros((0, len(tets))), numbers(tets, poses, base)))
    return batches


def absolute_energy(tets, poses, material, weights, y):
    """sum_k w_k W_k(y), constants included, straight from the definitions. Material "tet-mixed" is the sum of both."""
    total = 0.0
    for weight, pose in zip(weights, poses):
        f = edge_matrices(y, tets) @ np.linalg.inv(edge_matrices(pose, tets))
        c, det = transpose(f) @ f, np.linalg.det(f)
        density = np.zeros(len(tets))
        if material in ("tet-stvk", "tet-mixed"):
            strain = (c - np.eye(3)) / 2
            density += LAMBDA / 2 * trace(strain) ** 2 + MU * trace(strain @ strain)
        if material in ("mooney-rivlin", "tet-mixed"):
            first, second = trace(c), (trace(c) ** 2 - trace(c @ c)) / 2
            density += MU_1 * (det ** (-2 / 3) * first - 3) + MU_2 * (det ** (-4 / 3) * second - 3) + BULK * (det - 1) ** 2
        total += weight * (volumes(pose, tets) * density).sum()
    return total


def quartic_of(batch, dimension):
    """StVK elements multiplied out: exact, as the metric is quadratic in z."""
    gradients = np.array([gradients_of(rows) for rows in batch.rows])  # [N, E, 3, 3]
    products = np.einsum("ieck,jecl->ijekl", gradients, gradients)
    first, second = np.array(list(itertools.combinations_with_replacement(range(dimension + 1), 2))).T
    metric = products[first, second] + np.where(first == second, 0, 1)[:, None, None, None] * products[second, first]
    metric = np.array([metric[..., k, l] for k, l in SIX])  # [6, pairs, E]
    metric[:, 0] = 0  # minus the one at z = 0
    four = np.stack(np.broadcast_arrays(first[:, None], second[:, None], first, second), axis=-1).reshape(-1, 4)
    places = np.ravel_multi_index(np.sort(four, axis=1).T, (dimension + 1,) * 4)
    indices = Layout(dimension).indices
    wanted = np.ravel_multi_index(indices.T, (dimension + 1,) * 4)
    coefficients = []
    for numbers in batch.poses:
        q = np.zeros((6, 6, numbers.shape[1]))
        for number, (a, b) in zip(numbers[6:], itertools.combinations_with_replacement(range(6), 2)):
            q[a, b] = q[b, a] = number
        square = np.einsum("ape,abe,bqe->pq", metric, q, metric, optimize=True) / 2
        square[0] += np.einsum("ae,ape->p", numbers[:6], metric)
        sums = np.bincount(places, square.ravel(), minlength=(dimension + 1) ** 4)
        coefficients.append(sums[wanted])
    return Quartic(indices, np.array(coefficients))


# ---------------------------------------------------------------------------------------------------------- the mesh --

def boundary_of(tets):
    """Triangles of only one tetrahedron, counter-clockwise seen from outside if the tetrahedra are positive."""
    seen = {}
    for tet in tets:
        for face in ([1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]):
            corners = tet[face]
            key = tuple(sorted(corners))
            seen[key] = None if key in seen else corners
    return np.array([face for face in seen.values() if face is not None])


def beam(columns, rows):
    """A box of cubes of six tetrahedra each. Vertices, tetrahedra and the number that each vertex had before those of the
    boundary went first."""
    sizes = (columns, rows, rows)
    grid = np.arange(columns * rows * rows).reshape(sizes)
    x = np.stack(np.meshgrid(np.linspace(0, 3, columns), np.linspace(-0.4, 0.4, rows), np.linspace(-0.3, 0.3, rows),
                             indexing="ij"), axis=-1).reshape(-1, 3)
    tets = []
    for corner in itertools.product(*(range(size - 1) for size in sizes)):
        for order in itertools.permutations(range(3)):
            path = [np.array(corner)]
            for axis in order:
                path.append(path[-1] + np.eye(3, dtype=int)[axis])
            tet = [grid[tuple(p)] for p in path]
            even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            tets.append(tet if even else [tet[0], tet[2], tet[1], tet[3]])
    tets = np.array(tets)
    if not (volumes(x, tets) > 0).all():
        raise AssertionError("a tetrahedron of the beam is turned inside out")
    outside = np.unique(boundary_of(tets))
    source = np.concatenate([outside, np.setdiff1d(np.arange(len(x)), outside)])
    return x[source], np.argsort(source)[tets], source, len(outside)
