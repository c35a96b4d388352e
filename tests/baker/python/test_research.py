"""The reduced model and the energies that researchers take apart: basis, surrogate energy, unreduced energy."""
import os
import re
import threading
import unittest
from pathlib import Path

import numpy as np
import pliant
import shapes

try:
    import scipy.sparse
except ImportError:
    scipy = None

POSES, FACES = shapes.tubes((0.0, 1.2, -0.8))
SOLID, TETS = shapes.bars()
QUICK = {"check_samples": 1, "fresh_samples": 1}
TUBE = pliant.bake(POSES, FACES, dim=6, elements=40, **QUICK)
# Exact but for single precision: the reduced energy of such a solid is a quartic, and its basis is not compressed.
BAR = pliant.bake(SOLID, tets=TETS, dim=4, energy="quartic", position_error=0, **QUICK)
LAYERS = pliant.bake(POSES, FACES, blend="layers", dim=6, elements=60, **QUICK)
ENERGY = pliant.energy(POSES, FACES)
WEIGHTS = [0.2, 0.5, 0.3]


def near(asset, weights, seed=0):
    """Coordinates some way off those of a blend."""
    q = asset.coordinates(weights).astype(float)
    return q + 0.2 * np.abs(asset.pose_coordinates).max() * np.random.default_rng(seed).normal(size=q.shape)


def crumpled(energy, pose=1):
    return energy.poses[pose] + 0.02 * energy.length * np.random.default_rng(1).normal(size=energy.poses[pose].shape)


def matrix(entries, size):
    """A dense Hessian of either form."""
    if isinstance(entries, tuple):
        out = np.zeros((size, size))
        np.add.at(out, entries[:2], entries[2])
        return out
    return entries.toarray()


