"""Element numbers of layers, kinds 8 to 11 of SPEC.md, of a whole tiny mesh: x[0] is the rest shape, x[1:] are the layers.

As in tiny_elements.py every energy is written twice, here with the rest state of given weights w = (1, v): rest angles,
logarithms of metrics, edge vectors and places of ties add up. At v = a unit vector the rest state is that of a pose,
so the blend is the pose.
"""
import numpy as np

import tiny_elements as shells
import tiny_mesh
from pliant_reference import LAYERED_ARAP, LAYERED_HINGE, LAYERED_NEO_HOOKEAN, TIE, Batch
from tiny_elements import ARAP, HINGE, LAMBDA, MU, NEO_HOOKEAN

DEFORMATIONS = [(0.5, 0, 0, 0), (0, 0.4, 0.05, 0), (-0.4, 0.2, 0, 0.1)]
FREE = 3  # this many layers are deformations of their own, further ones mixtures of them


def make_poses(rest, count, random):
    """Rest shape and layers, each of which deforms one end of it only: changes of the others are sparse."""
    whole = tiny_mesh.make_poses(rest, 5, random)[0]
    length, poses = rest[:, 0].max(), [whole]
    for k in range(min(count - 1, FREE)):
        flip = np.array([-1 if k % 2 else 1, 1, -1 if k % 2 else 1])  # a turn: orientation stays
        start = np.array([length * (0.4 + 0.1 * k) * (1 if k % 2 == 0 else -1), 0, 0])
        turned = rest * flip - start
        bent = tiny_mesh.deform(np.maximum(turned, [0, -9, -9]), *DEFORMATIONS[k])
        poses.append(np.where(turned[:, :1] > 0, (bent + start) * flip, rest))
    for _ in range(count - len(poses)):
        mixture = random.uniform(-0.3, 0.3, FREE)
        poses.append(rest + np.tensordot(mixture, np.array(poses[1:1 + FREE]) - rest, 1))
    return np.array(poses)


def ranges(layer_count):
    """low, high, initial weight"""
    return np.array([[(-1.0, 1.0, 0.0), (0.0, 1.5, 0.25), (-0.5, 2.0, -0.25)][k % 3] for k in range(layer_count)])


def sample_weights(pose_count):
    """w = (1, v): the rest shape, every layer, opposites, pairs."""
    unit = np.eye(pose_count - 1)
    pairs = [0.5 * (unit[i] + unit[j]) for i in range(len(unit)) for j in range(i)] if len(unit) <= 5 else []
    v = np.array([0 * unit[0], *unit, *(-0.5 * unit[:FREE]), *pairs])
    return np.column_stack([np.ones(len(v)), v])


def random_weights(pose_count, random):
    return np.concatenate([[1.0], random.uniform(-0.5, 1.0, pose_count - 1) * (random.random(pose_count - 1) < 0.8)])


# ------------------------------------------------------------------------------------------------------- rest states --

def angles(topology, x):
    """Rest angles of the rest shape, and what layers add to them."""
    found = np.array([shells.dihedral_angles(pose, topology.hinges) for pose in x])
    found[1:] = shells.wrapped(found[1:] - found[0])
    return found


def logarithm(s):
    values, vectors = np.linalg.eigh(s)
    return (vectors * np.log(values)[:, None]) @ vectors.transpose(0, 2, 1)


def exponential(s):
    values, vectors = np.linalg.eigh(s)
    return (vectors * np.exp(values)[:, None]) @ vectors.transpose(0, 2, 1)


def stretches(topology, x):
    """D of the rest shape [E, 2, 2], S of each layer [m-1, E, 2, 2]."""
    g = [shells.matrices(shells.metrics(pose, topology.faces)) for pose in x]
    d = np.linalg.cholesky(g[0]).transpose(0, 2, 1)
    e = np.linalg.inv(d)
    return d, np.array([logarithm(e.transpose(0, 2, 1) @ metric @ e) for metric in g[1:]])


def cell_edges(topology, x, fan_class):
    """c [E, N] and rest edges of all poses [m, E, N, 3], layers as differences. Each cell of a layer is turned back as far
    as it goes: without that the rest edges would add up to those of the linear sum, where no cell has any energy."""
    c, rest = shells.cell_data(topology, x[0], fan_class)
    edges = np.array([shells.cell_data(topology, pose, fan_class)[1] for pose in x])
    for turned in edges[1:]:
        rotation = shells.best_rotation(np.einsum("en,eni,enj->eij", c, turned, rest))
        turned[:] = np.einsum("eij,eni->enj", rotation, turned) - rest
    return c, edges


def places(topology, x):
    frames = shells.tie_frames(topology, x)
    found = np.array([shells.tie_places(topology, frames, pose) for pose in x])
    found[1:] -= found[0]
    return found


# ----------------------------------------------------------------------------------------------------------- batches --

