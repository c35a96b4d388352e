"""pliant.show() in polyscope without a display: what is registered, what the sliders do, a picture."""
import os
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

    def test_numbers_beyond_the_slider(self):
        viewer = _show.Viewer(polyscope, TUBE, {"bent": 3}, True)
        viewer.draw_panel(Hand({}))
        self.assertEqual(viewer.weights.tolist(), [0, 3])
        for typed, weight in ((-1.0, 0), (1e39, 1), (float("inf"), 1), (float("nan"), 0)):
            viewer.draw_panel(Hand({"straight": 0.5, "bent": typed}))
            self.assertEqual(viewer.weights.tolist(), [0.5, weight])

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

    def test_pictures_that_cannot_be_written(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, error in (("smile", ValueError), ("smile.jpg", ValueError), ("no/smile.png", FileNotFoundError)):
                with self.assertRaises(error):
                    pliant.show(TUBE, picture=Path(folder, name))
            whole, written = polyscope.screenshot, Path(folder, "smile.png")
            written.write_bytes(b"old")
            try:
                polyscope.screenshot = lambda name, **_: Path(name).write_bytes(b"half")  # as on a full disk
                with self.assertRaisesRegex(OSError, "cannot be written whole"):
                    pliant.show(TUBE, picture=written)
            finally:
                polyscope.screenshot = whole
            self.assertEqual(written.read_bytes(), b"old")
            self.assertEqual([path.name for path in Path(folder).iterdir()], ["smile.png"])

    def test_what_is_the_users_stays(self):
        polyscope.register_point_cloud("mine", POSES[0])
        program = (f"import pathlib, sys; sys.path[:0] = {sys.path!r}; import pliant\n"
                   "asset = pliant.Asset.open(pathlib.Path(sys.argv[1]).read_bytes())\n"
                   "pliant.show(asset, picture='a.png'); pliant.show(asset)")
        with tempfile.TemporaryDirectory() as folder:
            pliant.show(TUBE, picture=Path(folder, "tube.png"))
            TUBE.save(Path(folder, "tube.pliant"))
            Path(folder, "imgui.ini").write_text("[MyGame][settings]\nscore=5\n")
            environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
            done = subprocess.run([sys.executable, "-c", program, "tube.pliant"], cwd=folder, capture_output=True, text=True,
                                  timeout=60, env=environment)
            self.assertIn("RuntimeError: show: polyscope opens no window in this process", done.stderr)
            self.assertEqual(Path(folder, "imgui.ini").read_text(), "[MyGame][settings]\nscore=5\n")
            self.assertEqual(sorted(path.name for path in Path(folder).iterdir()),
                             ["a.png", "imgui.ini", "tube.pliant", "tube.png"])
        self.assertTrue(polyscope.has_point_cloud("mine"))

    def test_window(self):
        drawn = []
        panel, window, is_headless = _show.Viewer.draw_panel, polyscope.show, polyscope.is_headless

        def draw_panel(viewer, imgui):
            panel(viewer, imgui)
            drawn.append(imgui.GetCursorPosY())

        try:
            _show.Viewer.draw_panel, polyscope.show = draw_panel, polyscope.frame_tick  # one frame, and closed
            polyscope.is_headless = lambda: False
            pliant.show(TUBE)
            polyscope.show = None
            with self.assertRaises(TypeError):
                pliant.show(TUBE)
            polyscope.frame_tick()  # the panel is gone, whatever ended the window
            frames = len(drawn)
            polyscope.frame_tick()
            self.assertEqual(len(drawn), frames)
        finally:
            _show.Viewer.draw_panel, polyscope.show, polyscope.is_headless = panel, window, is_headless
        self.assertGreater(min(drawn), 80)  # text, two sliders and a button

    def test_without_egl(self):
        program = ("import ctypes, sys; sys.path[:0] = %r; import pliant\ndef missing(name): raise OSError(name)\n"
                   "ctypes.CDLL = missing\nfrom pliant import _show; _show._polyscope(True)" % (sys.path,))
        environment = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        for display in ({}, {"DISPLAY": ":77"}):  # none, and one that is gone
            done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True,
                                  env={**environment, **display})
            self.assertIn("RuntimeError: show: polyscope has no display to draw on", done.stderr)

    def test_without_polyscope(self):
        program = "import sys; sys.modules['polyscope'] = None; import pliant; pliant.show(None)"
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
        self.assertIn("ImportError: pliant.show needs polyscope: pip install 'pliant[show]'", done.stderr)


if __name__ == "__main__":
    start_headless()
    unittest.main(verbosity=2)
