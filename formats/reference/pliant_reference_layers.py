"""What format 1.5 added to the reference: layers. LAYR, the changes of ELEM, and the elements of kinds 9 to 11.

The elements are the energies that SPEC.md means, value minus value at z = 0, for the rest state that the layers give; the C
runtime makes the numbers of kinds 1, 2 and 5 from that instead."""
import numpy as np

from pliant_reference_elements import (best_rotations, combined, edges_of, force_of_edges, measure_angles, vectors_of,
                                       wrapped)

MAX_LAYERS = 64


def read_ranges(data, count, require):
    """LAYR: low, high and initial weight of each layer."""
    require(len(data) == 64 + 16 * count, "R09", "size of LAYR")
    records = np.frombuffer(data, "<f4", offset=64).reshape(count, 4)
    ranges = records[:, :3].astype(float)
    require(np.isfinite(ranges).all(), "R10", "LAYR")
    require(not records[:, 3].tobytes().strip(b"\0"), "R14", "reserved word of a layer")
    low, high, initial = ranges.T
    require((low < high).all() and (low <= 0).all() and (high >= 0).all(), "R23", "range of a layer")
    require((low <= initial).all() and (initial <= high).all(), "R23", "initial weight of a layer")
    return ranges


def read_changes(data, data_start, at, count, shape, require):
    """The changes that layers make, [m-1, K, P]: zero where nothing is stored."""
    layer_count, number_count, lanes = shape
    changes = np.zeros(shape)
    require(at % 64 == 0 and at >= data_start, "R24", "offset of the changes")
    end = at + 8 * count
    floats_at = (end + 63) // 64 * 64
    floats = count * number_count * 16
    require(floats_at + 4 * floats <= len(data), "R24", "changes past the chunk")
    records = np.frombuffer(data, "<u4", 2 * count, at).reshape(count, 2).astype(np.int64)
    require((records < [layer_count, lanes // 16]).all(), "R24", "a layer or group that does not exist")
    require((np.diff(records @ [lanes // 16, 1]) > 0).all(), "R24", "changes out of order")
    require(not any(data[end:floats_at]), "R24", "bytes behind the records")
    values = np.frombuffer(data, "<f4", floats, floats_at).reshape(count, number_count, 16)
    require(np.isfinite(values).all(), "R24", "a change that is not finite")
    for (layer, group), value in zip(records, values):
        changes[layer, :, 16 * group:16 * group + 16] = value
    return changes


# ----------------------------------------------------------------------------------------------------------- elements --

def evaluate_layered_hinges(batch, differences, weights):
    theta0, beta = batch.fixed
    rest = combined(batch, weights)[0]
    theta, slope = measure_angles(differences)
    t = wrapped(theta - rest)
    return (beta * (t ** 2 - wrapped(theta0 - rest) ** 2)).sum(), 2 * beta * t * slope


def matrix(m11, m12, m21, m22):
    return np.moveaxis(np.array([[m11, m12], [m21, m22]]), 2, 0)


def exponential(s):
    """Of symmetric matrices [E, 2, 2], with the limits of the SPEC, by eigenvalues."""
    values, vectors = np.linalg.eigh(s)
    h = np.clip(values.mean(axis=1), -16, 8)
    k = np.minimum((values[:, 1] - values[:, 0]) / 2, np.minimum(6, 12 - h))
    values = np.exp(np.stack([h - k, h + k], axis=1))
    return (vectors * values[:, None]) @ vectors.transpose(0, 2, 1), np.exp(h)


def evaluate_layered_neo_hookean(batch, differences, weights):
    """a tr C + b det C - (a + b) log det C with C = G^-1 (metric of the shape), G = D^T exp(S) D, in the area of G."""
    i11, i12, i22, r, e11, e12, e22, a, b = batch.fixed
    s11, s12, s22 = combined(batch, weights)
    stretch, area = exponential(matrix(s11, s12, s12, s22))
    d = np.linalg.inv(matrix(e11, e12, 0 * e11, e22))
    rest = np.linalg.inv(d.transpose(0, 2, 1) @ stretch @ d)
    shape, start = (vectors_of(rows).transpose(2, 1, 0) for rows in (differences, batch.rows[0]))  # [E, 3, 2]
    metric, metric0 = shape.transpose(0, 2, 1) @ shape, start.transpose(0, 2, 1) @ start
    # Of z = 0 the file has its own numbers, rounded: with them the energy is that of the numbers that a reader makes.
    inverse0, growth = matrix(i11, i12, i12, i22), metric - metric0
    det = np.linalg.det(growth)
    trace = np.trace(inverse0 @ growth, axis1=1, axis2=2)
    u = trace + r * det
    if (u <= -1).any():
        return np.inf, None
    by_trace = b * np.linalg.det(rest) / r
    by_det = np.maximum(by_trace, 2.4e-7 * (a + b))  # the SPEC's limit of B
    cofactor = growth[:, ::-1, ::-1] * [[1, -1], [-1, 1]]
    change = a * np.trace(rest @ growth, axis1=1, axis2=2) + by_trace * trace + by_det * r * det - (a + b) * np.log1p(u)
    by_metric = sum((area * factor)[:, None, None] * part for factor, part in (
        (a, rest), (by_trace - (a + b) / (1 + u), inverse0), (r * (by_det - (a + b) / (1 + u)), cofactor)))
    return (area * change).sum(), (2 * shape @ by_metric).transpose(2, 1, 0).reshape(6, -1)


def evaluate_layered_arap(batch, differences, weights):
    edges, edges0, c = edges_of(batch, differences), edges_of(batch, batch.rows[0]), batch.fixed
    p = combined(batch, weights).reshape(len(edges), 3, -1)
    rotation, sigma = best_rotations(edges, p)
    energy = (c * (edges ** 2 - edges0 ** 2).sum(axis=1)).sum() - 2 * (sigma - best_rotations(edges0, p)[1]).sum()
    return energy, force_of_edges(batch, 2 * (c[:, None] * edges - np.einsum("eij,nje->nie", rotation, p)))
