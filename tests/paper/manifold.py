"""An experiment: shape spaces that are no linear spaces, at equal cost of reconstruction. manifold.py DIR SET...

Reads the averages that `pliant_study --snapshots -o DIR/SET` wrote; trains on some, and reports the relative L2 distance of
the others from the space (the best that any solver could reach there), for

  linear      y = tau + U q: differences kept, then POD; c columns, c unknowns. What Pliant does.
  quadratic   y = tau + U q + V C (q x q) (Geelen, Wright, Willcox 2023): p unknowns; V the next c - p POD directions, C by
              ridge regression. c columns. Since this lies inside the linear space of the same c columns, it cannot beat it
              at equal c; it can at equal unknowns.
  local       clusters in weight space, each with a POD basis of its own: c columns and unknowns, more memory,
              and jumps between clusters.
  rotated     y = S(w) + R(w) (U q): the body's parts are moved rigidly as a polynomial in the weights tells (linear blend
              skinning), and displacements turn with them; U by POD of what is left. c unknowns; reconstruction costs c
              columns and the skinning. The weights are known at run time, so the parts' motions are no unknowns.

Tables DIR/SET_manifold.csv and .md, plot DIR/SET_manifold.png.
"""
import csv
import sys
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np

try:
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
except ImportError:
    pyplot = None


class Snapshots:
    """Averages as rows of 3n numbers, scaled by the roots of the masses, so that dot products are those of the mass norm."""

    def __init__(self, prefix):
        load = lambda name: np.load(f"{prefix}_{name}.npy").astype(np.float64)
        self.masses = load("masses").ravel()
        self.root = np.repeat(np.sqrt(self.masses), 3)
        self.poses, self.pose_weights = load("poses") * self.root, load("poses_weights")
        self.train, self.train_weights = load("train") * self.root, load("train_weights")
        self.fresh, self.fresh_weights = load("fresh") * self.root, load("fresh_weights")
        self.faces = np.load(f"{prefix}_faces.npy").astype(np.int64)
        centred = self.fresh.reshape(len(self.fresh), -1, 3) / np.sqrt(self.masses)[:, None]
        centred = centred - np.einsum("v,svc->sc", self.masses, centred)[:, None]
        self.extent = np.sqrt(np.einsum("v,svc->s", self.masses, centred ** 2))

    def errors(self, off):
        return np.linalg.norm(off, axis=1) / self.extent


def orthonormal(rows):
    """Orthonormal rows that span the given ones."""
    u, s, v = np.linalg.svd(rows, full_matrices=False)
    return v[s > 1e-9 * s[0]]


def pod(kept, snapshots, count):
    """`kept` orthonormal rows, then leading directions of the rest, `count` in all."""
    rest = snapshots - (snapshots @ kept.T) @ kept
    _, _, v = np.linalg.svd(rest, full_matrices=False)
    return np.vstack([kept, v[:max(0, count - len(kept))]])


def residual(rows, basis):
    return rows - (rows @ basis.T) @ basis


def linear(data, count):
    tau = data.poses[0]
    basis = pod(orthonormal(data.poses[1:] - tau), data.train - tau, count)
    return data.errors(residual(data.fresh - tau, basis))


def products(q):
    """All q_i q_j, i <= j, of rows q."""
    i, j = np.triu_indices(q.shape[1])
    return q[:, i] * q[:, j]


def products_jacobian(q):
    i, j = np.triu_indices(len(q))
    jacobian = np.zeros((len(i), len(q)))
    rows = np.arange(len(i))
    np.add.at(jacobian, (rows, i), q[j])
    np.add.at(jacobian, (rows, j), q[i])
    return jacobian


def ridge(features, targets, strength):
    gram = features.T @ features
    return np.linalg.solve(gram + strength * np.trace(gram) / len(gram) * np.eye(len(gram)), features.T @ targets)


