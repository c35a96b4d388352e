"""Python and the command line are one baker: the same poses and options give the same bytes, blends and averages, to the
bit. PLIANT_TOOL names the tool, and was built from the same tree."""
import json
import os
import re
import subprocess
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np
import pliant
import shapes

TOOL = os.environ["PLIANT_TOOL"]
QUICK = {"dim": 3, "elements": 18, "check_samples": 2, "fresh_samples": 1}
POSES, FACES = shapes.tubes()
BARS, TETS = shapes.bars()

# Of the command line alone: files to write, its own output.
NO_ARGUMENTS = {"help", "output", "report", "quiet", "config", "print_config", "depfile", "stamp", "dry_run", "json",
                "verbose"}
# Of Python alone: what files bring with them there, and what a caller wants.
NO_OPTIONS = {"poses", "faces", "tets", "names", "progress"}


def tool(*arguments, code=0):
    done = subprocess.run([TOOL, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"pliant {arguments} ended with {done.returncode}: {done.stderr}")
    return done


def as_options(options):
    words = []
    for name, value in options.items():
        words += ["--" + name.replace("_", "-")] + ([] if value is True else [str(value)])
    return words


class SameAsTool(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def bake(self, files, options, *more):
        out = self.folder / "tool.pliant"
        tool("bake", *files, "-o", out, "--quiet", *as_options(options), *more)
        return out.read_bytes()

    def obj_files(self, poses=POSES, faces=FACES):
        return [shapes.write_obj(self.folder / f"p{k}.obj", shape, faces) for k, shape in enumerate(poses)]

    def test_surface(self):
        files = self.obj_files()
        report = self.folder / "report.json"
        expected = self.bake(files, QUICK, "--report", report)
        asset = pliant.bake(POSES, FACES, names=["p0", "p1"], **QUICK)
        self.assertEqual(bytes(asset), expected)
        self.assertEqual(bytes(pliant.bake(pliant.load_poses(files), threads=1, **QUICK)), expected)
        told, made = json.loads(report.read_text()), asset.report
        self.assertEqual(told.pop("asset"), "tool.pliant")
        self.assertEqual(set(told.pop("seconds")), set(made.pop("seconds")))
        self.assertEqual(made, told)
        told.pop("cubature_residual"), told.pop("warnings")
        self.assertEqual(asset.certificate, told)
        self.blends_are_those_of_tool(asset)

    def blends_are_those_of_tool(self, asset):
        weights = np.array([[1, 1], [0.3, 0.9], [1, 0], [0.35, 0.85]])
        file, out, path = self.folder / "a.pliant", self.folder / "b.ply", self.folder / "path.csv"
        asset.save(file)
        together = asset.blend(weights)
        for row, shape in zip(weights, together):
            tool("blend", file, "--weights", ",".join(map(str, row)), "--all", "-o", out)
            self.assertEqual(shape.tobytes(), shapes.read_ply(out).tobytes())
            self.assertEqual(shape.tobytes(), asset.blend(row).tobytes())
        path.write_text("\n".join(",".join(map(str, row)) for row in weights))
        tool("blend", file, "--path", path, "--all", "-o", self.folder / "f%d.ply")
        for k, shape in enumerate(asset.blend(weights, continuous=True)):
            self.assertEqual(shape.tobytes(), shapes.read_ply(self.folder / f"f{k}.ply").tobytes())

    def test_options_reach_the_baker(self):
        for options in ({"material": "arap", "seed": 7, "position_error": 0, "subspace": "krylov", "ritz": 1,
                         "cubature": "nn-htp", "tolerance": 0.9, "solver": "eigen", "weld": 0, "tolerance_max": 1.0},
                        {"no_align": True}):
            expected = self.bake(self.obj_files(), {**QUICK, **options})
            self.assertEqual(bytes(pliant.bake(POSES, FACES, names=["p0", "p1"], **QUICK, **options)), expected)

    def test_polygons_of_one_and_of_several_sizes(self):
        faces = shapes.quads(FACES)
        files = self.obj_files(POSES, faces)
        expected = self.bake(files, QUICK)
        asset = pliant.bake(POSES, faces, names=["p0", "p1"], **QUICK)
        self.assertEqual(bytes(asset), expected)
        self.assertTrue((asset.faces == faces).all())
        self.assertEqual(asset.triangles.shape, (2 * len(faces), 3))
        for file in files:  # the first quad as two triangles
            lines = Path(file).read_text().splitlines()
            first = next(k for k, line in enumerate(lines) if line.startswith("f "))
            a, b, c, d = lines[first].split()[1:]
            lines[first:first + 1] = [f"f {a} {b} {c}", f"f {a} {c} {d}"]
            Path(file).write_text("\n".join(lines))
        mixed = pliant.load_poses(files)
        self.assertEqual(mixed.faces.shape, (2 * len(faces), 3))
        self.assertEqual(bytes(pliant.bake(mixed, **QUICK)), self.bake(files, QUICK))

    def test_solid(self):
        files = [shapes.write_medit(self.folder / f"p{k}.mesh", shape, TETS) for k, shape in enumerate(BARS)]
        options = {"dim": 3, "check_samples": 2, "fresh_samples": 1}
        asset = pliant.bake(BARS, tets=TETS, names=["p0", "p1"], **options)
        self.assertEqual(bytes(asset), self.bake(files, options))
        loaded = pliant.load_poses(files)
        self.assertTrue((loaded.positions == BARS).all() and (loaded.tets == TETS).all() and loaded.faces.shape == (0, 3))
        self.blends_are_those_of_tool(asset)  # in the order of the input
        self.assertLess(np.abs(asset.blend([1, 0]) - BARS[0]).max(), 1e-3)
        part = asset.reconstruct(asset.coordinates([1, 1]), 5, 20)
        self.assertEqual(part.tobytes(), asset.blend([1, 1])[5:25].tobytes())
        normals = asset.normals(asset.blend([1, 0]))
        inside = np.setdiff1d(np.arange(len(BARS[0])), asset.faces)
        self.assertTrue(len(inside) and (normals[inside] == (0, 0, 1)).all())
        corners = BARS[0][asset.faces]  # outward
        outward = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        self.assertTrue((np.einsum("ij,ij->i", outward, normals[asset.faces[:, 0]]) > 0).all())

    def test_surface_on_solid(self):
        skin, faces = shapes.tube(0, rings=9, sides=12)
        skin = skin * (0.6, 0.8, 0.8)
        files = [shapes.write_medit(self.folder / f"p{k}.mesh", shape, TETS) for k, shape in enumerate(BARS)]
        drawn = shapes.write_obj(self.folder / "skin.obj", skin, faces)
        options = {"dim": 3, "check_samples": 2, "fresh_samples": 1}
        expected = self.bake(files, options, "--surface", drawn)
        for surface in (drawn, (skin, faces)):
            asset = pliant.bake(BARS, tets=TETS, names=["p0", "p1"], surface=surface, **options)
            self.assertEqual(bytes(asset), expected)
        self.assertEqual(asset.blend([1, 1]).shape, skin.shape)
        self.assertTrue((asset.faces == faces).all())

    def test_gltf(self):
        more = shapes.tube(-1.0)[0]
        file = shapes.write_glb(self.folder / "t.glb", POSES[0], FACES, {"bent": POSES[1], "back": more})
        poses = pliant.load_poses(file)
        self.assertEqual(poses.names, ["t", "bent", "back"])
        self.assertLess(np.abs(poses.positions - np.stack([*POSES, more])).max(), 1e-6)
        choice = [f"{file}#rest", f"{file}#target=bent"]
        asset = pliant.bake(pliant.load_poses(choice), **QUICK)
        self.assertEqual(bytes(asset), self.bake(choice, QUICK))
        without = pliant.bake(pliant.load_poses(choice), no_scene=True, **QUICK)
        self.assertLess(len(without), len(asset))
        with self.assertRaises(pliant.Error) as raised:
            pliant.load_poses(f"{file}#target=nobody")
        self.assertEqual(raised.exception.number, "P1212")

    def test_average(self):
        files, out = self.obj_files(), self.folder / "average.ply"
        weights = np.array([[1, 1], [3, 1]])
        made = pliant.average(POSES, FACES, weights)
        self.assertEqual((made.shape, made.dtype), ((2, *POSES[0].shape), np.float64))
        for row, shape in zip(weights, made):
            tool("average", *files, "--weights", ",".join(map(str, row)), "-o", out)
            self.assertEqual(shape.astype(np.float32).tobytes(), shapes.read_ply(out).tobytes())
        one = pliant.average(pliant.load_poses(files), weights=weights[1], threads=1)
        self.assertEqual(one.tobytes(), made[1].tobytes())
        files = [shapes.write_medit(self.folder / f"p{k}.mesh", shape, TETS) for k, shape in enumerate(BARS)]
        tool("average", *files, "--weights", "1,2", "--all", "-o", out)
        solid = pliant.average(BARS, weights=[1, 2], tets=TETS)
        self.assertEqual(solid.astype(np.float32).tobytes(), shapes.read_ply(out).tobytes())
        self.assertEqual(pliant.average(POSES, FACES, np.zeros((0, 2))).shape, (0, *POSES[0].shape))

    def test_average_of_seams(self):
        seam = np.concatenate([POSES, POSES[:, FACES[:1, 0]]], 1)
        faces = FACES.copy()
        faces[0, 0] = len(POSES[0])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pliant.PliantWarning)
            made = pliant.average(seam, faces, [1, 1])
        self.assertEqual(made.shape, seam[0].shape)
        self.assertEqual(made[-1].tobytes(), made[FACES[0, 0]].tobytes())

    def test_fixed_vertices(self):
        held = BARS.copy()
        left = np.flatnonzero(held[0][:, 0] < -1.4)
        held[1][left] = held[0][left]
        files = [shapes.write_medit(self.folder / f"p{k}.mesh", shape, TETS) for k, shape in enumerate(held)]
        fix = self.folder / "fix.txt"
        fix.write_text("\n".join(map(str, left)))
        options = {"dim": 3, "check_samples": 2, "fresh_samples": 1}
        expected = self.bake(files, options, "--fix", fix)
        asset = pliant.bake(held, tets=TETS, names=["p0", "p1"], fix=left[::-1], **options)
        self.assertEqual(bytes(asset), expected)
        self.assertTrue((asset.blend([1, 3])[left] == held[0][left].astype(np.float32)).all())

    def test_missed_tolerance(self):
        options = {**QUICK, "dim": 1, "tolerance": 1e-7}
        with self.assertRaises(pliant.ToleranceError) as raised:
            pliant.bake(POSES, FACES, **options)
        error = raised.exception
        self.assertEqual((error.number, error.exit_code, error.asset), ("P4405", 4, None))
        self.assertNotIn("--", error.hint)
        with self.assertRaises(pliant.ToleranceError) as raised:
            pliant.bake(POSES, FACES, names=["p0", "p1"], best_effort=True, **options)
        out = self.folder / "tool.pliant"
        tool("bake", *self.obj_files(), "-o", out, *as_options(options), "--best-effort", code=4)
        self.assertEqual(bytes(raised.exception.asset), out.read_bytes())
        self.assertFalse(raised.exception.asset.report["meets_tolerance"])

    def test_default_tolerance_is_an_aim(self):
        with self.assertWarns(pliant.PliantWarning) as told:
            asset = pliant.bake(POSES, FACES, position_error=1e-2, check_samples=2, fresh_samples=1)
        self.assertEqual(told.warning.finding.number, "P4404")
        self.assertIn(4404, [warning["number"] for warning in asset.report["warnings"]])

    def test_every_option_of_the_tool_is_an_argument(self):
        import inspect
        # Explanations, which may begin with an option, too, are further to the right.
        named = re.findall(r"^ {1,4}(?:-\w, ?)?--([a-z][a-z-]+)", tool("bake", "--help").stdout, re.M)
        listed = {name.replace("-", "_") for name in named}
        self.assertEqual(set(inspect.signature(pliant.bake).parameters) - NO_OPTIONS, listed - NO_ARGUMENTS)


if __name__ == "__main__":
    unittest.main(verbosity=2)
