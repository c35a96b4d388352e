"""Writes the small assets that the runtime's tests use, with numbers from the reference: make_test_assets.py FOLDER

NAME.pliant and NAME.expect, a text file of lines
    evaluate  m weights  d z  energy  d gradient
    solve     weights  d q
    predict   weights  d q of the predictor alone
    normals   d q  3 numbers of the normal for each vertex of the boundary
and assets.txt, the names. Skips what is up to date with this script and its modules.
"""
import sys
from pathlib import Path

import numpy as np

import pliant_reference_path  # noqa: F401
from pliant_reference import Asset
from tiny_asset import make_asset

ASSETS = {
    "line": dict(mesh="strip", size=(5, 2), poses=2, dimension=1, material="neo-hookean"),
    "strip_neo": dict(mesh="strip", size=(7, 3), poses=2, dimension=4, material="neo-hookean", predictor=True,
                      polygons=True),
    "strip_stvk": dict(mesh="strip", size=(7, 3), poses=3, dimension=5, material="stvk"),
    "strip_edge": dict(mesh="strip", size=(7, 3), poses=3, dimension=6, material="edge", predictor=True),
    "strip_arap": dict(mesh="strip", size=(6, 3), poses=2, dimension=3, material="arap"),
    "strip_mixed": dict(mesh="strip", size=(5, 3), poses=3, dimension=4, material="mixed", predictor=True),
    "strip_smooth": dict(mesh="strip", size=(6, 3), poses=2, dimension=3, material="stvk", smoothing=True),
    "tube_neo": dict(mesh="tube", size=(8, 6), poses=5, dimension=17, material="neo-hookean", predictor=True),
    "tube_stvk": dict(mesh="tube", size=(6, 6), poses=3, dimension=8, material="stvk", predictor=True),
    "tube_edge": dict(mesh="tube", size=(6, 6), poses=4, dimension=12, material="edge"),
    "tube_arap": dict(mesh="tube", size=(6, 5), poses=3, dimension=7, material="arap", predictor=True),
    "strip_load": dict(mesh="strip", size=(7, 3), poses=3, dimension=4, material="neo-hookean", predictor=True, load=True),
    "tube_load": dict(mesh="tube", size=(6, 6), poses=4, dimension=17, material="edge", predictor=True, load=True),
    "strip_tied": dict(mesh="strip", size=(6, 3), poses=3, dimension=5, material="tied", predictor=True),
    "beam_stvk": dict(mesh="beam", size=(5, 2), poses=3, dimension=6, material="tet-stvk", predictor=True),
    "beam_mooney": dict(mesh="beam", size=(4, 3), poses=3, dimension=9, material="mooney-rivlin", predictor=True),
    "beam_mixed": dict(mesh="beam", size=(4, 2), poses=2, dimension=4, material="tet-mixed", predictor=True, load=True),
    "beam_quartic": dict(mesh="beam", size=(5, 2), poses=3, dimension=10, material="tet-stvk", predictor=True, quartic=True),
    "beam_quartic_line": dict(mesh="beam", size=(3, 2), poses=2, dimension=1, material="tet-stvk", quartic=True),
    "beam_quartic_load": dict(mesh="beam", size=(6, 2), poses=4, dimension=17, material="tet-stvk", predictor=True,
                              load=True, quartic=True),
    "strip_compact": dict(mesh="strip", size=(7, 3), poses=3, dimension=4, material="neo-hookean", predictor=True,
                          compact=1e-3),
    "line_compact": dict(mesh="strip", size=(5, 2), poses=2, dimension=1, material="neo-hookean", compact=1e-5),
    "tube_compact": dict(mesh="tube", size=(12, 16), poses=3, dimension=12, material="edge", predictor=True, compact=1e-4),
    "tube_compact_fine": dict(mesh="tube", size=(9, 9), poses=2, dimension=5, material="stvk", predictor=True, load=True,
                              compact=1e-7),
    "strip_factored": dict(mesh="strip", size=(12, 11), poses=3, dimension=4, material="neo-hookean", predictor=True,
                           factored=1e-3),
    "line_factored": dict(mesh="strip", size=(5, 2), poses=2, dimension=1, material="neo-hookean", factored=1e-4),
    "tube_factored": dict(mesh="tube", size=(12, 16), poses=3, dimension=12, material="edge", predictor=True,
                          factored=1e-5),
    "tube_ranges": dict(mesh="tube", size=(12, 9), poses=3, dimension=8, material="neo-hookean", predictor=True,
                        ranges=True),
    "beam_ranges": dict(mesh="beam", size=(4, 3), poses=2, dimension=5, material="mooney-rivlin", predictor=True,
                        ranges=True),
    "layers_line": dict(mesh="strip", size=(5, 2), poses=2, dimension=1, material="neo-hookean", layers=True),
    "layers_neo": dict(mesh="strip", size=(9, 3), poses=4, dimension=6, material="neo-hookean", predictor=True, layers=True,
                       polygons=True),
    "layers_arap": dict(mesh="strip", size=(8, 3), poses=3, dimension=4, material="arap", layers=True),
    "layers_tied": dict(mesh="strip", size=(6, 3), poses=3, dimension=5, material="tied", predictor=True, layers=True,
                        factored=1e-4),
    "layers_mixed": dict(mesh="tube", size=(6, 5), poses=4, dimension=8, material="mixed", predictor=True, load=True,
                         layers=True, ranges=True),
    "layers_tube": dict(mesh="tube", size=(9, 6), poses=4, dimension=17, material="neo-hookean", predictor=True, load=True,
                        layers=True, compact=1e-5),
    "layers_many": dict(mesh="strip", size=(7, 3), poses=65, dimension=5, material="neo-hookean", predictor=True,
                        layers=True),
    "twelve_poses": dict(mesh="strip", size=(8, 4), poses=12, dimension=16, material="neo-hookean", predictor=True),
}


