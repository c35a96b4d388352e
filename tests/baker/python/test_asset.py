"""An asset in Python: opened in place from bytes and maps, whatever the bytes are; blended, saved, passed on."""
import gc
import mmap
import os
import pickle
import struct
import tempfile
import unittest
import weakref
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pliant
import shapes

GOLDEN = Path(os.environ["PLIANT_SOURCE"]) / "tests/golden"
POSES, FACES = shapes.tubes()
BAKED = pliant.bake(POSES, FACES, dim=3, elements=18, check_samples=2, fresh_samples=1)
DATA = bytes(BAKED)


class OpeningAssets(unittest.TestCase):
    def test_bytes_are_used_where_they_are(self):
        asset = pliant.Asset.open(DATA)
        self.assertTrue(asset._view.is_in_place)
        self.assertIs(bytes(asset), DATA)
        self.assertEqual(asset.blend([1, 1]).tobytes(), BAKED.blend([1, 1]).tobytes())

    def test_maps_are_used_where_they_are_and_stay_open(self):
        with tempfile.TemporaryFile() as file:
            file.write(DATA)
            file.flush()
            view = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        asset = pliant.Asset.open(view)
        self.assertTrue(asset._view.is_in_place)
        with self.assertRaises(BufferError):
            view.close()
        self.assertEqual(asset.blend([1, 2]).tobytes(), BAKED.blend([1, 2]).tobytes())
        self.assertEqual(bytes(asset), DATA)
        del asset
        view.close()

    def test_what_can_change_is_copied(self):
        expected = BAKED.blend([1, 1]).tobytes()
        with tempfile.TemporaryFile() as file:
            file.write(DATA)
            file.flush()
            writable = mmap.mmap(file.fileno(), 0)
        for source in (bytearray(DATA), np.frombuffer(DATA, np.uint8).copy(), writable):
            asset = pliant.Asset.open(source)
            source[:] = b"x" * len(DATA) if not isinstance(source, np.ndarray) else np.zeros(len(DATA), np.uint8)
            self.assertEqual(asset.blend([1, 1]).tobytes(), expected)
        shifted = memoryview(b"x" + DATA)[1:]
        self.assertEqual(pliant.Asset.open(shifted).blend([1, 1]).tobytes(), expected)

    def test_nothing_keeps_an_asset(self):
        asset = pliant.Asset.open(DATA)
        asset.blend([1, 1])
        gone = weakref.ref(asset)
        del asset
        gc.collect()
        self.assertIsNone(gone())

    def test_other_things(self):
        with self.assertRaisesRegex(TypeError, "source: expected a path or bytes, got int"):
            pliant.Asset.open(3)
        with self.assertRaises(pliant.Error) as raised:
            pliant.Asset.open("nowhere.pliant")
        self.assertEqual((raised.exception.number, raised.exception.exit_code), ("P2001", 3))
        self.assertIn("nowhere.pliant", str(raised.exception))
        for number, action in (("P2001", pliant.Asset.open), ("P4002", BAKED.save)):
            with self.assertRaises(pliant.Error) as raised:
                action("no\0where.pliant")
            self.assertEqual(raised.exception.number, number)

    def test_hostile_bytes(self):
        random = np.random.default_rng(1)
        damaged = [b"", b"x", b"PLIANT", bytes(1 << 16), random.bytes(4096)]
        damaged += [DATA[:size] for size in random.integers(0, len(DATA), 50)] + [DATA + b"\0"]
        for at in random.integers(0, len(DATA), 200):
            flipped = bytearray(DATA)
            flipped[at] ^= 1 << random.integers(8)
            damaged.append(bytes(flipped))
        refused = 0
        for data in damaged:
            try:
                pliant.Asset.open(data)
            except pliant.Error as error:
                refused += 1
                self.assertEqual((error.number, error.exit_code), ("P5102", 3))
        # A bit in the padding between chunks is covered by no checksum.
        self.assertGreaterEqual(refused, len(damaged) - 20)

    def test_damage_that_is_not_looked_for_does_no_harm(self):
        random = np.random.default_rng(2)
        opened = 0
        for at in random.integers(0, len(DATA), 300):
            flipped = bytearray(DATA)
            flipped[at] ^= 0xFF
            try:
                asset = pliant.Asset.open(bytes(flipped), verify=False)
            except pliant.Error:
                continue
            opened += 1
            shape = asset.blend([1, 1])
            asset.normals(np.nan_to_num(shape, posinf=0, neginf=0))
            len(asset.names), asset.faces, asset.triangles, repr(asset)
            try:
                self.assertIsInstance(asset.certificate, dict)
            except pliant.Error as error:
                self.assertEqual(error.number, "P5103")
        self.assertGreater(opened, 20)

    def test_deep_certificate(self):
        blob = bytearray(DATA)
        for entry in range(64, 64 + 32 * struct.unpack_from("<I", blob, 24)[0], 32):
            tag, _, offset, size = struct.unpack_from("<4sIQQ", blob, entry)
            if tag == b"CERT":
                blob[offset:offset + size] = b"[" * size
        asset = pliant.Asset.open(bytes(blob), verify=False)
        with self.assertRaises(pliant.Error) as caught:
            asset.certificate
        self.assertEqual(caught.exception.number, "P5103")

    def test_older_formats(self):
        for file in sorted(GOLDEN.glob("*.pliant")):
            asset = pliant.Asset.open(file)
            blends = asset.blend(np.eye(asset.weight_count))
            self.assertEqual(blends.shape, (asset.weight_count, asset.vertex_count, 3), file)
            self.assertTrue(np.isfinite(blends).all())
            self.assertLess(asset.faces.max(), asset.vertex_count)


