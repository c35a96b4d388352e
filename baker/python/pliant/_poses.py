"""Poses from files and from arrays."""
from __future__ import annotations

import os
import warnings
from typing import Any, Callable, Literal, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _meshes, _usd
from ._errors import Error, PliantWarning, finding
from ._module import core

PathLike = Union[str, "os.PathLike[str]"]
Blend = Literal["average", "layers"]


def warner(depth: int) -> Callable[[int, str, str], None]:
    """Returns a function that turns a warning of the baker into a Python warning,
    attributed to the caller `depth` levels up."""

    def warn(number: int, what: str, hint: str) -> None:
        warnings.warn(PliantWarning(finding(False, number, "", what, hint)), stacklevel=depth)

    return warn


class Poses:
    """Poses from files, made by load_poses: one mesh in several positions, the rest pose first.

    It keeps everything that a bake uses, including data that the arrays do not show: faces of different sizes, moduli of a
    Vega file, materials and images of a glTF file. Pass it to bake() and average() as a whole. It is immutable; its arrays
    are copies.
    """

    def __init__(self, source: core.Poses, blend: Blend | None = None) -> None:
        self._source = source
        self._blend: Blend = blend or ("layers" if source.blend() == "layers" else "average")

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        """(m, n, 3) float64, in the units and order of the files. Raises ValueError if the poses have different numbers of
        vertices."""
        if not self._source.have_one_count():
            raise ValueError("positions: the poses have different numbers of vertices")
        return self._source.positions()

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """(f, k) uint32: the faces of the first pose if all have k corners, otherwise their triangles (t, 3).
        (0, 3) for solids."""
        return self._source.faces()

    @property
    def tets(self) -> npt.NDArray[np.uint32]:
        """(t, 4) uint32: the tetrahedra of the first pose; (0, 4) for surfaces."""
        return self._source.tets()

    @property
    def names(self) -> list[str]:
        """The m names: those of the files, or those inside a glTF file."""
        return self._source.names()

    @property
    def blend(self) -> Blend:
        """How bake() and average() blend them unless they are told: "layers" of a file with morph targets."""
        return self._blend

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        cells = f"{len(self.tets)} tets" if len(self.tets) else f"{len(self.faces)} faces"
        return f"<pliant.Poses {', '.join(self.names)}: {cells}>"


def load_poses(paths: PathLike | Sequence[PathLike], *, blend: Blend | None = None) -> Poses:
    """Reads 2 to 64 poses as the command line does, the rest pose first; with blend="layers" the rest shape and up to 64
    layers. Without `blend` one glTF or USD file with morph targets, named without '#', is one of layers, all else is of
    averages.

    paths  mesh files with one pose each, or glTF files with several: surfaces from .obj, .ply, .off, .glb, .gltf; solids of
           tetrahedra from .msh, .mesh, .veg, .vtk. After the name of a glTF file, '#rest', '#target=NAME,NAME' or
           '#animation=NAME@0,0.3' selects poses, as in 'hero.glb#animation=Run@0,0.3,0.6'.
           Or USD files (.usd, .usda, .usdc, .usdz), not together with others; these need pip install 'pliant[usd]'. Their
           meshes that are drawn become one, placed in the stage and skinned: for '#rest' and blend shapes by the rest pose
           of the skeleton, for frames by its animation. One file is its blend shapes as layers, or without them its frames;
           a file among others is its first frame. '#rest', '#target=NAME,NAME' or '#time=FRAME,FRAME' selects, as in
           'hero.usd#time=1,12,24'. In-between shapes as layers, instances of points, materials and images are not read.

    Raises Error: P2xxx for a file that cannot be read, with file and line; P3001 and P3002 for too few and too many poses;
    P1211 to P1213 for a choice that the file does not have. ValueError for USD meshes that are none, ImportError without
    usd-core. bake() and average() check that the poses have the same mesh.
    """
    if isinstance(paths, (str, os.PathLike)):
        paths = [paths]
    if blend is not None:
        pose_limit(blend)  # checks it
    names = [os.fspath(path) for path in paths]
    if any(_usd.is_usd(name) for name in names):
        return _load_usd(names, blend)
    return Poses(core.load_poses(names, blend, warner(3)))


