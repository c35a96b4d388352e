"""Meshes of trimesh and meshio as poses: stand-ins with their attributes, and those of the packages where installed."""
import sys
import types
import unittest

import numpy as np
import pliant
import shapes

POSES, FACES = shapes.tubes()
SOLID, TETS = shapes.bars()
QUICK = {"dim": 3, "elements": 18, "check_samples": 1, "fresh_samples": 1}


def triangles(positions, faces=FACES):
    return types.SimpleNamespace(vertices=positions, faces=faces)


def cells(positions, **kinds):
    return types.SimpleNamespace(points=positions, cells_dict=kinds)


class Meshes(unittest.TestCase):
    def test_nothing_is_imported(self):
        self.assertFalse({"trimesh", "meshio"} & set(sys.modules))

    def test_they_are_the_poses_of_arrays(self):
        expected = bytes(pliant.bake(POSES, FACES, **QUICK))
        self.assertEqual(bytes(pliant.bake([triangles(x) for x in POSES], **QUICK)), expected)
        meshes = tuple(cells(x, triangle=FACES, line=[[0, 1]]) for x in POSES)
        self.assertEqual(bytes(pliant.bake(meshes, **QUICK)), expected)
        average = pliant.average([triangles(x) for x in POSES], weights=[1, 1])
        self.assertEqual(average.tobytes(), pliant.average(POSES, FACES, [1, 1]).tobytes())
        self.assertEqual(pliant.energy([triangles(x) for x in POSES]).value(POSES[0]),
                         pliant.energy(POSES, FACES).value(POSES[0]))

    def test_quads_and_solids(self):
        quads = shapes.quads(FACES)
        halves = np.concatenate([FACES[:2], quads[1:][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)])
        mixed = pliant.energy([cells(x, triangle=FACES[:2], quad=quads[1:]) for x in POSES])
        self.assertEqual(mixed.value(POSES[0]), pliant.energy(POSES, halves).value(POSES[0]))
        only = pliant.energy([cells(x, quad=quads) for x in POSES])
        self.assertEqual(only.value(POSES[0]), pliant.energy(POSES, quads).value(POSES[0]))
        solid = pliant.energy([cells(x, tetra=TETS, triangle=[[0, 1, 2]]) for x in SOLID])
        self.assertEqual(solid.value(SOLID[0]), pliant.energy(SOLID, tets=TETS).value(SOLID[0]))

    def test_a_surface_of_a_solid(self):
        skin, faces = shapes.bars(cells=(3, 1, 1))[0][0], np.array([[0, 1, 2], [1, 2, 3]])
        options = {"tets": TETS, "dim": 4, "check_samples": 1, "fresh_samples": 1}
        expected = bytes(pliant.bake(SOLID, surface=(skin, faces), **options))
        self.assertEqual(bytes(pliant.bake(SOLID, surface=triangles(skin, faces), **options)), expected)

    def test_wrong_meshes(self):
        for wrong, kind, text in (
            ([triangles(POSES[0]), POSES[1]], TypeError, r"poses\[1\]: expected a mesh as the others are, got ndarray"),
            ([triangles(POSES[0]), triangles(POSES[1][:-1])], ValueError,
             r"poses\[1\]: has 111 vertices, poses\[0\] has 112"),
            ([triangles(POSES[0]), triangles(POSES[1], FACES[::-1])], ValueError,
             r"poses\[1\]: has other faces than poses\[0\]; .*process=False"),
            ([triangles(POSES[0][:, :2])] * 2, ValueError, r"poses\[0\]: expected positions \(n, 3\), got \(112, 2\)"),
            ([cells(POSES[0], tetra10=[range(10)])] * 2, ValueError,
             r"poses\[0\]: expected cells 'triangle', 'quad' or 'tetra', got 'tetra10'"),
            ([cells(x, tetra=TETS, hexahedron=[range(8)]) for x in SOLID], ValueError, "or 'tetra', got 'hexahedron'"),
            ([cells(POSES[0], line=[[0, 1]])] * 2, ValueError, "or 'tetra', got 'line'"),
            ([triangles(POSES[0])], ValueError, "with 2 to 64 poses"),
        ):  # fmt: skip
            with self.assertRaisesRegex(kind, text):
                pliant.bake(wrong)
        with self.assertRaisesRegex(TypeError, "meshes have faces or tets of their own: give none"):
            pliant.bake([triangles(x) for x in POSES], FACES)


class Packages(unittest.TestCase):
    """After the others: these import the packages."""

    def test_trimesh(self):
        try:
            import trimesh
        except ImportError:
            self.skipTest("trimesh is not installed")
        meshes = [trimesh.Trimesh(x, FACES, process=False) for x in POSES]
        self.assertEqual(bytes(pliant.bake(meshes, **QUICK)), bytes(pliant.bake(POSES, FACES, **QUICK)))
        back = trimesh.Trimesh(pliant.bake(meshes, **QUICK).blend([1, 1]), FACES, process=False)
        self.assertEqual(len(back.vertices), len(POSES[0]))

    def test_meshio(self):
        try:
            import meshio
        except ImportError:
            self.skipTest("meshio is not installed")
        solids = [meshio.Mesh(x, [("tetra", TETS[:100]), ("tetra", TETS[100:])]) for x in SOLID]
        self.assertEqual(pliant.energy(solids).value(SOLID[0]), pliant.energy(SOLID, tets=TETS).value(SOLID[0]))
        meshes = [meshio.Mesh(x, {"triangle": FACES}) for x in POSES]
        self.assertEqual(bytes(pliant.bake(meshes, **QUICK)), bytes(pliant.bake(POSES, FACES, **QUICK)))


if __name__ == "__main__":
    unittest.main(verbosity=2)
