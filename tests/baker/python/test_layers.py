"""Layers in Python: baked from arrays, blended by number and by name, as on the command line, and what is refused."""
import os
import pickle
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pliant
import shapes

TOOL = os.environ["PLIANT_TOOL"]
QUICK = {"dim": 5, "elements": 24, "check_samples": 6, "fresh_samples": 6}
NAMES = ["rest", "left", "right"]


def layered_tube(left=0.0, right=0.0):
    """A tube along x whose ends bend, each on its own."""
    positions, faces = shapes.tube(0.0, rings=17)
    out = positions.copy()
    for side, angle in ((-1, left), (1, right)):
        moved = side * positions[:, 0] > 0.5
        if angle:
            radius, along = 1 / angle, side * positions[moved, 0] - 0.5
            across = radius - positions[moved, 1]
            out[moved, 0] = side * (0.5 + across * np.sin(along * angle))
            out[moved, 1] = radius - across * np.cos(along * angle)
    return out, faces


def layered_poses():
    made = [layered_tube(*angles) for angles in ((0, 0), (0.9, 0), (0, 0.9))]
    return np.stack([positions for positions, _ in made]), made[0][1]


POSES, FACES = layered_poses()
BAKED = pliant.bake(POSES, FACES, names=NAMES, blend="layers", range={"right": (-0.5, 1.5)}, **QUICK)


