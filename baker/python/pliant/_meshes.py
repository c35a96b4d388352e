"""Meshes of other packages as poses. None of these packages is imported: their meshes are known by their attributes."""
from __future__ import annotations

from typing import Any, NamedTuple, Protocol, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _arrays


class TriangleMesh(Protocol):
    """What trimesh.Trimesh has: vertices (n, 3) and faces (f, 3)."""

    @property
    def vertices(self) -> Any: ...
    @property
    def faces(self) -> Any: ...


class CellMesh(Protocol):
    """What meshio.Mesh has: points (n, 3), and cells by their kind."""

    @property
    def points(self) -> Any: ...
    @property
    def cells_dict(self) -> Any: ...


Mesh = Union[TriangleMesh, CellMesh]


class Arrays(NamedTuple):
    """A mesh as arrays: faces of a surface or tets of a solid, the other one None."""

    positions: npt.NDArray[Any]
    faces: npt.NDArray[Any] | None
    tets: npt.NDArray[Any] | None


def is_mesh(value: object) -> bool:
    if isinstance(value, np.ndarray):
        return False
    return all(hasattr(value, name) for name in ("vertices", "faces")) or is_cell_mesh(value)


def is_cell_mesh(value: object) -> bool:
    return all(hasattr(value, name) for name in ("points", "cells_dict"))


def are_meshes(values: object) -> bool:
    """Whether the poses are meshes. Raises TypeError if some are and some are not."""
    if not isinstance(values, (list, tuple)):
        return False
    kinds = [is_mesh(value) for value in values]
    if any(kinds) and not all(kinds):
        odd = kinds.index(False)
        raise TypeError(f"poses[{odd}]: expected a mesh as the others are, got {type(values[odd]).__name__}")
    return any(kinds)


def arrays_of(mesh: Any, name: str) -> Arrays:
    if not is_cell_mesh(mesh):
        return Arrays(np.asarray(mesh.vertices), np.asarray(mesh.faces), None)
    cells = {kind: np.asarray(numbers) for kind, numbers in mesh.cells_dict.items() if len(numbers)}
    known = {kind: cells[kind] for kind in ("triangle", "quad", "tetra") if kind in cells}
    unknown = [kind for kind in cells if kind not in (*known, "vertex", "line")]
    if unknown or not known:
        have = ", ".join(repr(kind) for kind in unknown or cells) or "no cells"
        raise ValueError(f"{name}: expected cells 'triangle', 'quad' or 'tetra', got {have}")
    if "tetra" in known:  # triangles beside them are its boundary
        return Arrays(np.asarray(mesh.points), None, cells["tetra"])
    if len(known) == 1:
        return Arrays(np.asarray(mesh.points), next(iter(known.values())), None)
    halves = known["quad"][:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return Arrays(np.asarray(mesh.points), np.concatenate([known["triangle"], halves]), None)


def stacked(meshes: Sequence[Any]) -> Arrays:
    """Poses (m, n, 3) of meshes that all have the cells of the first one."""
    all_arrays = [arrays_of(mesh, f"poses[{k}]") for k, mesh in enumerate(meshes)]
    first = all_arrays[0]
    for k, other in enumerate(all_arrays):
        _arrays.numbers(f"poses[{k}]", other.positions, (None, 3), "positions (n, 3)")
        if other.positions.shape != first.positions.shape:
            raise ValueError(_differs(k, f"{len(other.positions)} vertices, poses[0] has {len(first.positions)}"))
        if not (_are_equal(other.faces, first.faces) and _are_equal(other.tets, first.tets)):
            raise ValueError(_differs(k, "other faces than poses[0]"))
    return Arrays(np.stack([one.positions for one in all_arrays]), first.faces, first.tets)


def _are_equal(one: npt.NDArray[Any] | None, other: npt.NDArray[Any] | None) -> bool:
    return (one is None) == (other is None) and (one is None or np.array_equal(one, other))  # type: ignore[arg-type]


def _differs(pose: int, what: str) -> str:
    remedy = "all poses share vertices and faces (trimesh: load with process=False, which keeps their order)"
    return f"poses[{pose}]: has {what}; {remedy}"