def choose_ridge(features, targets):
    """The strength with the least error in five-fold cross-validation."""
    strengths, folds = 10.0 ** np.arange(-10, 1), np.arange(len(features)) % 5
    def left_out(strength):
        return sum(np.sum((targets[folds == f] - features[folds == f]
                           @ ridge(features[folds != f], targets[folds != f], strength)) ** 2)
                   for f in range(5))
    return min(strengths, key=left_out)


def quadratic(data, unknowns, count):
    tau = data.poses[0]
    snapshots = np.vstack([data.train, data.poses[1:]]) - tau
    basis = pod(orthonormal(data.poses[1:] - tau), data.train - tau, count)
    coordinates = snapshots @ basis.T
    q, upper = coordinates[:, :unknowns], coordinates[:, unknowns:]
    scale = np.abs(q).max(axis=0)  # so that one ridge suits all products
    features = products(q / scale)
    fit = ridge(features, upper, choose_ridge(features, upper))
    errors = []
    for shape in data.fresh - tau:
        target = basis @ shape
        outside = shape @ shape - target @ target
        errors.append(np.sqrt(max(0.0, outside + nearest_on_manifold(target, unknowns, scale, fit))))
    return np.array(errors) / data.extent


def nearest_on_manifold(target, unknowns, scale, fit):
    """Least squared distance of coordinates from the manifold: Gauss-Newton, steps halved until they descend."""
    def off(q):
        return np.concatenate([q, products(q[None] / scale)[0] @ fit]) - target
    q = target[:unknowns].copy()
    best = off(q)
    for _ in range(30):
        jacobian = np.vstack([np.eye(unknowns), fit.T @ products_jacobian(q / scale) / scale])
        step = -np.linalg.lstsq(jacobian, best, rcond=None)[0]
        length = 1.0
        while length > 1e-4 and np.sum(off(q + length * step) ** 2) >= np.sum(best ** 2):
            length /= 2
        if length <= 1e-4:
            break
        q, best = q + length * step, off(q + length * step)
    return best @ best


