"""Options of bakes and averages: names and ranges as on the command line, checked before work starts."""
from __future__ import annotations

import operator
from typing import Any, Mapping

import numpy as np

from . import _arrays

# Ranges of the command line (pliant bake --help; a test compares the names). The C++ module checks choices.
RANGES: dict[str, tuple[float, float]] = {
    "tolerance": (1e-8, 1.0),
    "tolerance_max": (1e-8, 1.0),
    "thickness": (1e-6, 1.0),
    "foldover_damping": (0.0, 1.0),
    "weld": (0.0, 1e-3),
    "poisson": (0.0, 0.499),
    "position_error": (0.0, 1e-2),
    "time_limit": (0.0, 1e6),
    "ritz": (0, 32),
    "dim": (1, 256),
    "elements": (1, 1000000),
    "ghost_vertices": (4, 1000000),
    "check_samples": (0, 1000),
    "fresh_samples": (0, 1000),
    "threads": (1, 256),
    "seed": (0, 2**64 - 1),
}
_WHOLE = {"ritz", "dim", "elements", "ghost_vertices", "check_samples", "fresh_samples", "threads", "seed"}
_EXPECTED_RANGE = "(low, high), or a dict with one for each layer by its name"
_FLAGS = {"no_align", "no_scene", "best_effort", "preview"}


def _number(name: str, value: object) -> float | int:
    low, high = RANGES[name]
    kind = "a whole number" if name in _WHOLE else "a number"
    try:
        if isinstance(value, (bool, np.bool_, str, bytes, bytearray)):
            raise TypeError
        number = operator.index(value) if name in _WHOLE else float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected {kind} from {low:g} to {high:g}, got {value!r}") from None
    if not low <= number <= high:  # so is NaN
        raise ValueError(f"{name}: expected {kind} from {low:g} to {high:g}, got {value!r}")
    return number


def _fixed(value: object, vertex_count: int) -> list[int]:
    array = _arrays.indices("fix", value, (None,), "(k,) vertex numbers")
    if array.size == 0:
        raise ValueError("fix: expected three or more vertex numbers, got none (leave it out to hold nothing)")
    outside = array[(array < 0) | (array >= vertex_count)]
    if outside.size:
        raise ValueError(f"fix: vertex {outside[0]} is to be fixed, the poses have {vertex_count}")
    fixed: list[int] = np.unique(array).tolist()
    return fixed


def _range(value: object) -> list[tuple[str, float, float]]:
    """Name, low and high of each; the name of all layers is empty."""
    ranges = value.items() if isinstance(value, Mapping) else [("", value)]
    out = []
    for name, pair in ranges:
        if not isinstance(name, str):
            raise TypeError(f"range: expected names of layers as keys, got {name!r}")
        low, high = _arrays.numbers(f"range of {name!r}" if name else "range", pair, (2,), _EXPECTED_RANGE)
        out.append((name, float(low), float(high)))
    return out


def checked(given: Mapping[str, Any], vertex_count: int) -> dict[str, Any]:
    """The given options in the form of the C++ module: without those that are None or off."""
    options: dict[str, Any] = {}
    for name, value in given.items():
        if name in _FLAGS and value is not None and not isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name}: expected True or False, got {value!r}")
        if value is None or (name in _FLAGS and not value):
            continue
        if name in RANGES:
            options[name] = _number(name, value)
        elif name == "fix":
            options[name] = _fixed(value, vertex_count)
        elif name == "range":
            options[name] = _range(value)
        elif name in _FLAGS:
            options[name] = True
        elif isinstance(value, str):
            options[name] = value
        else:
            raise TypeError(f"{name}: expected a string, got {value!r}")
    return options
