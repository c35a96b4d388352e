"""USD files as poses, read by OpenUSD (usd-core), which is imported when such a file is read."""
from __future__ import annotations

import importlib
import math
import os
import pathlib
import sys
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._errors import Error, finding
from ._usd_skin import Skin, length_of, skins_of

SUFFIXES = (".usd", ".usda", ".usdc", ".usdz")
_LIMIT = 64  # poses, or layers
# What reading a file may cost: some for any file, and more for each of its bytes, as of glTF. Numbers of arrays, prims, the
# levels of their paths, their time samples, names of blend shapes and joints, and a mesh in a pose take their shares.
_COST, _COST_FOR_BYTE = 64000000, 128
_OF_NUMBER, _OF_PRIM, _OF_LEVEL, _OF_SAMPLE, _OF_NAME, _OF_JOINT, _OF_POSED = 16, 1024, 256, 64, 256, 64, 2048
_OF_POSED_NUMBER = 1
_INPUT = 3  # the exit code
_USAGE = 2
_CHOICES = "write #rest, #target=NAME,NAME or #time=FRAME,FRAME"

Positions = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]


class NamedPoses(NamedTuple):
    """Poses of one file: (name, (n, 3)) each, their faces (f, k), whether they are a rest shape and its layers, and which
    instances of points are left out."""

    poses: list[tuple[str, Positions]]
    faces: Faces
    has_layers: bool
    instancers: list[str]


def _error(exit_code: int, number: int, where: str, what: str, hint: str) -> Error:
    return Error([finding(True, number, where, what, hint)], exit_code)


def is_usd(path: str) -> bool:
    return path.split("#")[0].lower().endswith(SUFFIXES)


def _usd(path: str) -> Any:
    try:
        for name in ("Gf", "Tf", "Usd", "UsdGeom", "UsdSkel", "Vt"):
            importlib.import_module(f"pxr.{name}")
    except ImportError:
        message = f"{path}: reading USD needs usd-core: pip install 'pliant[usd]'"
        raise ImportError(message, name="pxr") from None
    return sys.modules["pxr"]


def _open(path: str) -> tuple[Any, Any]:
    pxr = _usd(path)
    try:
        with open(path, "rb"):
            pass
        stage = pxr.Usd.Stage.Open(path)
        for layer in stage.GetUsedLayers():  # others may have held them, while their files were written again
            if not layer.dirty:
                layer.Reload()
        return pxr, stage
    except (OSError, pxr.Tf.ErrorException) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error).strip().splitlines()[-1].strip()
        what = f"cannot be read: {reason}"
        raise _error(_INPUT, 2001, path, what, "check the name and the permissions of the file") from None


class _Allowance:
    """What reading the files of a stage may still cost."""

    def __init__(self, path: str, count_bytes: Callable[[], int]) -> None:
        self._path = path
        self._count_bytes = count_bytes
        self._limit = self._left = _COST + _COST_FOR_BYTE * count_bytes()

    def _grow(self) -> None:
        """By files that were opened since, such as clips of frames."""
        grown = _COST + _COST_FOR_BYTE * self._count_bytes() - self._limit
        self._limit += grown
        self._left += grown

    def take(self, count: int, prim: Any) -> None:
        self._left -= count
        if self._left < 0:
            self._grow()
        if self._left < 0:
            limit = f"{self._limit // _OF_NUMBER} numbers are read, the limit for its files"
            what = f"at {prim.GetPath()} more than {limit}"
            raise _error(_INPUT, 2333, self._path, what, "simplify the mesh, or use fewer instances, poses and blend shapes")


class _Places:
    """Where prims are at a time. Each place above others is computed once."""

    def __init__(self, pxr: Any) -> None:
        self._usd = pxr
        self._last: tuple[Any, Any] | None = None

    def matrix(self, prim: Any, time: Any) -> Positions:
        if self._last is None or self._last[0] != time:
            self._last = (time, self._usd.UsdGeom.XformCache(time))
        return np.array(self._last[1].GetLocalToWorldTransform(prim))


