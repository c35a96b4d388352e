"""Loads the compiled module with one thread for OpenBLAS.

OpenBLAS starts its threads when it is loaded. The baker uses one thread, since more would change the last bits of a bake.
numpy is imported first, so that an OpenBLAS of its own starts with its usual threads.
"""
from __future__ import annotations

import os

import numpy  # noqa: F401

_chosen = os.environ.get("OPENBLAS_NUM_THREADS")
if _chosen is None:
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
try:
    from . import _core as core
finally:
    if _chosen is None:
        del os.environ["OPENBLAS_NUM_THREADS"]

__all__ = ["core"]