class Layers(unittest.TestCase):
    def refuse(self, kind, text, action):
        with self.assertRaises(kind) as raised:
            action()
        self.assertIn(text, str(raised.exception))
        return raised.exception

    def test_facts(self):
        self.assertTrue(BAKED.has_layers)
        self.assertEqual((BAKED.pose_count, BAKED.weight_count), (3, 2))
        self.assertEqual((BAKED.names, BAKED.weight_names), (NAMES, ["left", "right"]))
        self.assertEqual(BAKED.ranges, {"left": (0, 1), "right": (-0.5, 1.5)})
        self.assertIn("2 layers on rest (left, right)", repr(BAKED))
        self.assertEqual(pickle.loads(pickle.dumps(BAKED)).ranges, BAKED.ranges)
        averages = pliant.bake(POSES, FACES, names=NAMES, no_align=True, **QUICK)
        self.assertFalse(averages.has_layers)
        self.assertEqual((averages.weight_names, averages.ranges["rest"]), (NAMES, (0, 1)))
        self.assertEqual(averages.blend({"left": 2}).tobytes(), averages.blend([0, 2, 0]).tobytes())
        self.refuse(pliant.Error, "P1204", lambda: averages.blend({}))

    def test_blends(self):
        both = layered_tube(0.9, 0.9)[0]
        blend = BAKED.blend({"left": 1, "right": 1})
        self.assertLess(np.abs(blend - both).max(), 0.1)
        self.assertLess(np.abs(BAKED.blend([0, 0]) - POSES[0]).max(), 2e-3)
        self.assertLess(np.abs(BAKED.blend([0, 1]) - POSES[2]).max(), 2e-3)
        self.assertEqual(blend.tobytes(), BAKED.blend([1, 1]).tobytes())
        self.assertEqual(BAKED.blend({"right": -0.5}).tobytes(), BAKED.blend([0, -0.5]).tobytes())
        self.assertEqual(BAKED.blend({}).tobytes(), BAKED.blend([0, 0]).tobytes())
        self.assertEqual(BAKED.coordinates({"left": 1}).tobytes(), BAKED.coordinates([1, 0]).tobytes())
        steps = np.linspace(0, 1, 4)
        frames = BAKED.blend({"left": steps, "right": 1}, continuous=True)
        rows = np.stack([steps, np.ones(4)], 1)
        self.assertEqual(frames.tobytes(), BAKED.blend(rows, continuous=True).tobytes())

    def test_same_as_tool(self):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            files = [shapes.write_obj(folder / f"{pose}.obj", shape, FACES) for pose, shape in zip(NAMES, POSES)]
            options = [word for key, value in QUICK.items() for word in ("--" + key.replace("_", "-"), str(value))]
            self.tool("bake", *files, "-o", folder / "a.pliant", "-q", "--blend", "layers", "--range", "right=-0.5:1.5",
                      *options)
            self.assertEqual(bytes(BAKED), (folder / "a.pliant").read_bytes())
            loaded = pliant.load_poses(files, blend="layers")
            again = pliant.bake(loaded, blend="layers", range={"right": (-0.5, 1.5)}, **QUICK)
            self.assertEqual(bytes(again), bytes(BAKED))
            self.tool("bake", *files, "-o", folder / "b.pliant", "-q", "--blend", "layers", "--range", "0:2", *options)
            wide = pliant.bake(loaded, blend="layers", range=(0, 2), **QUICK)
            self.assertEqual(bytes(wide), (folder / "b.pliant").read_bytes())
            made = pliant.average(POSES, FACES, [[1, 1], [-0.5, 1.5]], blend="layers")
            self.assertLess(np.abs(made[0] - layered_tube(0.9, 0.9)[0]).max(), 1e-3)
            for weights, shape in zip(("1,1", "-0.5,1.5"), made):
                self.tool("average", *files, "--blend", "layers", f"--weights={weights}", "-o", folder / "w.ply")
                self.assertEqual(shape.astype(np.float32).tobytes(), shapes.read_ply(folder / "w.ply").tobytes())

    def tool(self, *words):
        done = subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True)
        self.assertIn(done.returncode, (0, 4), done.stderr)

    def test_many_layers(self):
        many = np.stack([POSES[0]] + [layered_tube(*((0.3 + 0.01 * k, 0)[::1 - 2 * (k % 2)]))[0] for k in range(64)])
        one = pliant.average(many, FACES, np.eye(64)[3], blend="layers")
        self.assertLess(np.abs(one - many[4]).max(), 1e-3)
        self.refuse(ValueError, '2 to 64 poses, got (65, 136, 3); blend="layers" takes 65', lambda: pliant.bake(many, FACES))
        self.refuse(ValueError, "2 to 65 poses, got (66, ", lambda: pliant.bake(
            np.concatenate([many, many[:1]]), FACES, blend="layers"))

    def test_files_of_many_layers(self):
        with tempfile.TemporaryDirectory() as name:
            targets = {f"layer{k}": POSES[1 + k % 2] for k in range(64)}
            file = shapes.write_glb(Path(name) / "t.glb", POSES[0], FACES, targets)
            error = self.refuse(pliant.Error, "the limit is 64", lambda: pliant.load_poses(file, blend="average"))
            self.assertEqual(error.number, "P3002")
            poses = pliant.load_poses(file)
            self.assertEqual((len(poses.names), poses.blend), (65, "layers"))
            self.refuse(ValueError, 'with 2 to 64 poses, got 65; blend="layers"',
                        lambda: pliant.average(poses, weights=[1], blend="average"))

    def test_files_mean_layers(self):
        with tempfile.TemporaryDirectory() as name:
            file = shapes.write_glb(Path(name) / "t.glb", POSES[0], FACES, dict(zip(NAMES[1:], POSES[1:])))
            options = [word for key, value in QUICK.items() for word in ("--" + key.replace("_", "-"), str(value))]
            for choice, blend in ((file, "layers"), ([f"{file}#rest", f"{file}#target={NAMES[1]}"], "average")):
                poses = pliant.load_poses(choice)
                self.assertEqual(poses.blend, blend)
                words = [choice] if blend == "layers" else choice
                self.tool("bake", *words, "-o", Path(name) / "t.pliant", "-q", *options)
                self.assertEqual(bytes(pliant.bake(poses, **QUICK)), (Path(name) / "t.pliant").read_bytes())

    def test_wrong_arguments(self):
        bake = {"blend": "layers", "names": NAMES, **QUICK}
        for kind, text, options in (
                (ValueError, "blend: expected one of 'average', 'layers', got 'sum'", {"blend": "sum"}),
                (ValueError, "range: expected (low, high), or a dict with one for each layer", {"range": (0, 1, 2)}),
                (TypeError, "range of 'left': expected (low, high)", {"range": {"left": ("a", "b")}}),
                (TypeError, "range: expected names of layers as keys, got 1", {"range": {1: (0, 1)}}),
                (pliant.Error, "P1232: there is no layer 'top' for range\n  hint: the layers are left, right",
                 {"range": {"top": (0, 1)}}),
                (pliant.Error, "P1231: range left=1:2 is empty, does not hold 0", {"range": {"left": (1, 2)}}),
                (pliant.Error, "P1233: range belongs to blend layers", {"range": (0, 1), "blend": "average"})):
            self.refuse(kind, text, lambda options=options: pliant.bake(POSES, FACES, **{**bake, **options}))

    def test_wrong_weights(self):
        for kind, text, weights in (
                (ValueError, "weights: the asset has no 'smile'; the names are left, right", {"smile": 1}),
                (ValueError, "weights: the asset has no 'rest'", {"rest": 1}),
                (ValueError, "weights: expected by name a number or (k,), the same k for all, got left (2,), right (3,)",
                 {"left": [1, 2], "right": [1, 2, 3]}),
                (ValueError, "weights: expected (2,) or (k, 2): one per layer, got (3,)", [1, 1, 1]),
                (TypeError, "weights: expected (2,)", {"left": "much"}),
                (pliant.Error, "P1204", [np.nan, 1])):
            self.refuse(kind, text, lambda weights=weights: BAKED.blend(weights))
        error = self.refuse(pliant.Error, "P1204", lambda: BAKED.blend({"left": np.inf}))
        self.assertEqual(error.hint, "weights are finite")
        self.refuse(ValueError, "weights: expected (2,) or (k, 2): one per layer, got (3,)",
                    lambda: pliant.average(POSES, FACES, [1, 1, 1], blend="layers"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