class ReducedModel(unittest.TestCase):
    def test_rest_and_basis_make_the_blends(self):
        for asset in (TUBE, BAR, LAYERS):
            rest, basis = asset.rest, asset.basis
            self.assertEqual((rest.shape, rest.dtype), ((asset.vertex_count, 3), np.float32))
            self.assertEqual((basis.shape, basis.dtype), ((asset.vertex_count, 3, asset.dimension), np.float32))
            for q in (asset.coordinates(np.ones(asset.weight_count)), near(asset, np.ones(asset.weight_count))):
                reference = asset.reconstruct(q)
                self.assertLess(np.abs(rest + basis @ q - reference).max(), 1e-6 * np.ptp(reference, axis=0).max())

    def test_coordinates_of_poses_make_the_poses(self):
        made = BAR.reconstruct(BAR.pose_coordinates)
        self.assertLess(np.abs(made - pliant.energy(SOLID, tets=TETS).poses).max(), 1e-5)

    def test_linear_blends(self):
        made = TUBE.linear_blend([[1, 1, 2], [0, 3, 0]])
        poses = TUBE.reconstruct(TUBE.pose_coordinates)
        self.assertLess(np.abs(made[0] - (poses[0] + poses[1] + 2 * poses[2]) / 4).max(), 1e-5)
        self.assertLess(np.abs(made[1] - poses[1]).max(), 1e-5)
        poses = LAYERS.reconstruct(LAYERS.pose_coordinates)
        added = poses[0] + 0.5 * (poses[1] - poses[0]) - (poses[2] - poses[0])
        self.assertLess(np.abs(LAYERS.linear_blend({"pose_1": 0.5, "pose_2": -1}) - added).max(), 1e-5)
        with self.assertRaises(pliant.Error) as raised:
            TUBE.linear_blend([0, 0, 0])
        self.assertEqual(raised.exception.number, "P1204")

    def test_blends_are_minima_of_the_surrogate_energy(self):
        for asset, weights in ((TUBE, WEIGHTS), (BAR, [0.4, 0.6]), (LAYERS, [0.7, 0.2])):
            q = asset.coordinates(weights).astype(float)
            points = np.stack([near(asset, weights, seed) for seed in range(8)])
            away = asset.energy(weights, points)
            self.assertEqual(away.shape, (8,))
            self.assertGreater(away.min(), asset.energy(weights, q))
            slopes = np.linalg.norm(asset.energy_gradient(weights, points), axis=1)
            self.assertLess(np.linalg.norm(asset.energy_gradient(weights, q)), 0.02 * slopes.min())

    def test_gradients_are_differences_of_the_surrogate_energy(self):
        for asset, weights in ((TUBE, WEIGHTS), (BAR, [0.4, 0.6]), (LAYERS, [0.7, 0.2])):
            q, step = near(asset, weights), 0.005 * np.abs(asset.pose_coordinates).max()
            steps = step * np.eye(asset.dimension)
            differences = (asset.energy(weights, q + steps) - asset.energy(weights, q - steps)) / (2 * step)
            gradient = asset.energy_gradient(weights, q)
            self.assertLess(np.linalg.norm(gradient - differences), 2e-3 * np.linalg.norm(gradient))

    def test_the_quartic_of_a_solid_is_its_energy_in_the_subspace(self):
        energy = pliant.energy(SOLID, tets=TETS)
        rest, basis = BAR.rest.astype(float), BAR.basis.astype(float)
        weights, one, other = [0.3, 0.7], near(BAR, [0.3, 0.7], 1), near(BAR, [0.3, 0.7], 2)

        def full(q):
            return np.einsum("vcd,vc->d", basis, energy.gradient(rest + basis @ q, weights))

        # The dead load is the same at both points.
        reduced = BAR.energy_gradient(weights, one) - BAR.energy_gradient(weights, other)
        expected = full(one) - full(other)
        self.assertLess(np.linalg.norm(reduced - expected), 1e-5 * np.linalg.norm(expected))

    def test_second_derivatives(self):
        energy, basis = pliant.energy(SOLID, tets=TETS), BAR.basis.astype(float).reshape(-1, BAR.dimension)
        for q in (BAR.coordinates([0.3, 0.7]), near(BAR, [0.3, 0.7])):
            full = energy.hessian(BAR.rest + BAR.basis.astype(float) @ q, [0.3, 0.7])
            expected = basis.T @ matrix(full, len(basis)) @ basis
            hessian = BAR.energy_hessian([0.3, 0.7], q)
            self.assertLess(np.linalg.norm(hessian - expected), 1e-4 * np.linalg.norm(expected))
        q, way = near(TUBE, WEIGHTS), np.random.default_rng(3).normal(size=6)
        step = 0.003 * np.abs(TUBE.pose_coordinates).max() * way
        turn = TUBE.energy_gradient(WEIGHTS, q + step) - TUBE.energy_gradient(WEIGHTS, q - step)
        expected = 2 * TUBE.energy_hessian(WEIGHTS, q) @ step
        self.assertLess(np.linalg.norm(turn - expected), 2e-3 * np.linalg.norm(expected))

    def test_wrong_arguments(self):
        with self.assertRaisesRegex(ValueError, r"q: expected \(6,\): reduced coordinates"):
            TUBE.energy_hessian(WEIGHTS, np.zeros((2, 6)))
        with self.assertRaisesRegex(ValueError, r"weights: expected \(3,\), got \(2, 3\)"):
            TUBE.energy_hessian([WEIGHTS, WEIGHTS], np.zeros(6))
        with self.assertRaisesRegex(ValueError, r"q: expected \(6,\) or \(k, 6\)"):
            TUBE.energy(WEIGHTS, np.zeros(5))
        with self.assertRaisesRegex(ValueError, "q: expected 1 or 2 rows, as there are rows of weights, got 3"):
            TUBE.energy([WEIGHTS, WEIGHTS], np.zeros((3, 6)))
        with self.assertRaises(pliant.Error) as raised:
            TUBE.energy([-1, 1, 1], np.zeros(6))
        self.assertEqual(raised.exception.number, "P1204")
        self.assertEqual(TUBE.energy(WEIGHTS, np.full(6, 1e30)), np.inf)
        self.assertTrue(np.isnan(TUBE.energy_gradient(WEIGHTS, np.full(6, 1e30))).all())


def bent(positions, angle):
    turn, radius = positions[:, 0] * angle / 6, 6 / angle - positions[:, 2]
    return np.stack([radius * np.sin(turn), positions[:, 1], 6 / angle - radius * np.cos(turn)], 1)


def turned_behind(positions, rest, place, angle):
    """By a soft joint at x = place of the rest pose."""
    turn, x, y = angle / (1 + np.exp(3 * (place - rest[:, 0]))), positions[:, 0] - place, positions[:, 1]
    return np.stack([x * np.cos(turn) - y * np.sin(turn) + place, x * np.sin(turn) + y * np.cos(turn), positions[:, 2]], 1)


