"""How skeletons and blend shapes of a USD stage move its meshes: the queries of UsdSkel, at any time, of instances too."""
from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Positions = npt.NDArray[np.float64]
_ANIMATED = ("translations", "rotations", "scales", "blendShapeWeights")


def length_of(value: Any) -> int:
    """Of an array; 0 of anything else."""
    return len(value) if hasattr(value, "__len__") and not isinstance(value, str) else 0


class _Skeleton:
    """What the meshes that are bound to one share."""

    def __init__(self, pxr: Any, prim: Any, query: Any) -> None:
        self._usd = pxr
        self.prim = prim
        self._query = query
        self.animation = query.GetAnimQuery()
        self.joint_count = len(query.GetJointOrder())
        self._last: tuple[Any, Any] | None = None
        self._last_weights: tuple[Any, Any] | None = None
        self._last_counted: Any = None
        self._times: set[float] | None = None

    def times(self) -> set[float]:
        if self._times is None:
            moved = self.animation
            self._times = set(moved.GetJointTransformTimeSamples() if moved else [])
            self._times |= set(moved.GetBlendShapeWeightTimeSamples() if moved else [])
        return self._times

    def count_numbers(self, time: Any) -> int:
        """Of its animation at a time. Meshes that follow at the same time share them, and get 0."""
        if not self.animation or (self._last_counted is not None and self._last_counted == time):
            return 0
        self._last_counted = time
        prim = self.animation.GetPrim()
        return sum(length_of(prim.GetAttribute(name).Get(time)) for name in _ANIMATED if prim.HasAttribute(name))

    def weights(self, time: Any) -> Any:
        """Of the blend shapes that its animation sets."""
        if self._last_weights is None or self._last_weights[0] != time:
            self._last_weights = (time, self.animation.ComputeBlendShapeWeights(time))
        return self._last_weights[1]

    def transforms(self, time: Any) -> Any:
        """Of the joints, from where they were bound. A time of None is the rest pose, and so is any time without animation;
        a skeleton without a rest pose is as it was bound."""
        if self._last is None or self._last[0] != time:
            moved = None if time is None else self._query.ComputeSkinningTransforms(time)
            self._last = (time, moved or self._rest())
        return self._last[1]

    def _rest(self) -> Any:
        rest = self._query.ComputeJointSkelTransforms(self._usd.Usd.TimeCode.Default(), True) or []
        bind = self._query.GetJointWorldBindTransforms() or []
        if len(rest) == 0 or len(rest) != len(bind):
            return self._usd.Vt.Matrix4dArray(self.joint_count, self._usd.Gf.Matrix4d(1))
        return self._usd.Vt.Matrix4dArray([bound.GetInverse() * joint for bound, joint in zip(bind, rest)])


class Skin:
    """What moves the points of one mesh."""

    def __init__(self, pxr: Any, skeleton: _Skeleton, query: Any, path: str) -> None:
        self._usd = pxr
        self._query = query
        self._where = f"{path}: {query.GetPrim().GetPath()}"
        self.skeleton = skeleton
        self.influence_count = query.GetNumInfluencesPerComponent()
        self.has_shapes = bool(skeleton.animation) and query.HasBlendShapes()

    def place(self) -> Any:
        """The prim whose space moved points are in."""
        return self.skeleton.prim if self._query.HasJointInfluences() else self._query.GetPrim()

    def _points(self, positions: Positions) -> Any:
        return self._usd.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(positions, np.float32))

    def morphed(self, positions: Positions, time: Any) -> Positions:
        """By the blend shapes that the animation sets."""
        if not self.has_shapes:
            return positions
        skel, points = self._usd.UsdSkel, self._points(positions)
        shapes = skel.BlendShapeQuery(skel.BindingAPI(self._query.GetPrim()))
        weights, mapper = self.skeleton.weights(time), self._query.GetBlendShapeMapper()
        if not weights or not mapper:
            return positions
        parts = shapes.ComputeSubShapeWeights(mapper.Remap(weights))
        if not shapes.ComputeDeformedPoints(*parts, shapes.ComputeBlendShapePointIndices(),
                                            shapes.ComputeSubShapePointOffsets(), points):
            raise ValueError(f"{self._where}: its blend shapes do not fit its points")
        return np.asarray(points, np.float64)

    def skinned(self, positions: Positions, time: Any, is_rest: bool) -> Positions:
        """By the joints, if it has any. `time` counts for what the file gives the mesh, at rest too."""
        if not self._query.HasJointInfluences():
            return positions
        points = self._points(positions)
        if not self._query.ComputeSkinnedPoints(self.skeleton.transforms(None if is_rest else time), points, time):
            raise ValueError(f"{self._where}: its joints do not fit its skeleton")
        return np.asarray(points, np.float64)


def skins_of(pxr: Any, stage: Any, path: str, take: Callable[[Any], None]) -> dict[Any, Skin]:
    """By the path of the mesh. `take` gets every prim that UsdSkel asks for a skeleton, before it does."""
    out: dict[Any, Skin] = {}
    cache, predicate = pxr.UsdSkel.Cache(), pxr.Usd.TraverseInstanceProxies()
    prims = iter(pxr.Usd.PrimRange(stage.GetPseudoRoot(), predicate))
    for prim in prims:
        if not prim.IsA(pxr.UsdSkel.Root):
            continue
        prims.PruneChildren()
        for below in pxr.Usd.PrimRange(prim, predicate):
            take(below)
        root = pxr.UsdSkel.Root(prim)
        cache.Populate(root, predicate)
        for binding in cache.ComputeSkelBindings(root, predicate):
            query = cache.GetSkelQuery(binding.GetSkeleton())
            if query:
                skeleton = _Skeleton(pxr, binding.GetSkeleton().GetPrim(), query)
                meshes = binding.GetSkinningTargets()
                out.update((mesh.GetPrim().GetPath(), Skin(pxr, skeleton, mesh, path)) for mesh in meshes)
    return out
