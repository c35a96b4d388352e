"""show(): an asset in a window of polyscope, which is imported when it is called."""
from __future__ import annotations

import ctypes
import importlib
import os
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ._asset import Asset, Weights

# Where a slider of a layer ends: so much of its range beyond it, since layers may leave their ranges.
_MARGIN = 0.5
_GAP = 0.25  # between the two shapes, over their width
_PNG_END = b"IEND\xaeB`\x82"
_COLOURS = {"elastic": (0.16, 0.47, 0.71), "linear": (0.80, 0.52, 0.25)}


def _has_egl() -> bool:
    """Without a display polyscope draws with it, and crashes where it is missing."""
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return False
    return True


def _polyscope(is_headless: bool) -> Any:
    try:
        polyscope: Any = importlib.import_module("polyscope")
    except ImportError:
        raise ImportError("pliant.show needs polyscope: pip install 'pliant[show]'", name="polyscope") from None
    if not polyscope.is_initialized():
        polyscope.set_program_name("pliant")
        polyscope.set_verbosity(0)
        polyscope.set_use_prefs_file(False)
        try:
            if is_headless and _has_egl():  # a display may lack OpenGL 3.3, where polyscope crashes
                polyscope.set_allow_headless_backends(True)
                polyscope.init("openGL3_egl")
            else:
                polyscope.init()
        except RuntimeError as error:
            raise RuntimeError(
                "show: polyscope has no display to draw on; a picture without one needs libEGL.so.1 (Debian: libegl1)"
            ) from error
        # Without a name Dear ImGui leaves imgui.ini alone, which may be that of another program of the user.
        importlib.import_module("polyscope.imgui").GetIO().IniFilename = ""
    return polyscope


def _write_picture(polyscope: Any, picture: Path) -> None:
    """polyscope says nothing of what it cannot write, so it writes elsewhere first."""
    if picture.suffix.lower() != ".png":
        raise ValueError(f"picture: expected a name that ends in .png, got {str(picture)!r}")
    with tempfile.TemporaryDirectory(prefix=".pliant-", dir=picture.parent) as folder:
        made = Path(folder, "picture.png")
        polyscope.screenshot(str(made), transparent_bg=False)
        if not made.is_file() or not made.read_bytes().endswith(_PNG_END):
            raise OSError(f"picture: {str(picture)!r} cannot be written whole: is there space?")
        os.replace(made, picture)


