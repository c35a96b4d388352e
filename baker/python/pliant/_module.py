"""Loads the compiled module with one thread for OpenBLAS, and on x86 processors with AVX2 with the kernels for those.

OpenBLAS starts its threads and chooses its kernels when it is loaded. More threads would change the last bits of a bake, and
so would other kernels; an OpenBLAS older than the processor takes much slower ones.
numpy is imported before the number of threads is set, so that an OpenBLAS of its own starts with its usual threads. Its
kernels are set, since numpy may load the very library that the compiled module uses.
"""
from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator


@contextlib.contextmanager
def _default(name: str, value: str) -> Iterator[None]:
    """Within the block the environment variable has this value, unless it had one before."""
    if name in os.environ:
        yield
        return
    os.environ[name] = value
    try:
        yield
    finally:
        del os.environ[name]


def _has_avx2() -> bool:
    try:
        with open("/proc/cpuinfo", encoding="ascii", errors="replace") as file:
            flags = next((line for line in file if line.startswith("flags")), "").split()
    except OSError:
        return False
    return "avx2" in flags and "fma" in flags


with _default("OPENBLAS_CORETYPE", "Haswell") if _has_avx2() else contextlib.nullcontext():
    import numpy  # noqa: F401

    with _default("OPENBLAS_NUM_THREADS", "1"):
        from . import _core as core

__all__ = ["core"]