def local(data, clusters, count):
    """Clusters by k-means of the weights; each basis is trained on the snapshots nearest to its centre,
    enough of them for its columns."""
    weights = np.vstack([data.train_weights, data.pose_weights])
    snapshots = np.vstack([data.train, data.poses])
    centres = k_means(weights, clusters)
    owner = np.argmin(((data.fresh_weights[:, None] - centres) ** 2).sum(axis=2), axis=1)
    off = np.zeros_like(data.fresh)
    for c, centre in enumerate(centres):
        near = np.argsort(((weights - centre) ** 2).sum(axis=1))[:max(count + 2, 2 * len(weights) // clusters)]
        mean = snapshots[near].mean(axis=0)
        basis = pod(np.zeros((0, snapshots.shape[1])), snapshots[near] - mean, count)
        mine = owner == c
        off[mine] = residual(data.fresh[mine] - mean, basis)
    return data.errors(off)


def k_means(points, count):
    generator = np.random.default_rng(1)
    centres = points[[0]]
    while len(centres) < count:  # farthest point next: no run is unlucky
        distance = ((points[:, None] - centres) ** 2).sum(axis=2).min(axis=1)
        centres = np.vstack([centres, points[np.argmax(distance + 1e-9 * generator.random(len(points)))]])
    for _ in range(50):
        owner = np.argmin(((points[:, None] - centres) ** 2).sum(axis=2), axis=1)
        centres = np.array([points[owner == c].mean(axis=0) if (owner == c).any() else centres[c] for c in range(count)])
    return centres


def polar(matrices):
    """Nearest proper rotations."""
    u, _, v = np.linalg.svd(matrices)
    flip = np.ones(matrices.shape[:-1])
    flip[..., 2] = np.sign(np.linalg.det(u @ v))
    return (u * flip[..., None, :]) @ v


def frames(shape, faces):
    """Per face: edge, other edge, unit normal as columns."""
    a, b, c = (shape[faces[:, i]] for i in range(3))
    normal = np.cross(b - a, c - a)
    return np.stack([b - a, c - a, normal / np.sqrt(np.linalg.norm(normal, axis=1))[:, None]], axis=2)


class Parts:
    """Soft parts of the body that turn alike in all poses (k-means of the rotations of faces, and a little of the place)."""

    def __init__(self, data, count):
        self.roots = np.sqrt(data.masses)[:, None]
        self.masses = data.masses
        self.rest = data.poses[0].reshape(-1, 3) / self.roots
        inverse = np.linalg.inv(frames(self.rest, data.faces))
        features = []
        for pose in data.poses[1:]:
            turns = polar(frames(pose.reshape(-1, 3) / self.roots, data.faces) @ inverse).reshape(-1, 9)
            total = np.zeros((len(self.rest), 9))
            for corner in range(3):
                np.add.at(total, data.faces[:, corner], turns)
            features.append(total / np.bincount(data.faces.ravel(), minlength=len(self.rest))[:, None])
        extent = np.ptp(self.rest, axis=0).max()
        features = np.hstack([*features, 3 * self.rest / extent])
        owner = np.argmin(np.stack([((features - c) ** 2).sum(axis=1) for c in k_means_large(features, count)]), axis=0)
        self.shares = np.eye(count)[owner]
        edges = np.vstack([data.faces[:, [0, 1]], data.faces[:, [1, 2]], data.faces[:, [2, 0]]])
        degree = np.bincount(edges.ravel(), minlength=len(self.rest))[:, None]
        for _ in range(25):  # borders some dozens of edges wide
            total = np.zeros_like(self.shares)
            for i, j in ((0, 1), (1, 0)):
                for part in range(count):
                    total[:, part] += np.bincount(edges[:, i], self.shares[edges[:, j], part], len(self.rest))
            self.shares = 0.5 * self.shares + 0.5 * total / degree
        self.shares /= self.shares.sum(axis=1)[:, None]

    def motions(self, row):
        """Best rigid motion of every part: rotations (9) and where the part's centre goes (3)."""
        shape, out = row.reshape(-1, 3) / self.roots, []
        for share in self.shares.T:
            weight = share * self.masses / (share @ self.masses)
            centre, target = weight @ self.rest, weight @ shape
            turn = polar((shape - target).T @ (weight[:, None] * (self.rest - centre)))
            out.append(np.concatenate([turn.ravel(), target]))
        return np.concatenate(out)

    def frame(self, motions):
        """Skinned rest shape (3n, scaled) and the rotation of every vertex, from motions of the parts."""
        motions = motions.reshape(-1, 12)
        turns, targets = polar(motions[:, :9].reshape(-1, 3, 3)), motions[:, 9:]
        centres = np.stack([(share * self.masses) @ self.rest / (share @ self.masses) for share in self.shares.T])
        blended = np.einsum("vp,pij->vij", self.shares, turns)
        offsets = self.shares @ (targets - np.einsum("pij,pj->pi", turns, centres))
        skinned = np.einsum("vij,vj->vi", blended, self.rest) + offsets
        return (skinned * self.roots).ravel(), polar(blended)


def k_means_large(points, count):
    """On a sample of the points: farthest ones first, then averaged."""
    sample = points[:: max(1, len(points) // 3000)]
    return k_means(sample, count)


def polynomials(weights, degree):
    """All products of at most `degree` weights but the last one, which the others tell."""
    columns = [np.ones(len(weights))]
    for size in range(1, degree + 1):
        for factors in combinations_with_replacement(range(weights.shape[1] - 1), size):
            columns.append(np.prod(weights[:, list(factors)], axis=1))
    return np.stack(columns, axis=1)


class Rotated:
    """What is left of every shape in the turned frames, computed once for all dimensions."""

    def __init__(self, data, part_count):
        parts = Parts(data, part_count)
        weights = np.vstack([data.pose_weights, data.train_weights])
        known = np.stack([parts.motions(row) for row in np.vstack([data.poses, data.train])])
        # One smooth function of the weights for all shapes, those it was fitted to as well: where it is off, it is off
        # smoothly, and that is for U to mend. (Exact interpolation leaves errors between the snapshots that no U has seen.)
        degree = 3 if polynomials(weights, 3).shape[1] * 2 <= len(weights) else 2
        fit = np.linalg.lstsq(polynomials(weights, degree), known, rcond=None)[0]
        pull = lambda rows, w: np.stack([self.pull(parts, row, motion)
                                         for row, motion in zip(rows, polynomials(w, degree) @ fit)])
        self.poses = pull(data.poses, data.pose_weights)
        self.train = pull(data.train, data.train_weights)
        self.fresh = pull(data.fresh, data.fresh_weights)

    @staticmethod
    def pull(parts, row, motions):
        skinned, turns = parts.frame(motions)
        return np.einsum("vji,vj->vi", turns, (row - skinned).reshape(-1, 3)).ravel()

    def errors(self, data, count):
        basis = pod(orthonormal(self.poses), self.train, count)  # poses stay exact
        return data.errors(residual(self.fresh, basis))


def study(folder, name):
    data = Snapshots(folder / name)
    pose_count = len(data.poses)
    rotated = {parts: Rotated(data, parts) for parts in (8, 20)}
    dims = [c for c in (8, 12, 16, 24, 32, 48) if pose_count < c <= len(data.train) - 2]
    rows = []
    def add(method, columns, unknowns, errors):
        rows.append([method, columns, unknowns, errors.mean(), errors.max()])
    for c in dims:
        add("linear", c, c, linear(data, c))
        for share in (4, 2):
            if c // share >= pose_count - 1:  # the differences are always there
                add(f"quadratic, p = c/{share}", c, c // share, quadratic(data, c // share, c))
        for clusters in (pose_count, 2 * pose_count):
            if c + 2 <= len(data.train) // 2:
                add(f"local, {clusters} clusters", c, c, local(data, clusters, c))
        for parts, space in rotated.items():
            add(f"rotated, {parts} parts", c, c, space.errors(data, c))
    write(folder / f"{name}_manifold", name, len(data.train), len(data.fresh), rows)


def write(path, name, train_count, fresh_count, rows):
    header = ["space", "columns", "unknowns", "L2 mean", "L2 largest"]
    cells = [[*row[:3], f"{row[3]:.2e}", f"{row[4]:.2e}"] for row in rows]
    with open(path.with_suffix(".csv"), "w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([header, *cells])
    line = lambda values: "| " + " | ".join(str(v) for v in values) + " |\n"
    path.with_suffix(".md").write_text(
        f"## {name}: shape spaces that are not linear\n\n"
        f"Distance of {fresh_count} fresh averages from spaces trained on {train_count} others "
        "(manifold.py says what they are).\n\n" + line(header) + line(["---"] * len(header)) + "".join(map(line, cells)))
    if not pyplot:
        return
    figure, axes = pyplot.subplots(figsize=(6.4, 4.4))
    for method in dict.fromkeys(row[0] for row in rows):
        points = [(row[1], row[3]) for row in rows if row[0] == method]
        axes.semilogy(*zip(*points), "k-o" if method == "linear" else "--s" if method.startswith("quadratic") else "-^",
                      label=method, linewidth=2 if method == "linear" else 1.2, markersize=4)
    axes.set(xlabel="columns", ylabel="relative L2, mean, best projection", title=f"{name}: spaces at equal columns")
    axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path.with_suffix(".png"), dpi=140)
    pyplot.close(figure)


if __name__ == "__main__":
    for each in sys.argv[2:]:
        study(Path(sys.argv[1]), each)
