"""What format 1.2 added to the reference: elements of tetrahedra (kinds 6 and 7 of SPEC.md) and the quartic polynomial of
QUAR. The elements are the plain formulas, value minus value at z = 0, where the C runtime avoids the cancellation."""
import itertools

import numpy as np


def symmetric(six):
    """[6, E] in the order 11, 12, 13, 22, 23, 33 to [E, 3, 3]."""
    return np.moveaxis(np.array([six[[0, 1, 2]], six[[1, 3, 4]], six[[2, 4, 5]]]), 2, 0)


def gradients_of(differences):
    """Rows [9, E], r = 3i + c being coordinate c of column i, to F [E, 3, 3]."""
    return differences.reshape(3, 3, -1).transpose(2, 1, 0)


def rows_of(force):
    """[E, 3, 3] back to rows."""
    return force.transpose(2, 1, 0).reshape(9, -1)


def contract(a, b):
    return np.einsum("eij,eij->e", a, b)


def transpose(a):
    return a.transpose(0, 2, 1)


def cofactor(a):
    """Also of singular matrices: columns are cross products of columns."""
    x, y, z = np.moveaxis(a, 2, 0)
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=2)


def polarised_cofactor(a, b):
    """cof(a + b) - cof(a) - cof(b)"""
    return cofactor(a + b) - cofactor(a) - cofactor(b)


def trace(a):
    return np.trace(a, axis1=1, axis2=2)[:, None, None]


def evaluate_tet_stvk(numbers, differences):
    f = gradients_of(differences)
    metric = transpose(f) @ f - np.eye(3)
    g = metric[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]].T
    linear, matrix = numbers[:6], np.zeros((6, 6, f.shape[0]))
    for number, (a, b) in zip(numbers[6:], itertools.combinations_with_replacement(range(6), 2)):
        matrix[a, b] = matrix[b, a] = number
    product = np.einsum("abe,be->ae", matrix, g)
    slope = linear + product
    slope[[1, 2, 4]] /= 2  # beside the diagonal: once in the vector, twice in the matrix
    return (linear * g + g * product / 2).sum(), rows_of(2 * f @ symmetric(slope))


def evaluate_tet_mooney_rivlin(numbers, differences):
    f, one = gradients_of(differences), np.eye(3)
    stored, a, b = (symmetric(numbers[i:i + 6]) for i in (0, 6, 12))
    square, centred = numbers[18], numbers[19]  # C, c
    s = np.linalg.det(f)
    if (s <= 0).any():
        return np.inf, None
    metric = transpose(f) @ f
    # L is redundant but for its rounding, which is added: at z = 0 it is all of the slope.
    linear = a + (2 / 3 * -trace(b) - trace(a) / 3 + trace(b) + centred[:, None, None]) * one - b
    a_metric, b_cofactor = contract(a, metric), contract(b, cofactor(metric))
    value = (s ** (-2 / 3) * a_metric + s ** (-4 / 3) * b_cofactor + square * s ** 2 - 2 * (square - centred) * s
             - trace(a + b)[:, 0, 0] - square + 2 * (square - centred) + contract(stored - linear, metric - one))
    slope = -2 / 3 * s ** (-5 / 3) * a_metric - 4 / 3 * s ** (-7 / 3) * b_cofactor + 2 * square * s - 2 * (square - centred)
    by_metric = (s[:, None, None] ** (-2 / 3) * a + s[:, None, None] ** (-4 / 3) * polarised_cofactor(b, metric)
                 + stored - linear)
    return value.sum(), rows_of(2 * f @ by_metric + slope[:, None, None] * cofactor(f))


# ------------------------------------------------------------------------------------------------------------ quartic --

LANES = 8


class Layout:
    """Where the coefficients of a table of QUAR are."""

    def __init__(self, dimension):
        size = dimension + 1
        pairs = np.array(list(itertools.combinations_with_replacement(range(size), 2)))
        end = -(-len(pairs) // LANES) * LANES
        places, indices, at = [], [], 0
        for j in range(size):
            tail = pairs[pairs[:, 0] >= j]
            start = len(pairs) - len(tail)
            for i in range(j + 1):
                places.append(at + start % LANES + np.arange(len(tail)))
                indices.append(np.column_stack([np.tile([i, j], (len(tail), 1)), tail]))
                at += end - start // LANES * LANES
        self.count = at  # T
        self.padded_count = -(-at // 16) * 16
        self.places, self.indices = np.concatenate(places), np.concatenate(indices)


class Quartic:
    """The polynomial: indices [n, 4] of the factors of every monomial, coefficients [m, n]."""

    def __init__(self, indices, coefficients):
        self.indices, self.coefficients = indices, coefficients

    def evaluate(self, z, weights):
        factors = np.concatenate([[1.0], z])[self.indices].T
        c = weights @ self.coefficients
        gradient = np.zeros(len(z) + 1)
        for place, others in enumerate(([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2])):
            slopes = c * factors[others].prod(axis=0)
            gradient += np.bincount(self.indices[:, place], slopes, len(gradient))
        return c @ factors.prod(axis=0), gradient[1:]