class _Bindings:
    """What UsdSkel's answers about the skeletons of prims cost, drawn or hidden. Prims come after those above them."""

    def __init__(self, pxr: Any, allowance: _Allowance) -> None:
        self._usd = pxr
        self._allowance = allowance
        self._inherited: dict[Any, tuple[int, int]] = {}  # by path: names of joints, and names that the skeleton has
        self._names: dict[Any, int] = {}  # of skeletons, by path, with those of their animations

    def take(self, prim: Any) -> None:
        joints, names = self._inherited.get(prim.GetPath().GetParentPath(), (0, 0))
        joints = self._count(prim, "skel:joints") or joints
        skeletons = prim.GetRelationship("skel:skeleton").GetTargets() if prim.HasRelationship("skel:skeleton") else ()
        names = max([self._names_at(path, prim) for path in skeletons], default=names)
        self._inherited[prim.GetPath()] = joints, names
        own = joints + self._count(prim, "skel:blendShapes")
        self._allowance.take(_OF_PRIM + _OF_JOINT * own + _OF_NUMBER * names, prim)

    def _count(self, prim: Any, attribute: str) -> int:
        return length_of(prim.GetAttribute(attribute).Get()) if prim.HasAttribute(attribute) else 0

    def _names_at(self, path: Any, prim: Any) -> int:
        self._allowance.take(_OF_JOINT, prim)
        if path not in self._names:
            skeleton = prim.GetStage().GetPrimAtPath(path)
            animation = self._usd.UsdSkel.BindingAPI(skeleton).GetInheritedAnimationSource() if skeleton else None
            self._names[path] = sum(self._count(one, name) for one in (skeleton, animation) if one
                                    for name in ("joints", "blendShapes"))
            self._allowance.take(_OF_JOINT * self._names[path], prim)
        return self._names[path]