def _load_usd(paths: Sequence[str], blend: Blend | None) -> Poses:
    other = next((path for path in paths if not _usd.is_usd(path)), None)
    if other is not None:
        raise ValueError(f"paths: {other!r} is no USD file; these are not mixed with others")
    files = [_usd.read_poses(path, len(paths) == 1, blend) for path in paths]
    warn = warner(4)
    for path, file in zip(paths, files):
        if file.instancers:
            what = f"{path}: instances of points are ignored: {', '.join(file.instancers[:3])}"
            warn(2313, what, "turn them into meshes, or into instances of prims")
    shapes = [shape for file in files for shape in file.poses]
    kind: Blend = blend or ("layers" if files[0].has_layers else "average")
    limit = pose_limit(kind)
    if len(shapes) < 2:
        hint = "name all poses of the character, or choose frames as in hero.usd#time=1,12,24"
        raise Error([finding(True, 3001, paths[0], f"{len(shapes)} pose given, two or more are needed", hint)], 3)
    if len(shapes) > limit:
        hint = "choose the poses that differ most"
        raise Error([finding(True, 3002, paths[0], f"{len(shapes)} poses given, the limit is {limit}", hint)], 3)
    for path, file in zip(paths, files):
        if file.poses[0][1].shape != shapes[0][1].shape or not np.array_equal(file.faces, files[0].faces):
            raise ValueError(f"{path}: has other vertices or faces than {paths[0]}; poses share them")
    names = [name for name, _ in shapes]
    positions = np.stack([shape for _, shape in shapes])
    return Poses(core.poses_of_arrays(positions, files[0].faces, None, names, paths[0]), kind)


def pose_limit(blend: object) -> int:
    limits = {"average": 64, "layers": 65}
    if not isinstance(blend, str) or blend not in limits:
        raise ValueError(f"blend: expected one of 'average', 'layers', got {blend!r}")
    return limits[blend]


def check_count(count: int, limit: int, got: object) -> None:
    if 2 <= count <= limit:
        return
    more = '; blend="layers" takes 65' if limit < count <= 65 else ""
    raise ValueError(f"poses: expected (m, n, 3) float64 with 2 to {limit} poses, got {got}{more}")


def from_arrays(poses: object, faces: object, tets: object, names: Sequence[str] | None, limit: int) -> core.Poses:
    """Checks the arrays of a bake, an average or an energy."""
    if (faces is None) == (tets is None):
        raise TypeError("give either faces (f, 3) of a surface or tets (t, 4) of a solid")
    positions = _arrays.numbers("poses", poses, (None, None, 3), "(m, n, 3) float64")
    count = positions.shape[0]
    check_count(count, limit, positions.shape)
    if positions.shape[1] == 0:
        raise ValueError(f"poses: expected (m, n, 3) float64 with vertices, got {positions.shape}")
    cells = _faces("faces", faces) if tets is None else _arrays.indices("tets", tets, (None, 4), "(t, 4) integers")
    if cells.shape[0] == 0:
        raise ValueError(f"{'faces' if tets is None else 'tets'}: there are none, got {cells.shape}")
    known = _arrays.name_list(names, count)
    return core.poses_of_arrays(positions, cells if tets is None else None, None if tets is None else cells, known, "poses")


def _faces(name: str, faces: object) -> npt.NDArray[np.int64]:
    array = _arrays.indices(name, faces, (None, None), "(f, 3) integers")
    if array.shape[1] < 3:
        raise ValueError(f"{name}: expected (f, 3) integers, got {array.shape} {array.dtype}")
    return array


def surface_of(surface: Any) -> tuple[core.Poses | None, str]:
    """The surface= of a bake: a file, or a pair of arrays."""
    if surface is None:
        return None, ""
    if isinstance(surface, (str, os.PathLike)):
        return None, os.fspath(surface)
    if _meshes.is_mesh(surface):
        surface = _meshes.arrays_of(surface, "surface")[:2]
    if not isinstance(surface, (tuple, list)) or len(surface) != 2:
        raise TypeError(f"surface: expected a path, a pair (positions, faces) or a mesh, got {type(surface).__name__}")
    positions = _arrays.numbers("surface positions", surface[0], (None, 3), "(s, 3) float64")
    faces = _faces("surface faces", surface[1])
    if positions.shape[0] == 0 or faces.shape[0] == 0:
        raise ValueError(f"surface: has no vertices or no faces, got {positions.shape} and {faces.shape}")
    return core.poses_of_arrays(positions[np.newaxis], faces, None, ["surface"], "surface"), ""