def line(*parts):
    return " ".join(part if isinstance(part, str) else " ".join(f"{x:.17g}" for x in np.atleast_1d(part)) for part in parts)


def random_layers(asset, random):
    """A few layers at a time, a little outside their ranges, too."""
    low, high, _ = asset.layers.T
    return (low + (high - low) * random.uniform(-0.1, 1.1, len(low))) * (random.random(len(low)) < 3 / len(low)) * 0.7


def expectations(asset):
    """Evaluations at random points of growing size, and blends at corners, the middle and in between."""
    random = np.random.default_rng(7)
    m, d = asset.pose_count, asset.dimension
    lines = []

    def random_weights():
        return random.dirichlet(np.ones(m)) if asset.layers is None else random_layers(asset, random)

    for size in (0.0, 0.01, 0.1, 0.3) * 3:
        w = random_weights().astype(np.float32).astype(float)
        w = w if asset.layers is None else asset.full_weights(w)
        z = (size * np.sqrt(asset.energy_scale) * random.standard_normal(d)).astype(np.float32).astype(float)
        energy, gradient = asset.evaluate(z, w)
        if np.isfinite(energy):
            lines.append(line("evaluate", w, z, energy, gradient))
    if asset.layers is None:
        weights = [*np.eye(m)[:3], np.full(m, 1 / m)]
    else:
        weights = [*np.eye(m - 1)[:3], np.zeros(m - 1), -0.5 * np.eye(m - 1)[0]]
    for w in weights + [random_weights() for _ in range(4)]:
        w = w.astype(np.float32).astype(float)
        z, _ = asset.minimise(w)
        lines.append(line("solve", w, asset.coordinates(z)))
        lines.append(line("predict", w, asset.coordinates(asset.predict(asset.full_weights(w)))))
    for _ in range(2):
        q = random.standard_normal(d).astype(np.float32).astype(float) * 0.1
        q = (asset.pose_coordinates[-1] + q * abs(asset.pose_coordinates[-1]).max()).astype(np.float32).astype(float)
        lines.append(line("normals", q, asset.normals(asset.reconstruct(q))[:asset.boundary_vertex_count].ravel()))
    return lines


def main():
    folder, sources = Path(sys.argv[1]), Path(__file__).parent
    folder.mkdir(parents=True, exist_ok=True)
    newest = max(path.stat().st_mtime for path in [*sources.glob("*.py"), *pliant_reference_path.FILES])
    for name, options in ASSETS.items():
        target, expect = folder / f"{name}.pliant", folder / f"{name}.expect"
        if expect.exists() and expect.stat().st_mtime > newest:
            continue
        blob = make_asset(**options)
        target.write_bytes(blob)
        expect.write_text("\n".join(expectations(Asset(blob))) + "\n")
        print(f"{name}: {len(blob)} bytes")
    (folder / "assets.txt").write_text("\n".join(ASSETS) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