class _Part:
    """A mesh of the stage."""

    def __init__(self, pxr: Any, prim: Any, path: str, allowance: _Allowance, places: _Places) -> None:
        self._usd = pxr
        self._allowance = allowance
        self._places = places
        self.skin: Skin | None = None
        self.prim = prim
        self.mesh = pxr.UsdGeom.Mesh(prim)
        self.where = f"{path}: {prim.GetPath()}"
        self._rest_time = pxr.Usd.TimeCode.EarliestTime()
        self._offset_count: int | None = None
        self.count = len(self._points(self._rest_time, _OF_NUMBER))

    def _numbers(self, attribute: Any, time: Any = None, cost: int = _OF_NUMBER) -> Positions:
        """Of an attribute, which files may give any type; none if it has no value."""
        values = attribute.Get() if time is None else attribute.Get(time)
        self._allowance.take(cost * max(length_of(values), 1), self.prim)
        try:
            return np.asarray([] if values is None else values, np.float64)
        except (TypeError, ValueError):
            raise ValueError(f"{self.where}: {attribute.GetName()} are not numbers") from None

    def _vectors(self, attribute: Any, time: Any = None, cost: int = _OF_NUMBER) -> Positions:
        numbers = self._numbers(attribute, time, cost)
        if numbers.size % 3 != 0:
            raise ValueError(f"{self.where}: {attribute.GetName()} are not vectors of three numbers")
        return numbers.reshape(-1, 3)

    def _points(self, time: Any, cost: int = _OF_POSED_NUMBER) -> Positions:
        return self._vectors(self.mesh.GetPointsAttr(), time, cost)

    def _place(self) -> Any:
        return self.skin.place() if self.skin else self.prim

    def _placed(self, points: Positions, time: Any, is_rest: bool) -> Positions:
        """In the space of the stage."""
        moves = self.skin.influence_count if self.skin else 0
        joints = self.skin.skeleton.joint_count if self.skin else 0
        self._allowance.take(_OF_POSED + _OF_POSED_NUMBER * (max(self.count, 1) * (1 + moves) + joints), self.prim)
        if self.skin:
            points = self.skin.skinned(points, time, is_rest)
        matrix = self._places.matrix(self._place(), time)
        if np.array_equal(matrix, np.eye(4)):
            return points
        placed: Positions = points @ matrix[:3, :3] + matrix[3, :3]
        return placed

    def at(self, time: Any) -> Positions:
        """As it is drawn at that time."""
        points = self._points(time)
        if len(points) != self.count:
            what = f"has {len(points)} points at frame {time.GetValue():g} and {self.count} at first"
            raise ValueError(f"{self.where}: {what}; poses share vertices and faces")
        for attribute in (self.mesh.GetFaceVertexCountsAttr(), self.mesh.GetFaceVertexIndicesAttr()):
            if attribute.ValueMightBeTimeVarying() and not np.array_equal(
                    self._numbers(attribute, time), self._numbers(attribute, self._rest_time)):
                what = f"has other faces at frame {time.GetValue():g} than at first"
                raise ValueError(f"{self.where}: {what}; poses share vertices and faces")
        if self.skin:
            self._allowance.take(_OF_POSED_NUMBER * self.skin.skeleton.count_numbers(time), self.prim)
        if self.skin and self.skin.has_shapes:
            self._allowance.take(_OF_POSED_NUMBER * self._count_offsets(), self.prim)
            points = self.skin.morphed(points, time)
        return self._placed(points, time, False)

    def _count_offsets(self) -> int:
        """What every frame reads of all blend shapes, in numbers."""
        if self._offset_count is None:
            self._offset_count = 0
            for path in self._usd.UsdSkel.BindingAPI(self.prim).GetBlendShapeTargetsRel().GetTargets():
                shape = self._usd.UsdSkel.BlendShape(self.prim.GetStage().GetPrimAtPath(path))
                between = shape.GetInbetweens() if shape else []
                own = [shape.GetOffsetsAttr(), shape.GetPointIndicesAttr()] if shape else []
                for attribute in [*own, *(one.GetAttr() for one in between)]:
                    count = length_of(attribute.Get())
                    self._allowance.take(_OF_JOINT + _OF_NUMBER * count, self.prim)
                    self._offset_count += _OF_JOINT + count
        return self._offset_count

    def rest(self, offsets: Positions | float = 0.0) -> Positions:
        """Without animation of its skeleton; `offsets` are added to its own points."""
        return self._placed(self._points(self._rest_time) + offsets, self._rest_time, True)

    def add_times(self, times: set[float], seen: set[Any]) -> None:
        """At which points, joints or the place of the mesh are given. `seen`: the prims that have been asked."""
        times |= set(self.mesh.GetPointsAttr().GetTimeSamples()) | (self.skin.skeleton.times() if self.skin else set())
        prim = self._place()
        while prim and not prim.IsPseudoRoot() and prim.GetPath() not in seen:
            seen.add(prim.GetPath())
            if prim.IsA(self._usd.UsdGeom.Xformable):
                times |= set(self._usd.UsdGeom.Xformable(prim).GetTimeSamples())
            prim = prim.GetParent()

    def _is_mirrored(self) -> bool:
        """Whether most points at rest are placed by matrices that mirror."""
        if self.count == 0:
            return False
        size = np.abs(self._points(self._rest_time)).max(initial=0.0) or 1.0
        origin = self.rest()
        axes = np.stack([self.rest(size * axis) - origin for axis in np.eye(3)], 1)
        return bool((np.linalg.det(axes / size) < 0).mean() > 0.5)

    def faces(self) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """How many corners each has, and all of them."""
        counts = self._numbers(self.mesh.GetFaceVertexCountsAttr(), self._rest_time).ravel()
        corners = self._numbers(self.mesh.GetFaceVertexIndicesAttr(), self._rest_time).ravel()
        if counts.sum() != len(corners) or not (counts >= 3).all() or (counts % 1 != 0).any():
            raise ValueError(f"{self.where}: its numbers of corners do not fit its faces")
        if not ((corners >= 0) & (corners < self.count)).all():
            raise ValueError(f"{self.where}: a face has a corner that is not among its {self.count} points")
        sizes, order = counts.astype(np.int64), np.arange(len(corners))
        orientation = self.mesh.GetOrientationAttr().Get()
        self._allowance.take(_OF_NUMBER * length_of(orientation), self.prim)
        is_left = orientation == self._usd.UsdGeom.Tokens.leftHanded
        if is_left != self._is_mirrored():  # each face the other way round
            order = np.repeat(2 * (np.cumsum(sizes) - sizes) + sizes - 1, sizes) - order
        is_hole = np.isin(np.arange(len(sizes)), self._numbers(self.mesh.GetHoleIndicesAttr(), self._rest_time))
        return sizes[~is_hole], corners.astype(np.int64)[order][np.repeat(~is_hole, sizes)]

    def targets(self) -> dict[str, Any]:
        """The paths of the blend shapes of the mesh, by name."""
        binding = self._usd.UsdSkel.BindingAPI(self.prim)
        names = binding.GetBlendShapesAttr().Get() or []
        if not hasattr(names, "__len__"):
            raise ValueError(f"{self.where}: skel:blendShapes are not names")
        self._allowance.take(_OF_NAME * len(names), self.prim)
        paths = binding.GetBlendShapeTargetsRel().GetTargets()
        self._allowance.take(_OF_NAME * len(paths), self.prim)
        return {str(name): path for name, path in zip(names, paths)}

    def offsets(self, name: str, path: Any) -> Positions:
        """Of the blend shape there, as displacements of the points."""
        shape = self._usd.UsdSkel.BlendShape(self.prim.GetStage().GetPrimAtPath(path))
        if not shape:
            raise ValueError(f"{self.where}: blend shape '{name}' is not in the file: {path}")
        given, places = self._vectors(shape.GetOffsetsAttr()), self._numbers(shape.GetPointIndicesAttr()).ravel()
        if not len(places):
            places = np.arange(self.count, dtype=np.float64)
        if len(places) != len(given) or not ((places >= 0) & (places < self.count)).all():
            raise ValueError(f"{self.where}: blend shape '{name}' does not fit its {self.count} points")
        out = np.zeros((self.count, 3))
        out[places.astype(np.int64)] = given
        return out


