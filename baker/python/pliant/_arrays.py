"""Checks of array arguments, before any other code uses them."""
from __future__ import annotations

from typing import Any, Mapping, Sequence

import numpy as np
import numpy.typing as npt


def _describe(array: npt.NDArray[Any]) -> str:
    return f"got {array.shape} {array.dtype}"


def _as_array(name: str, value: object, expected: str) -> npt.NDArray[Any]:
    try:
        array = np.asarray(value)
    except ValueError as error:  # rows of different lengths
        raise ValueError(f"{name}: expected {expected}, got something that is no array: {error}") from None
    return array


def _has_shape(array: npt.NDArray[Any], shape: Sequence[int | None]) -> bool:
    return array.ndim == len(shape) and all(want is None or want == have for want, have in zip(shape, array.shape))


def numbers(name: str, value: object, shape: Sequence[int | None], expected: str) -> npt.NDArray[np.float64]:
    """A C-contiguous float64 array of the shape; None stands for any length.
    Accepts dtypes that convert to double without loss."""
    array = _as_array(name, value, expected)
    is_real = array.dtype.kind in "iuf" and np.can_cast(array.dtype, np.float64, "safe")
    if not is_real or not _has_shape(array, shape):
        kind: type[Exception] = ValueError if is_real else TypeError
        raise kind(f"{name}: expected {expected}, {_describe(array)}")
    return np.ascontiguousarray(array, dtype=np.float64)


def indices(name: str, value: object, shape: Sequence[int | None], expected: str) -> npt.NDArray[np.int64]:
    """A C-contiguous int64 array of the shape. Does not check the range of the numbers, but never changes one."""
    array = _as_array(name, value, expected)
    if array.dtype.kind not in "iu" or not _has_shape(array, shape):
        kind: type[Exception] = TypeError if array.dtype.kind not in "iu" else ValueError
        raise kind(f"{name}: expected {expected}, {_describe(array)}")
    if array.dtype == np.uint64 and array.size and array.max() > np.iinfo(np.int64).max:
        raise ValueError(f"{name}: holds {array.max()}, which is no index")
    return np.ascontiguousarray(array, dtype=np.int64)


def rows(name: str, value: object, width: int, what: str) -> tuple[npt.NDArray[np.float64], bool]:
    """One row of `width` numbers or several rows, as (k, width), and whether it was a single row."""
    expected = f"({width},) or (k, {width}): {what}"
    array = _as_array(name, value, expected)
    if array.ndim == 1:
        return numbers(name, array, (width,), expected).reshape(1, width), True
    return numbers(name, array, (None, width), expected), False


def by_name(given: Mapping[str, Any], names: Sequence[str], start: Sequence[float]) -> npt.NDArray[Any]:
    """Weights given by name as an array: numbers, or (k,) for k rows; `start` has those of names that are not given."""
    columns: list[Any] = list(start)
    for name, value in given.items():
        if name not in names:
            raise ValueError(f"weights: the asset has no {name!r}; the names are {', '.join(names)}")
        columns[names.index(name)] = value  # of equal names the first
    try:
        return np.stack(np.broadcast_arrays(*columns), axis=-1)
    except ValueError:
        shapes = ", ".join(f"{name} {np.shape(value)}" for name, value in given.items())
        raise ValueError(f"weights: expected by name a number or (k,), the same k for all, got {shapes}") from None


def rounded(array: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    """Single precision for the runtime, which reports numbers that are too large."""
    with np.errstate(over="ignore"):
        return array.astype(np.float32)


def name_list(names: Sequence[str] | None, count: int) -> list[str]:
    if names is None:
        return [f"pose_{k}" for k in range(count)]
    if isinstance(names, str) or len(names) != count or not all(isinstance(name, str) for name in names):
        raise ValueError(f"names: expected {count} strings, one per pose, got {names!r}")
    for name in names:
        if "\0" in name:
            raise ValueError(f"names: {name!r} has a zero character, which ends a name")
    return list(names)
