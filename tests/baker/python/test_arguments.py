"""What is no array of the right shape and kind is refused before any work, by the name of the argument."""
import unittest
import warnings

import numpy as np
import pliant
import shapes

POSES, FACES = shapes.tubes()
BARS, TETS = shapes.bars()


class Arguments(unittest.TestCase):
    def refuse(self, kind, text, *arguments, **options):
        with self.assertRaises(kind) as raised:
            pliant.bake(*arguments, **options)
        self.assertIn(text, str(raised.exception))
        return raised.exception

    def test_poses(self):
        self.refuse(ValueError, "poses: expected (m, n, 3) float64, got (3, 100) int32", np.zeros((3, 100), np.int32), FACES)
        self.refuse(TypeError, "poses: expected (m, n, 3) float64, got (2, 5, 3) complex128", np.zeros((2, 5, 3), complex),
                    FACES)
        self.refuse(TypeError, "poses: expected (m, n, 3) float64, got (2, 2, 3) object", np.full((2, 2, 3), None), FACES)
        self.refuse(ValueError, "poses: expected (m, n, 3) float64, got something that is no array", [[[0, 0, 0]], [[1]]],
                    FACES)
        self.refuse(ValueError, "2 to 64 poses, got (1, ", POSES[:1], FACES)
        self.refuse(ValueError, "2 to 64 poses, got (65, ", np.zeros((65, 4, 3)), FACES)
        self.refuse(ValueError, "poses: expected (m, n, 3) float64 with vertices", np.zeros((2, 0, 3)), FACES)

    def test_cells(self):
        self.refuse(TypeError, "give either faces (f, 3) of a surface or tets (t, 4) of a solid", POSES)
        self.refuse(TypeError, "give either faces", POSES, FACES, tets=TETS)
        self.refuse(TypeError, "faces: expected (f, 3) integers, got (208, 3) float64", POSES, FACES.astype(float))
        self.refuse(ValueError, "faces: expected (f, 3) integers, got (624,) int64", POSES, FACES.ravel())
        self.refuse(ValueError, "faces: expected (f, 3) integers, got (208, 2) int64", POSES, FACES[:, :2])
        self.refuse(ValueError, "faces: there are none", POSES, FACES[:0])
        self.refuse(ValueError, "tets: expected (t, 4) integers, got (208, 3) int64", POSES, tets=FACES)
        self.refuse(ValueError, "faces: holds 18446744073709551615, which is no index", POSES,
                    FACES.astype(np.uint64) - np.uint64(1))

    def test_indices_that_are_no_vertices(self):
        for wrong in (112, -1, 2**40):
            faces = FACES.copy()
            faces[5, 1] = wrong
            error = self.refuse(pliant.Error, f"P2103: faces: face 5 uses vertex {wrong}", POSES, faces)
            self.assertEqual((error.number, error.exit_code), ("P2103", 3))
        tets = TETS.copy()
        tets[7, 0] = len(BARS[0])
        self.refuse(pliant.Error, "P2103: tets: ", BARS, tets=tets)

    def test_coordinates_that_are_no_numbers(self):
        for wrong, number in ((np.nan, "P2105"), (np.inf, "P2105"), (1e300, "P2113")):
            poses = POSES.copy()
            poses[1, 7, 2] = wrong
            error = self.refuse(pliant.Error, "poses[1]: vertex 7 has the coordinate", poses, FACES)
            self.assertEqual(error.number, number)
            self.assertTrue(error.hint)

    def test_poses_without_an_average(self):
        error = self.refuse(pliant.Error, "P3009", np.stack([POSES[0], POSES[0] + 1]), FACES)
        self.assertEqual((error.number, error.exit_code), ("P3009", 3))
        self.assertIn("hint: ", str(error))
        error = self.refuse(pliant.Error, "P1206", POSES, FACES, material="stvk")
        self.assertIn("material stvk is for solids", str(error))  # as Python spells it, not --material
        self.assertEqual(error.exit_code, 2)

    def test_options(self):
        self.refuse(ValueError, "tolerance: expected a number from 1e-08 to 1, got 5", POSES, FACES, tolerance=5)
        self.refuse(ValueError, "tolerance: expected a number", POSES, FACES, tolerance=float("nan"))
        self.refuse(TypeError, "dim: expected a whole number from 1 to 256, got 2.5", POSES, FACES, dim=2.5)
        self.refuse(ValueError, "dim: expected a whole number", POSES, FACES, dim=10**400)
        self.refuse(TypeError, "tolerance: expected a number", POSES, FACES, tolerance=10**400)
        self.refuse(TypeError, "tolerance: expected a number", POSES, FACES, tolerance="1e-3")
        self.refuse(TypeError, "threads: expected a whole number", POSES, FACES, threads=True)
        self.refuse(TypeError, "preview: expected True or False, got 'no'", POSES, FACES, preview="no")
        self.refuse(ValueError, "seed: expected a whole number", POSES, FACES, seed=-1)
        self.refuse(ValueError, "material: expected one of 'discrete-shells', 'arap', ", POSES, FACES, material="rubber")
        self.refuse(ValueError, "energy: expected one of 'auto', 'quartic', ", POSES, FACES, energy="")
        self.refuse(TypeError, "membrane: expected a string, got 3", POSES, FACES, membrane=3)
        self.refuse(TypeError, "progress: expected a callable", POSES, FACES, progress=3)
        self.refuse(TypeError, "unexpected keyword argument 'tolerence'", POSES, FACES, tolerence=1)
        self.refuse(ValueError, "names: expected 2 strings", POSES, FACES, names=["one"])
        self.refuse(ValueError, "zero character", POSES, FACES, names=["one", "t\0wo"])

    def test_fixed_vertices(self):
        self.refuse(ValueError, "fix: vertex 112 is to be fixed, the poses have 112", POSES, FACES, fix=[0, 1, 112])
        self.refuse(TypeError, "fix: expected (k,) vertex numbers", POSES, FACES, fix=[0.5])
        self.assertEqual(self.refuse(pliant.Error, "fix: 2 vertices are fixed", POSES, FACES, fix=[1, 0]).number, "P2604")
        self.assertEqual(self.refuse(pliant.Error, "poses[1]: vertex 0 is fixed", POSES, FACES, fix=[0, 1, 2]).number,
                         "P3013")

    def test_surface(self):
        self.refuse(TypeError, "surface: expected a path, a pair (positions, faces) or a mesh, got int", BARS, tets=TETS,
                    surface=3)
        self.refuse(ValueError, "surface positions: expected (s, 3) float64", BARS, tets=TETS, surface=(BARS, FACES))
        self.refuse(pliant.Error, "P1209: surface is for solids", POSES, FACES, surface=(POSES[0], FACES))
        far = self.refuse(pliant.Error, "surface[0]: vertex", BARS, tets=TETS, surface=(POSES[0] + 9, FACES))
        self.assertEqual(far.number, "P2606")

    def test_average(self):
        with self.assertRaisesRegex(TypeError, "average.. needs weights"):
            pliant.average(POSES, FACES)
        with self.assertRaisesRegex(ValueError, r"weights: expected \(2,\) or \(k, 2\): one per pose, got \(3,\) int64"):
            pliant.average(POSES, FACES, [1, 1, 1])
        with self.assertRaises(pliant.Error) as raised:
            pliant.average(POSES, FACES, [1, -1])
        self.assertEqual(raised.exception.number, "P1204")

    def test_files(self):
        with self.assertRaises(pliant.Error) as raised:
            pliant.load_poses(["nowhere.obj", "nowhere.ply"])
        self.assertEqual([f.number for f in raised.exception.findings], ["P2001", "P2001"])
        with self.assertRaises(pliant.Error) as raised:
            pliant.load_poses("nowhere.obj")
        self.assertEqual(raised.exception.exit_code, 3)

    def test_warnings_are_of_python(self):
        seam = np.concatenate([POSES, POSES[:, FACES[:1, 0]]], 1)  # a vertex twice, which is welded: P2220
        faces = FACES.copy()
        faces[0, 0] = 112
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            pliant.average(seam, faces, [1, 1])
        self.assertEqual([w.category for w in told], [pliant.PliantWarning] * len(told))
        self.assertIn("P2220", [w.message.finding.number for w in told])
        self.assertTrue(all(w.filename == __file__ for w in told), [w.filename for w in told])
        with warnings.catch_warnings():
            warnings.simplefilter("error", pliant.PliantWarning)
            with self.assertRaises(pliant.PliantWarning):
                pliant.average(seam, faces, [1, 1])

    def test_poses_aligned_in_spite_of_no_align(self):
        turned = POSES.copy()
        turned[1] = POSES[0] * [-1, 1, -1]  # by half a turn
        for work in (lambda: pliant.average(turned, FACES, [1, 1], no_align=True),
                     lambda: pliant.energy(turned, FACES, no_align=True)):
            with warnings.catch_warnings(record=True) as told:
                warnings.simplefilter("always")
                work()
            self.assertEqual([w.message.finding.number for w in told], ["P4413"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
