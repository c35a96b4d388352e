"""Pliant: elastic blends of whole shapes. Bake poses in arrays into an asset, blend them with the C runtime.

    asset = pliant.bake(poses, faces)      # (m, n, 3) float64 and (f, 3): minutes for a character
    shape = asset.blend([0.5, 0.5])        # (n, 3) float32: well below a millisecond to a few
    asset.save("hero.pliant")

Lengths are in the units of the poses; weights are one number >= 0 per pose, of which only the ratios matter.

Threads: every call may be made from any thread. Bakes and averages of one process take turns (each uses all cores); blends do not wait
for them or for each other, and release the interpreter's lock.
"""
from __future__ import annotations

import importlib
import types
from typing import TYPE_CHECKING

from ._asset import Asset
from ._bake import average, bake
from ._errors import Error, Finding, PliantWarning, ToleranceError
from ._module import core
from ._poses import Poses, load_poses

__version__ = core.version()
__all__ = ["Asset", "Error", "Finding", "PliantWarning", "Poses", "ToleranceError", "average", "bake", "load_poses"]

if TYPE_CHECKING:
    from . import batch as batch
else:

    def __getattr__(name: str) -> types.ModuleType:
        """pliant.batch is loaded when it is first used: few need it."""
        if name == "batch":
            return importlib.import_module(".batch", __name__)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