class UsingAssets(unittest.TestCase):
    def test_facts(self):
        self.assertEqual((BAKED.pose_count, BAKED.vertex_count, BAKED.dimension), (2, len(POSES[0]), 3))
        self.assertEqual(BAKED.names, ["pose_0", "pose_1"])
        self.assertTrue((BAKED.faces == FACES).all() and BAKED.faces.dtype == np.uint32)
        self.assertEqual(BAKED.certificate["vertices"], len(POSES[0]))
        self.assertIn("seconds", BAKED.report)
        self.assertIsNone(pliant.Asset.open(DATA).report)
        self.assertEqual(len(BAKED), len(DATA))
        self.assertIn("2 poses (pose_0, pose_1), 112 vertices, d = 3", repr(BAKED))

    def test_shapes_of_results(self):
        n, d = BAKED.vertex_count, BAKED.dimension
        for weights, lead in (([1, 2], ()), ([[1, 2]], (1,)), (np.ones((5, 2), np.int8), (5,)), (np.zeros((0, 2)), (0,))):
            q = BAKED.coordinates(weights)
            shape = BAKED.blend(weights)
            self.assertEqual((q.shape, q.dtype), ((*lead, d), np.float32))
            self.assertEqual((shape.shape, shape.dtype), ((*lead, n, 3), np.float32))
            self.assertEqual(BAKED.reconstruct(q).tobytes(), shape.tobytes())
            self.assertEqual(BAKED.reconstruct(q, 3, 7).tobytes(), shape[..., 3:10, :].tobytes())
            self.assertEqual(BAKED.reconstruct(q, n).shape, (*lead, 0, 3))
            self.assertEqual(BAKED.normals(shape).shape, shape.shape)

    def test_poses_come_back(self):
        for k, shape in enumerate(BAKED.blend(np.eye(2))):
            best = POSES[k] - POSES[k].mean(0)  # blends are aligned to the first pose
            turned = shape - shape.mean(0)
            u, _, vt = np.linalg.svd(turned.T @ best)
            self.assertLess(np.abs(turned @ (u @ vt) - best).max(), 0.01)
        lengths = np.linalg.norm(BAKED.normals(BAKED.blend([1, 0])), axis=1)
        self.assertLess(np.abs(lengths - 1).max(), 1e-5)

    def test_wrong_weights(self):
        for weights, kind, text in (([1, 1, 1], ValueError, r"weights: expected \(2,\) or \(k, 2\)"),
                                    ([[1], [1]], ValueError, "weights"), ([1j, 1], TypeError, "got .2,. complex128"),
                                    (["a", "b"], TypeError, "weights"), (1.0, ValueError, r"got \(\) float64"),
                                    ([1, -1], pliant.Error, "P1204"), ([0, 0], pliant.Error, "P1204"),
                                    ([np.nan, 1], pliant.Error, "P1204"), ([[1, 1], [0, 1e300]], pliant.Error, "of row 1")):
            with self.assertRaisesRegex(kind, text):
                BAKED.blend(weights)
        with self.assertRaisesRegex(ValueError, r"q: expected \(3,\) or \(k, 3\)"):
            BAKED.reconstruct([1, 2])
        for first, count in ((-1, None), (113, None), (0, 113), (5, -1)):
            with self.assertRaisesRegex(ValueError, "first: |count: "):
                BAKED.reconstruct([0, 0, 0], first, count)
        with self.assertRaisesRegex(ValueError, r"positions: expected \(112, 3\)"):
            BAKED.normals(np.zeros((5, 3)))

    def test_many_threads(self):
        weights = np.random.default_rng(4).random((64, 2))
        expected = BAKED.blend(weights)
        with ThreadPoolExecutor(4) as threads:
            for shape, wanted in zip(threads.map(BAKED.blend, weights), expected):
                self.assertEqual(shape.tobytes(), wanted.tobytes())

    def test_pickle(self):
        copy = pickle.loads(pickle.dumps(BAKED))
        self.assertEqual(bytes(copy), DATA)
        self.assertEqual(copy.report, BAKED.report)
        error = pickle.loads(pickle.dumps(self.error_of(lambda: pliant.load_poses("nowhere.obj"))))
        self.assertIn(error.number, ("P2001", "P3001"))

    def error_of(self, action):
        with self.assertRaises(pliant.Error) as raised:
            action()
        return raised.exception

    def test_save(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "a.pliant")
            file.write_bytes(b"old")
            BAKED.save(file)
            self.assertEqual(file.read_bytes(), DATA)
            self.assertEqual(os.listdir(folder), ["a.pliant"])
            self.assertEqual(pliant.Asset.open(str(file)).blend([1, 1]).tobytes(), BAKED.blend([1, 1]).tobytes())
            error = self.error_of(lambda: BAKED.save(Path(folder, "no/where.pliant")))
            self.assertTrue(error.number.startswith("P40"), error)
            self.assertEqual(error.exit_code, 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