class Place(unittest.TestCase):
    # A coarse open tube whose hinges fold sharply: interpolated averages were moved by what settles there, the basis had
    # translations, and blends drifted by a third of the body.
    def test_blends_of_aligned_poses_stay(self):
        rest, faces = shapes.tube(0, rings=9, sides=5)
        rest = (rest + [2, 0, 0]) * [1.5, 0.498, 0.498]
        poses = np.stack([rest, turned_behind(rest, rest, 2.58, -0.23),
                          turned_behind(bent(bent(rest, -1.41), -1.32), rest, 3.44, -1.08), bent(rest, -0.71)])
        asset, energy = pliant.bake(poses, faces), pliant.energy(poses, faces)
        shares = energy.masses / energy.masses.sum()
        size = np.sqrt(shares @ ((rest - shares @ rest) ** 2).sum(1))
        blends = asset.blend(np.random.default_rng(2).dirichlet(np.ones(4), 100)).astype(float)
        self.assertLess(np.linalg.norm(np.einsum("v,kvc->kc", shares, blends) - shares @ rest, axis=1).max(), 1e-3 * size)

    # Against a straight tube, the closest place of one that coils by more than 1.4 turns flips.
    def test_places_that_flip_are_named(self):
        rest, faces = shapes.tube(0, rings=33, sides=6)
        rest = rest * [1, 0.5, 0.5]
        poses = np.stack([rest, bent(rest, 15)])
        with self.assertWarnsRegex(Warning, "blends turn at once on the path towards pose"):
            asset = pliant.bake(poses, faces, **QUICK)
        self.assertIn("turn", [branch["kind"] for branch in asset.certificate["branches"]])
        kept = pliant.bake(poses, faces, no_align=True, **QUICK)
        self.assertNotIn("turn", [branch["kind"] for branch in kept.certificate["branches"]])


class Readme(unittest.TestCase):
    def test_what_it_shows_runs(self):
        text = Path(os.environ["PLIANT_SOURCE"], "baker/python/README.md").read_text(encoding="utf-8")
        part = text.split("## For research\n")[1].split("\n## ")[0]
        names = {"pliant": pliant, "asset": pliant.bake(POSES[:2], FACES, dim=3, elements=18, **QUICK), "poses": POSES[:2],
                 "faces": FACES, "x": POSES[0]}
        blocks = re.findall(r"```python\n(.*?)```", part, re.S)
        for block in blocks:
            exec(block, names)
        self.assertEqual(len(blocks), 2)
        self.assertEqual(names["basis"].shape, (112, 3, 3))