class Viewer:
    """Two meshes in polyscope, the elastic and the linear blend of the same weights, and a slider for each weight."""

    def __init__(self, polyscope: Any, asset: Asset, weights: Weights | None, linear: bool) -> None:
        self.asset = asset
        start = [initial for _, _, _, initial in asset._weights()] if weights is None else weights
        rows, is_single = asset._rows(start)
        if not is_single:
            raise ValueError(f"weights: expected ({asset.weight_count},), got {rows.shape}")
        self.weights: npt.NDArray[np.float32] = rows[0]
        self.limits = [self._limit(*asset.ranges[name]) for name in asset.weight_names]
        self._drawn, corners = np.unique(asset.triangles, return_inverse=True)
        self._meshes: dict[str, Any] = {}
        for name, shape in self._shapes(linear).items():
            mesh = polyscope.register_surface_mesh(name, shape, corners.reshape(-1, 3), smooth_shade=True)
            mesh.set_color(_COLOURS[name])
            if name == "linear":
                mesh.set_position((1 + _GAP) * self._widest() * self._side(shape))
            self._meshes[name] = mesh

    def _limit(self, low: float, high: float) -> tuple[float, float]:
        margin = _MARGIN * (high - low) if self.asset.has_layers else 0.0
        return low - margin, high + margin

    def _widest(self) -> float:
        corners = self.asset.reconstruct(self.asset.pose_coordinates)[:, self._drawn]
        return float(np.ptp(corners, axis=1).max(0)[self._axis(corners[0])])

    @staticmethod
    def _axis(shape: npt.NDArray[np.float32]) -> int:
        """Side by side along the shorter one of the two axes across the picture."""
        return int(np.argmin(np.ptp(shape, axis=0)[:2]))

    def _side(self, shape: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
        side: npt.NDArray[np.float64] = np.eye(3)[self._axis(shape)]
        return side

    def _shapes(self, linear: bool) -> dict[str, npt.NDArray[np.float32]]:
        shapes = {"elastic": self.asset.blend(self.weights)[self._drawn]}
        if linear:
            shapes["linear"] = self.asset.linear_blend(self.weights)[self._drawn]
        return shapes

    def set_weights(self, weights: npt.ArrayLike) -> None:
        """Moves both meshes. All weights of an average zero: they stay as they are."""
        self.weights = np.asarray(weights, np.float32)
        if not self.asset.has_layers and not (self.weights > 0).any():
            return
        for name, shape in self._shapes("linear" in self._meshes).items():
            self._meshes[name].update_vertex_positions(shape)

    def draw_panel(self, imgui: Any) -> None:
        """The sliders: polyscope calls it once a frame."""
        imgui.Text("blue: elastic" + (", orange: linear" if "linear" in self._meshes else ""))
        weights = self.weights.copy()
        for k, name in enumerate(self.asset.weight_names):
            low, high = self.limits[k]
            is_moved, weight = imgui.SliderFloat(f"{name}##{k}", float(weights[k]), low, high)
            if is_moved:  # by Ctrl+Click to any number, and to nan
                weights[k] = min(max(low, weight), high)
        if imgui.Button("Start"):
            weights[:] = [initial for _, _, _, initial in self.asset._weights()]
        if not np.array_equal(weights, self.weights):
            self.set_weights(weights)


def show(
    asset: Asset,
    weights: Weights | None = None,
    *,
    linear: bool = True,
    picture: str | os.PathLike[str] | None = None,
) -> None:
    """Opens a window with the elastic blend, the linear blend beside it, and a slider for each weight; returns when the
    window is closed. Needs polyscope (MIT): pip install 'pliant[show]'.

    weights  to start with, as for Asset.blend(); default: those of the asset, mostly equal weights or no layer
    linear   draw the linear blend, too
    picture  write a PNG of this name (.png), whole or not at all, and open no window; without a display this needs EGL,
             which Mesa has

    Sliders of layers go half a range beyond the measured one. polyscope has one scene for each process: its meshes of the
    names "elastic" and "linear" are replaced, and a window takes the place of the user callback. A picture that comes first
    starts polyscope without windows; neither show() nor your own code can open one in this process any more. A picture
    after a window, or after polyscope.init(), is drawn there. Neither polyscope's settings nor imgui.ini of the current
    folder are written. Raises ImportError without polyscope, RuntimeError where no window can be opened or for a picture
    with neither display nor EGL, ValueError and OSError for a picture that cannot be written, and the errors of
    Asset.blend(). On a display without OpenGL 3.3, as of ssh -X, polyscope ends the process when it opens a window.
    """
    polyscope = _polyscope(picture is not None)
    if picture is None and polyscope.is_headless():
        raise RuntimeError(
            "show: polyscope opens no window in this process: it was started for a picture, or found no display; "
            "open windows before pictures, or give picture="
        )
    for name in _COLOURS:
        polyscope.remove_surface_mesh(name, error_if_absent=False)
    viewer = Viewer(polyscope, asset, weights, linear)
    polyscope.set_ground_plane_mode("none")
    polyscope.reset_camera_to_home_view()
    if picture is not None:
        _write_picture(polyscope, Path(os.fspath(picture)))
        return
    imgui = importlib.import_module("polyscope.imgui")
    polyscope.set_user_callback(lambda: viewer.draw_panel(imgui))
    try:
        polyscope.show()
    finally:
        polyscope.clear_user_callback()
