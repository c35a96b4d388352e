"""pliant.show() in polyscope without a display: what is registered, what the sliders do, a picture."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import pliant
import shapes
from pliant import _show

try:
    import polyscope
except ImportError:
    print("skipped: polyscope is not installed")
    sys.exit(77)

POSES, FACES = shapes.tubes((0.0, 2.2))
QUICK = {"dim": 3, "elements": 18, "check_samples": 1, "fresh_samples": 1}
TUBE = pliant.bake(POSES, FACES, names=["straight", "bent"], **QUICK)
LAYERS = pliant.bake(POSES, FACES, names=["straight", "bent"], blend="layers", **QUICK)


class Hand:
    """What of imgui draws the sliders, with a hand that moves them."""

    def __init__(self, wanted):
        self.wanted, self.seen, self.is_pressed = wanted, {}, False

    def Text(self, text):  # noqa: N802
        self.text = text

    def SliderFloat(self, label, value, low, high):  # noqa: N802
        name = label.split("##")[0]
        self.seen[name] = (low, high)
        return name in self.wanted, self.wanted.get(name, value)

    def Button(self, label):  # noqa: N802
        return self.is_pressed


def start_headless():
    try:
        _show._polyscope(is_headless=True)
    except Exception as error:  # polyscope's own, where there is no EGL either
        print("skipped: polyscope cannot draw here:", error)
        sys.exit(77)


class Show(unittest.TestCase):
    def setUp(self):
        polyscope.remove_all_structures()

    def test_both_shapes_are_registered(self):
        viewer = _show.Viewer(polyscope, TUBE, None, True)
        self.assertEqual(viewer.weights.tolist(), [0.5, 0.5])
        self.assertEqual(polyscope.get_surface_mesh("elastic").n_vertices(), len(POSES[0]))
        self.assertEqual(polyscope.get_surface_mesh("linear").n_faces(), len(FACES))
        _show.Viewer(polyscope, TUBE, {"bent": 1}, True)
        gap = polyscope.get_surface_mesh("linear").get_position()
        self.assertGreater(np.abs(gap).max(), np.ptp(POSES[:, :, 1], axis=1).max())

    def test_one_shape(self):
        _show.Viewer(polyscope, TUBE, None, False)
        self.assertTrue(polyscope.has_surface_mesh("elastic"))
        self.assertFalse(polyscope.has_surface_mesh("linear"))

    def test_sliders_move_both_shapes(self):
        for asset, limits in ((TUBE, (0, 1)), (LAYERS, (-0.5, 1.5))):
            viewer = _show.Viewer(polyscope, asset, None, True)
            moved = {}
            for name, mesh in viewer._meshes.items():
                mesh.update_vertex_positions = lambda shape, name=name: moved.update({name: shape})
            hand = Hand({})
            viewer.draw_panel(hand)
            self.assertEqual(set(hand.seen), set(asset.weight_names))
            self.assertEqual(hand.seen["bent"], limits)
            self.assertFalse(moved)
            viewer.draw_panel(Hand({"bent": 0.9}))
            weights = asset._rows({"bent": 0.9})[0][0] if asset is LAYERS else [0.5, 0.9]
            self.assertEqual(moved["elastic"].tobytes(), asset.blend(weights).tobytes())
            self.assertEqual(moved["linear"].tobytes(), asset.linear_blend(weights).tobytes())
            hand.is_pressed = True
            viewer.draw_panel(hand)
            self.assertEqual(viewer.weights.tolist(), [0.5, 0.5] if asset is TUBE else [0])

    def test_averages_with_no_weights_stay(self):
        viewer = _show.Viewer(polyscope, TUBE, None, True)
        viewer.draw_panel(Hand({"straight": 0.0, "bent": 0.0}))
        self.assertEqual(viewer.weights.tolist(), [0, 0])

    def test_wrong_weights(self):
        with self.assertRaisesRegex(ValueError, r"weights: expected \(2,\), got \(2, 2\)"):
            _show.Viewer(polyscope, TUBE, np.eye(2), True)

    def test_picture(self):
        try:
            from matplotlib.image import imread
        except ImportError:
            self.skipTest("matplotlib is not installed")
        with tempfile.TemporaryDirectory() as folder:
            picture = Path(folder, "tube.png")
            pliant.show(TUBE, picture=picture)
            pixels = imread(picture)[..., :3]
        # Both colours, one above the other, and nothing cut off at the rim.
        blue = np.argwhere(pixels[..., 2] > pixels[..., 0] + 0.1)
        brown = np.argwhere(pixels[..., 0] > pixels[..., 2] + 0.1)
        self.assertGreater(min(len(blue), len(brown)), 0.01 * pixels[..., 0].size)
        self.assertTrue(brown[:, 0].max() < blue[:, 0].min() or blue[:, 0].max() < brown[:, 0].min())
        self.assertTrue((np.concatenate([pixels[0], pixels[-1]]) > 0.99).all())

    def test_window(self):
        drawn = []
        panel, window = _show.Viewer.draw_panel, polyscope.show

        def draw_panel(viewer, imgui):
            panel(viewer, imgui)
            drawn.append(imgui.GetCursorPosY())

        try:
            _show.Viewer.draw_panel, polyscope.show = draw_panel, polyscope.frame_tick  # one frame, and closed
            pliant.show(TUBE)
        finally:
            _show.Viewer.draw_panel, polyscope.show = panel, window
        self.assertGreater(min(drawn), 80)  # text, two sliders and a button

    def test_without_polyscope(self):
        program = "import sys; sys.modules['polyscope'] = None; import pliant; pliant.show(None)"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertIn("ImportError: pliant.show needs polyscope: pip install 'pliant[show]'", done.stderr)


if __name__ == "__main__":
    start_headless()
    unittest.main(verbosity=2)
