"""Normals: recomputed, or from a linear basis? normal_basis.py ASSET... [--train N] [--test N]

Shapes are those of the asset's predictor at random weights, so no solver is needed. Normals of the training shapes give a
basis; on fresh shapes its normals are compared with recomputed ones (area-weighted, as the runtime computes them). Two ways
to find coefficients:
  best    the true normals projected onto the first r principal axes: what no rule for coefficients can beat;
  linear  in q, fitted by least squares: what an engine's morph targets would do with normal deltas, one column a dimension.
Prints degrees: mean, 99th percentile, worst over vertices and shapes, and bytes a vertex in single precision.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "formats/reference"))
from pliant_reference import Asset  # noqa: E402


def recomputed(positions, triangles, groups):
    corners = positions[triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sums = np.zeros_like(positions)
    for i in range(3):
        np.add.at(sums, groups[triangles[:, i]], faces)
    sums = sums[groups]
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    return np.where(lengths > 0, sums / np.where(lengths > 0, lengths, 1), [0.0, 0.0, 1.0])


def samples(asset, count, random):
    """Coordinates and normals (count x 3n) of blends: half of them near edges and corners."""
    n = asset.boundary_vertex_count
    triangles = asset.triangles.astype(int)
    shapes, normals = [], []
    for i in range(count):
        w = random.dirichlet(np.full(asset.pose_count, 1.0 if i % 2 else 0.3))
        q = asset.coordinates(asset.predict(w))
        shapes.append(q)
        normals.append(recomputed(asset.reconstruct(q)[:n], triangles, asset.smoothing[:n]).ravel())
    return np.array(shapes), np.array(normals)


def report(name, found, truth, columns):
    a, b = found.reshape(-1, 3), truth.reshape(-1, 3)
    lengths = np.linalg.norm(a, axis=1)
    chord = np.linalg.norm(a / np.where(lengths > 0, lengths, 1)[:, None] - b, axis=1)
    degrees = np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1)))
    print(f"  {name:18} {degrees.mean():9.4f} {np.percentile(degrees, 99):9.3f} {degrees.max():9.2f}   "
          f"{12 * (1 + columns):6}")


def study(path, train, test):
    asset = Asset(Path(path).read_bytes(), verify=False)
    random = np.random.default_rng(1)
    q, normals = samples(asset, train, random)
    fresh_q, truth = samples(asset, test, random)
    mean = normals.mean(axis=0)
    _, _, axes = np.linalg.svd(normals - mean, full_matrices=False)
    print(f"{path}: {asset.boundary_vertex_count} vertices, {asset.pose_count} poses, "
          f"d = {asset.dimension}, {train} training shapes, "
          f"{test} fresh\n  {'':18} {'mean':>9} {'99 %':>9} {'worst':>9}   bytes a vertex")
    for rank in (3, 4, 6, 8, 16, 32):
        if rank <= len(axes):
            report(f"best, rank {rank}", mean + (truth - mean) @ axes[:rank].T @ axes[:rank], truth, rank)
    features = np.hstack([np.ones((train, 1)), q])
    columns = np.linalg.lstsq(features, normals, rcond=None)[0]
    report("linear in q", np.hstack([np.ones((test, 1)), fresh_q]) @ columns, truth, asset.dimension)


def main():
    parser = argparse.ArgumentParser(description="normals from a linear basis against recomputed ones")
    parser.add_argument("assets", nargs="+")
    parser.add_argument("--train", type=int, default=150)
    parser.add_argument("--test", type=int, default=40)
    options = parser.parse_args()
    for path in options.assets:
        study(path, options.train, options.test)
    return 0


if __name__ == "__main__":
    sys.exit(main())