def hinge_batch(topology, x, base, fields):
    fixed = np.stack([shells.dihedral_angles(base, topology.hinges), shells.bending_stiffness(topology, x[0])])
    return Batch(LAYERED_HINGE, 0, False, shells.rows_of(topology, HINGE, fields), fixed, angles(topology, x)[:, None])


def face_batch(topology, x, base, fields):
    g0 = shells.metrics(base, topology.faces)
    det0 = g0[0] * g0[2] - g0[1] ** 2
    d, s = stretches(topology, x)
    e, area = np.linalg.inv(d), shells.face_areas(x[0], topology.faces)
    fixed = np.stack([g0[2] / det0, -g0[1] / det0, g0[0] / det0, 1 / det0, e[:, 0, 0], e[:, 0, 1], e[:, 1, 1],
                      area * MU / 2, area * LAMBDA / 4])
    numbers = np.stack([s[:, :, 0, 0], s[:, :, 0, 1], s[:, :, 1, 1]], axis=1)
    numbers = np.concatenate([np.zeros_like(numbers[:1]), numbers])
    return Batch(LAYERED_NEO_HOOKEAN, 0, False, shells.rows_of(topology, NEO_HOOKEAN, fields), fixed, numbers)


def arap_batch(topology, x, fields, fan_class):
    c, edges = cell_edges(topology, x, fan_class)
    p = c[:, :, None] * edges
    numbers = p.reshape(*p.shape[:2], -1).transpose(0, 2, 1)
    return Batch(LAYERED_ARAP, fan_class[0], fan_class[1], shells.rows_of(topology, ARAP, fields, fan_class), c.T, numbers)


def tie_batch(topology, x, base, fields):
    _, numbers = shells.tie_numbers(topology, x, base)
    numbers = np.concatenate([numbers[:1], numbers[1:] - numbers[0]])
    rows = shells.tie_rows(topology, shells.tie_frames(topology, x), fields)
    return Batch(TIE, 0, False, rows, np.zeros((0, rows.shape[2])), numbers)


def make_batches(topology, x, material, base, directions):
    fields = np.concatenate([base[None], directions])
    batches = []
    if material in ("neo-hookean", "mixed"):
        batches.append(hinge_batch(topology, x, base, fields))
    if material in ("neo-hookean", "mixed", "tied"):
        batches.append(face_batch(topology, x, base, fields))
    if material in ("arap", "mixed"):
        batches += [arap_batch(topology, x, fields, fan_class) for fan_class in shells.fan_classes(topology)]
    if material in ("tied", "mixed"):
        batches.append(tie_batch(topology, x, base, fields))
    return batches


def weighted(batch, factors):
    """The batch with every element multiplied by a factor of its own."""
    fixed, poses = batch.fixed.copy(), batch.poses
    if batch.kind in (LAYERED_ARAP, TIE):
        fixed, poses = fixed * factors, poses * factors
    else:
        fixed[1 if batch.kind == LAYERED_HINGE else 7:] *= factors
    return Batch(batch.kind, batch.valence, batch.is_closed, batch.rows, fixed, poses)


# ---------------------------------------------------------------------------------------------------------- textbook --

def membrane_energy(topology, x, weights, y):
    d, s = stretches(topology, x)
    stretch = exponential(np.tensordot(weights[1:], s, 1))
    c = np.linalg.inv(d.transpose(0, 2, 1) @ stretch @ d) @ shells.matrices(shells.metrics(y, topology.faces))
    trace, det = np.trace(c, axis1=1, axis2=2), np.linalg.det(c)
    density = MU / 2 * trace + LAMBDA / 4 * det - (MU / 2 + LAMBDA / 4) * np.log(det) - MU - LAMBDA / 4
    return (shells.face_areas(x[0], topology.faces) * np.sqrt(np.linalg.det(stretch)) * density).sum()


def arap_energy(topology, x, weights, y):
    total = 0.0
    for fan_class in shells.fan_classes(topology):
        c, rest = cell_edges(topology, x, fan_class)
        rest = np.tensordot(weights, rest, 1)
        _, edges = shells.cell_data(topology, y, fan_class)
        rotation = shells.best_rotation(np.einsum("en,eni,enj->eij", c, edges, rest))
        total += (c * ((edges - np.einsum("eij,enj->eni", rotation, rest)) ** 2).sum(axis=2)).sum()
    return total


def absolute_energy(topology, x, material, weights, y):
    total = 0.0
    if material in ("neo-hookean", "mixed"):
        t = shells.wrapped(shells.dihedral_angles(y, topology.hinges) - weights @ angles(topology, x))
        total += (shells.bending_stiffness(topology, x[0]) * t ** 2).sum()
    if material in ("neo-hookean", "mixed", "tied"):
        total += membrane_energy(topology, x, weights, y)
    if material in ("arap", "mixed"):
        total += arap_energy(topology, x, weights, y)
    if material in ("tied", "mixed"):
        moved = shells.tie_places(topology, shells.tie_frames(topology, x), y)
        moved -= np.tensordot(weights, places(topology, x), 1)
        total += shells.TIE_STIFFNESS * (moved ** 2).sum()
    return total
