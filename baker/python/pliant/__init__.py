"""Pliant: elastic blends of whole shapes. Bakes poses from arrays into an asset and blends it with the C runtime.

    asset = pliant.bake(poses, faces)      # (m, n, 3) float64 and (f, 3): minutes for a character
    shape = asset.blend([0.5, 0.5])        # (n, 3) float32: some milliseconds at most
    asset.save("hero.pliant")
    pliant.show(asset)                     # a window with sliders

For research: asset.rest + asset.basis @ q are the blends, asset.energy is what they minimise, and pliant.energy() is the
unreduced elastic energy, with gradient and sparse Hessian.

Lengths are in the units of the poses. Weights are one number >= 0 per pose; only their ratios matter. With blend="layers"
the first pose is the rest shape, the others are layers on it, and weights add up: asset.blend({"smile": 1, "blink": 0.5}).

Threads: every function may be called from any thread. Bakes, averages and load_poses of one process take turns, since each
uses all cores. Blends wait neither for them nor for each other, and release the interpreter's lock.
"""
from __future__ import annotations

import importlib
import types
from typing import TYPE_CHECKING

from ._asset import Asset
from ._bake import average, bake
from ._energy import Energy, energy
from ._errors import Error, Finding, PliantWarning, ToleranceError
from ._module import core
from ._poses import Poses, load_poses
from ._show import show

__version__ = core.version()
__all__ = [
    "Asset", "Energy", "Error", "Finding", "PliantWarning", "Poses", "ToleranceError", "average", "bake", "energy",
    "load_poses", "show",
]  # fmt: skip

if TYPE_CHECKING:
    from . import batch as batch
else:

    def __getattr__(name: str) -> types.ModuleType:
        """Loads pliant.batch on first use, since few programs need it."""
        if name == "batch":
            return importlib.import_module(".batch", __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