def _as_rows(sizes: Faces, corners: Faces, path: str) -> Faces:
    """Faces of the same size as they are, faces of several sizes as triangles."""
    if not len(sizes):
        raise ValueError(f"{path}: its meshes have no faces")
    if (sizes == sizes[0]).all():
        return corners.reshape(len(sizes), -1)
    starts, counts = np.cumsum(sizes) - sizes, sizes - 2
    start = np.repeat(starts, counts)
    second = start + 1 + np.arange(len(start)) - np.repeat(np.cumsum(counts) - counts, counts)
    triangles: Faces = corners[np.stack([start, second, second + 1], 1)]
    return triangles


class _Stage:
    """The meshes of a file that are drawn, as one."""

    def __init__(self, path: str) -> None:
        self.path = path
        self._usd, self._stage = _open(path)
        self.instancers: list[str] = []
        self._parts = self._find_parts()
        if not self._parts:
            raise ValueError(f"{path}: has no mesh that is drawn")
        self._targets = [part.targets() for part in self._parts]
        self.targets = list(dict.fromkeys(name for one in self._targets for name in one))
        self._times: list[float] | None = None
        self._rests: list[Positions] | None = None

    def _byte_count(self) -> int:
        files = {layer.realPath.split("[")[0] for layer in self._stage.GetUsedLayers()}  # a.usdz[b.usdc]
        return sum(os.path.getsize(file) for file in files if os.path.isfile(file))

    def _is_drawn(self, prim: Any) -> bool:
        geom = self._usd.UsdGeom
        if not prim.IsA(geom.Mesh):
            return False
        return geom.Imageable(prim).ComputePurpose() in (geom.Tokens.default_, geom.Tokens.render)

    def _is_hidden(self, prim: Any, allowance: _Allowance) -> bool:
        """At all times, and what is below it with it."""
        if not prim.IsA(self._usd.UsdGeom.Imageable):
            return False
        attribute = self._usd.UsdGeom.Imageable(prim).GetVisibilityAttr()
        times = attribute.GetTimeSamples() or [self._usd.Usd.TimeCode.Default()]
        for time in times:
            value = attribute.Get(time)
            allowance.take(_OF_NUMBER * length_of(value), prim)
            if value != self._usd.UsdGeom.Tokens.invisible:
                return False
        return True

    def _sample_count(self, prim: Any) -> int:
        """What asking for its times and its place costs, in samples."""
        geom, count = self._usd.UsdGeom, 0
        if prim.IsA(geom.Imageable):
            count += geom.Imageable(prim).GetVisibilityAttr().GetNumTimeSamples()
        if prim.IsA(geom.Xformable):
            count += sum(16 + op.GetNumTimeSamples() for op in geom.Xformable(prim).GetOrderedXformOps())
        return count + (geom.Mesh(prim).GetPointsAttr().GetNumTimeSamples() if prim.IsA(geom.Mesh) else 0)

    def _find_parts(self) -> list[_Part]:
        out: list[_Part] = []
        allowance, places = _Allowance(self.path, self._byte_count), _Places(self._usd)
        prims = iter(self._usd.Usd.PrimRange(self._stage.GetPseudoRoot(), self._usd.Usd.TraverseInstanceProxies()))
        for prim in prims:
            allowance.take(_OF_PRIM + _OF_LEVEL * prim.GetPath().pathElementCount, prim)
            allowance.take(_OF_SAMPLE * self._sample_count(prim), prim)
            if self._is_hidden(prim, allowance):
                prims.PruneChildren()
            elif prim.IsA(self._usd.UsdGeom.PointInstancer):  # what lies below is not drawn where it is
                self.instancers.append(str(prim.GetPath()))
                prims.PruneChildren()
            elif self._is_drawn(prim):
                out.append(_Part(self._usd, prim, self.path, allowance, places))
        self._bind_skins(out, allowance)  # not before the file's prims are counted
        return sorted(out, key=lambda part: str(part.prim.GetPath()))  # programs list them in any order

    def _bind_skins(self, parts: list[_Part], allowance: _Allowance) -> None:
        skins = skins_of(self._usd, self._stage, self.path, _Bindings(self._usd, allowance).take)
        for part in parts:
            part.skin = skins.get(part.prim.GetPath())
            if part.skin:
                skeleton = part.skin.skeleton
                allowance.take(_OF_NUMBER * skeleton.joint_count + _OF_SAMPLE * len(skeleton.times()), part.prim)

    def faces(self) -> Faces:
        """(f, k) if all faces have k corners, otherwise their triangles, each face a fan from its first corner."""
        sizes, corners = [], []
        first = 0
        for part in self._parts:
            own_sizes, own_corners = part.faces()
            sizes.append(own_sizes)
            corners.append(first + own_corners)
            first += part.count
        return _as_rows(np.concatenate(sizes), np.concatenate(corners), self.path)

    def _rest_of_parts(self) -> list[Positions]:
        if self._rests is None:
            self._rests = [part.rest() for part in self._parts]
        return self._rests

    def rest(self) -> Positions:
        return np.concatenate(self._rest_of_parts())

    def target(self, name: str) -> Positions:
        if name not in self.targets:
            what = ", ".join(self.targets) or "none"
            raise _error(_USAGE, 1212, self.path, f"there is no morph target '{name}'", f"it has {what}")
        parts = zip(self._parts, self._targets, self._rest_of_parts())
        return np.concatenate([part.rest(part.offsets(name, own[name])) if name in own else rest
                               for part, own, rest in parts])

    def times(self) -> list[float]:
        """Ascending."""
        if self._times is None:
            times: set[float] = set()
            seen: set[Any] = set()
            for part in self._parts:
                part.add_times(times, seen)
            self._times = sorted(times)
        return self._times

    def at(self, time: float | None) -> Positions:
        """At a frame; None: at the first one, or as the stage is if it has none."""
        code = self._usd.Usd.TimeCode.EarliestTime() if time is None else self._usd.Usd.TimeCode(time)
        return np.concatenate([part.at(code) for part in self._parts])