class UnreducedEnergy(unittest.TestCase):
    def check_derivatives(self, energy, weights):
        x = crumpled(energy)
        way = np.random.default_rng(2).normal(size=x.shape)
        step = 1e-6 * energy.length * way
        change = energy.value(x + step, weights) - energy.value(x - step, weights)
        expected = 2 * (energy.gradient(x, weights) * step).sum()
        self.assertLess(abs(change - expected), 1e-6 * abs(expected))
        hessian = matrix(energy.hessian(x, weights), x.size)
        self.assertEqual(np.abs(hessian - hessian.T).max(), 0)
        turn = energy.gradient(x + step, weights) - energy.gradient(x - step, weights)
        expected = 2 * hessian @ step.ravel()
        self.assertLess(np.abs(turn.ravel() - expected).max(), 1e-6 * np.abs(expected).max())
        projected = matrix(energy.hessian(x, weights, projected=True), x.size)
        lowest = np.linalg.eigvalsh(projected)[0]
        self.assertGreater(lowest, -1e-10 * np.abs(projected).max())

    def test_derivatives_are_differences(self):
        for options in ({}, {"material": "arap"}, {"membrane": "edge", "continuity": "off"}, {"blend": "layers"}):
            with self.subTest(options):
                energy = pliant.energy(POSES, FACES, **options)
                self.check_derivatives(energy, [0.5, 0.3] if "blend" in options else WEIGHTS)
        for material in ("stvk", "mooney-rivlin"):
            with self.subTest(material):
                self.check_derivatives(pliant.energy(SOLID, tets=TETS, material=material), [0.3, 0.7])

    def test_what_it_is(self):
        energy = ENERGY
        for k, corner in enumerate(np.eye(3)):
            self.assertLess(energy.value(energy.poses[k], corner), 1e-20)
        x = crumpled(energy)
        parts = [energy.value(x, corner) for corner in np.eye(3)]
        self.assertAlmostEqual(energy.value(x, [1, 1, 2]), (parts[0] + parts[1] + 2 * parts[2]) / 4, delta=1e-12)
        self.assertAlmostEqual(energy.value(x), sum(parts) / 3, delta=1e-12)
        large = pliant.energy(10 * POSES + 7, FACES)
        self.assertAlmostEqual(large.value(10 * x + 7), energy.value(x), delta=1e-9 * energy.value(x))
        self.assertAlmostEqual(energy.masses.sum(), 1)
        self.assertEqual(repr(energy), "<pliant.Energy of 3 poses, 112 vertices>")

    def test_averages_are_minima(self):
        y = pliant.average(POSES, FACES, WEIGHTS)
        away = ENERGY.gradient(ENERGY.poses[0], WEIGHTS)
        self.assertLess(np.abs(ENERGY.gradient(y, WEIGHTS)).max(), 1e-6 * np.abs(away).max())
        self.assertLess(ENERGY.value(y, WEIGHTS), ENERGY.value(TUBE.linear_blend(WEIGHTS), WEIGHTS))
        energy = pliant.energy(POSES, FACES, blend="layers")
        y = pliant.average(POSES, FACES, [0.6, 0.5], blend="layers")
        away = energy.gradient(energy.poses[0], [0.6, 0.5])
        self.assertLess(np.abs(energy.gradient(y, [0.6, 0.5])).max(), 1e-4 * np.abs(away).max())

    def test_newton_with_the_hessian_finds_the_average(self):
        if scipy is None:
            self.skipTest("scipy is not installed")
        from scipy.sparse.linalg import spsolve

        energy = pliant.energy(SOLID, tets=TETS)
        x, size = SOLID[0].copy(), SOLID[0].size
        for _ in range(20):
            hessian = energy.hessian(x, [1, 1], projected=True) + 1e-7 * scipy.sparse.identity(size, format="csc")
            self.assertIsInstance(hessian, scipy.sparse.csc_matrix)
            x = x - spsolve(hessian, energy.gradient(x, [1, 1]).ravel()).reshape(-1, 3)
        y = pliant.average(SOLID, weights=[1, 1], tets=TETS)
        self.assertAlmostEqual(energy.value(x, [1, 1]), energy.value(y, [1, 1]), delta=1e-7 * energy.value(y, [1, 1]))

    def test_welded_vertices(self):
        # The tube cut open: every corner of a face a vertex of its own.
        cut, split = POSES[:, FACES.ravel()], np.arange(FACES.size).reshape(-1, 3)
        with self.assertWarns(pliant.PliantWarning):
            energy = pliant.energy(cut, split)
        whole = crumpled(ENERGY)
        self.assertEqual(len(energy.vertices), len(whole))
        self.assertAlmostEqual(energy.value(whole[FACES.ravel()]), ENERGY.value(whole), delta=1e-12)
        gradient = energy.gradient(whole[FACES.ravel()])
        first = np.sort(energy.vertices)
        self.assertLess(np.abs(gradient[energy.vertices].sum(0) - ENERGY.gradient(whole).sum(0)).max(), 1e-10)
        others = np.setdiff1d(np.arange(len(gradient)), first)
        self.assertFalse(gradient[others].any() or energy.masses[others].any())
        sums = np.zeros_like(whole)
        np.add.at(sums, FACES.ravel(), gradient)
        self.assertLess(np.abs(sums - ENERGY.gradient(whole)).max(), 1e-10)

    def test_collapsed_elements(self):
        energy = pliant.energy(SOLID, tets=TETS, material="mooney-rivlin")
        flat = SOLID[0] * [1, 1, 0]
        self.assertEqual(energy.value(flat), np.inf)
        self.assertEqual([ENERGY.value(POSES[0] * size) for size in (0, 1e200)], [np.inf, np.inf])
        self.assertTrue(np.isnan(energy.gradient(flat)).all())
        self.assertTrue(np.isnan(matrix(energy.hessian(flat), flat.size)).any())

    def test_threads(self):
        x = crumpled(ENERGY)
        expected = ENERGY.value(x), ENERGY.gradient(x).tobytes(), matrix(ENERGY.hessian(x), x.size).tobytes()
        differences = []

        def work():
            for _ in range(20):
                got = ENERGY.value(x), ENERGY.gradient(x).tobytes(), matrix(ENERGY.hessian(x), x.size).tobytes()
                if got != expected:
                    differences.append(got)

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertFalse(differences)

    def test_wrong_arguments(self):
        with self.assertRaisesRegex(ValueError, r"x: expected \(112, 3\): positions of the vertices, got \(3,\) "):
            ENERGY.value([0.0, 1.0, 2.0])
        with self.assertRaisesRegex(ValueError, "x: a position is not finite"):
            ENERGY.gradient(np.full(POSES[0].shape, np.nan))
        with self.assertRaisesRegex(ValueError, r"weights: expected \(3,\): one per pose, got \(2,\)"):
            ENERGY.value(POSES[0], [1, 1])
        with self.assertRaises(pliant.Error) as raised:
            ENERGY.value(POSES[0], [1, -1, 1])
        self.assertEqual(raised.exception.number, "P1204")
        with self.assertRaises(pliant.Error) as raised:
            pliant.energy(POSES, FACES, material="stvk")
        self.assertEqual(raised.exception.number, "P1206")
        with self.assertRaisesRegex(ValueError, "thickness: expected a number from 1e-06 to 1"):
            pliant.energy(POSES, FACES, thickness=2.0)


if __name__ == "__main__":
    unittest.main(verbosity=2)