def _times_of(text: str, where: str) -> list[float]:
    out = []
    for word in text.split(","):
        try:
            out.append(float(word))
        except ValueError:
            out.append(math.nan)
        if not math.isfinite(out[-1]):
            raise _error(_USAGE, 1211, where, f"'{word}' is not a time in frames", _CHOICES)
    return out


def _chosen(stage: _Stage, choice: str) -> list[tuple[str, Positions]]:
    kind, _, names = choice.partition("=")
    if choice == "rest":
        return [("rest", stage.rest())]
    if kind == "target" and names:
        chosen = [names] if names in stage.targets else names.split(",")
        return [(name, stage.target(name)) for name in chosen]
    if kind == "time" and names:
        return [(f"frame {time:g}", stage.at(time)) for time in _times_of(names, stage.path)]
    raise _error(_USAGE, 1211, stage.path, f"'#{choice}' after a USD file is not understood", _CHOICES)


def _all(stage: _Stage, has_layers: bool) -> list[tuple[str, Positions]]:
    if has_layers and len(stage.targets) > _LIMIT:
        what = f"{len(stage.targets)} blend shapes given, the limit is {_LIMIT}"
        hint = f"choose some of them, as in {stage.path}#rest {stage.path}#target={','.join(stage.targets[:2])}"
        raise _error(_INPUT, 3002, stage.path, what, hint)
    if has_layers:
        return [("rest", stage.rest())] + [(name, stage.target(name)) for name in stage.targets]
    times = stage.times()
    if len(times) > _LIMIT:
        hint = f"choose some of them, as in {stage.path}#time={times[0]:g},{times[len(times) // 2]:g},{times[-1]:g}"
        raise _error(_INPUT, 3002, stage.path, f"{len(times)} poses given, the limit is {_LIMIT}", hint)
    return [(f"frame {time:g}", stage.at(time)) for time in times] or [("rest", stage.rest())]


def read_poses(path: str, is_alone: bool, blend: str | None) -> NamedPoses:
    """The poses that a path chooses. Without a choice: of a file that is alone its blend shapes as layers, or its frames; of
    one among others its first frame."""
    try:
        return _read_poses(path, is_alone, blend)
    except RuntimeError as error:  # OpenUSD's own
        reason = (str(error).strip().splitlines() or [""])[-1].strip()
        raise ValueError(f"{path}: OpenUSD cannot use it: {reason}") from error


def _read_poses(path: str, is_alone: bool, blend: str | None) -> NamedPoses:
    file, has_choice, choice = path.partition("#")
    stage = _Stage(file)
    has_layers = is_alone and not has_choice and bool(stage.targets) and blend != "average"
    if has_choice:
        poses = _chosen(stage, choice)
    elif is_alone:
        poses = _all(stage, has_layers)
    else:
        poses = [(pathlib.PurePath(file).stem, stage.at(None))]
    return NamedPoses(poses, stage.faces(), has_layers, stage.instancers)
