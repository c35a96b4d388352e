"""bake() and average()."""
from __future__ import annotations

import json
import os
from typing import Any, Callable, Literal, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _meshes, _options, _poses
from ._asset import Asset
from ._errors import ToleranceError, finding
from ._meshes import Mesh
from ._module import core
from ._poses import Blend

Progress = Optional[Callable[[str, float, float], object]]
Material = Literal["discrete-shells", "arap", "stvk", "mooney-rivlin"]
Continuity = Literal["auto", "off"]
Membrane = Literal["neo-hookean", "stvk", "edge"]
Solver = Literal["cholmod", "eigen"]
Range = Union[Tuple[float, float], Mapping[str, Tuple[float, float]]]
Surface = Union[str, "os.PathLike[str]", Tuple[npt.ArrayLike, npt.ArrayLike], Mesh]


def source_of(
    poses: object, faces: object, tets: object, names: Sequence[str] | None, blend: object
) -> tuple[core.Poses, int, int, Blend]:
    """The poses, their number, the number of vertices of the first one, and how they are blended."""
    if blend is None:
        blend = poses.blend if isinstance(poses, _poses.Poses) else "average"
    limit = _poses.pose_limit(blend)
    if _meshes.are_meshes(poses):
        if faces is not None or tets is not None:
            raise TypeError("meshes have faces or tets of their own: give none")
        poses, faces, tets = _meshes.stacked(poses)  # type: ignore[arg-type]
    if not isinstance(poses, _poses.Poses):
        source = _poses.from_arrays(poses, faces, tets, names, limit)
    elif faces is not None or tets is not None or names is not None:
        raise TypeError("Poses have faces, tets and names of their own: give none")
    else:
        source = poses._source
        _poses.check_count(source.pose_count, limit, source.pose_count)
    return source, source.pose_count, source.vertex_count, "layers" if blend == "layers" else "average"


def listening(progress: object) -> Any:
    if progress is not None and not callable(progress):
        raise TypeError(f"progress: expected a callable of (stage, done, total), got {progress!r}")
    return progress


def bake(
    poses: npt.ArrayLike | _poses.Poses | Sequence[Mesh],
    faces: npt.ArrayLike | None = None,
    *,
    tets: npt.ArrayLike | None = None,
    names: Sequence[str] | None = None,
    blend: Blend | None = None,
    range: Range | None = None,
    material: Material | None = None,
    tolerance: float | None = None,
    tolerance_max: float | None = None,
    best_effort: bool = False,
    subspace: Literal["adaptive", "krylov", "barbic"] = "adaptive",
    dim: int | None = None,
    ritz: int | None = None,
    energy: Literal["auto", "quartic", "cubature", "ghost"] = "auto",
    elements: int | None = None,
    cubature: Literal["nnls", "nn-htp"] = "nnls",
    ghost_vertices: int | None = None,
    check_samples: int | None = None,
    fresh_samples: int | None = None,
    position_error: float | None = None,
    time_limit: float | None = None,
    preview: bool = False,
    continuity: Continuity | None = None,
    membrane: Membrane | None = None,
    thickness: float | None = None,
    foldover_damping: float | None = None,
    poisson: float | None = None,
    weld: float | None = None,
    fix: npt.ArrayLike | None = None,
    no_align: bool = False,
    surface: Surface | None = None,
    no_scene: bool = False,
    solver: Solver | None = None,
    seed: int | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Asset:
    """Bakes poses into an asset, which takes minutes for a character of some 15,000 vertices. The same poses, names and
    options give the same bytes as `pliant bake`.

    poses  (m, n, 3) float64, 2 to 64 poses of one mesh in any unit, the rest pose first. Or Poses, or a list of meshes such
           as trimesh.Trimesh and meshio.Mesh (known by their .vertices and .faces, or .points and .cells_dict): these have
           their own cells. With blend="layers" the rest shape and 1 to 64 layers on it
    faces  (f, 3) integers, the triangles of a surface, vertices counted from 0; or (f, k) for polygons
    tets   (t, 4) integers, the tetrahedra of a solid, instead of faces
    names  m strings that the asset stores; default pose_0, pose_1, ...

    blend  "average": the blend is an average of the poses. "layers": the poses after the first are layers on it, such as
           the expressions of a face; their weights add up and may be negative. Default: that of Poses, else "average"
    range  of layers: the weights that are measured, (low, high) for all layers or {name: (low, high)} for some;
           default (0, 1)

    Options have the names of the command line with underscores; None selects the default.
    `pliant bake --help` explains them all.
    material, continuity, membrane, thickness, foldover_damping, poisson, weld   the elastic energy
    fix             (k,) indices of vertices to keep in place; implies no_align
    no_align        do not align the poses rigidly
    surface         render mesh that replaces the boundary of a solid: a file, a pair of positions (s, 3) and faces (g, k),
                    or a mesh as above
    tolerance       tolerance for the mean relative L2 error of blends, 1e-8 to 1. If it is given and missed, ToleranceError
                    is raised. If not given, the bake aims at 1e-3, and missing that is a warning (P4404)
    tolerance_max   the same for the largest error
    best_effort     store the asset in the ToleranceError, as time_limit and preview do
    subspace, dim, ritz, energy, elements, cubature, ghost_vertices   the reduced model
    check_samples, fresh_samples   numbers of unreduced averages that the errors are measured at
    position_error  largest movement of a vertex by compressing the basis, relative to the diagonal
    time_limit      seconds after which the bake refines no more and returns the best so far
    preview         a rough asset quickly: time_limit=0 and tolerance=5e-3, each if not given
    no_scene        do not store materials and images of glTF poses
    solver, seed    results depend on them
    threads         results do not depend on it; None: all cores

    progress  called as progress(stage, done, total) on the calling thread, at most about 20 times a second, with the name of
              the stage and how much of the whole bake is done, out of a total of 1.0; it never decreases. An exception that
              it raises stops the bake. It cannot bake or average itself: RuntimeError.

    Ctrl-C stops a bake at its next step, within a second up to some 6,000 vertices (the longest step is one sparse
    factorization); nothing is left running. Warnings are of class PliantWarning; a warning that is turned into an error
    stops the bake, too.

    Raises TypeError and ValueError for wrong arguments, which they name; Error for poses that have no elastic average
    (P2xxx, P3xxx) and for failures of the computation (P4xxx); ToleranceError.
    """
    source, _, vertex_count, blend = source_of(poses, faces, tets, names, blend)
    options = _options.checked(
        {
            "blend": blend, "range": range,
            "material": material, "tolerance": tolerance, "tolerance_max": tolerance_max, "best_effort": best_effort,
            "subspace": subspace, "dim": dim, "ritz": ritz, "energy": energy, "elements": elements, "cubature": cubature,
            "ghost_vertices": ghost_vertices, "check_samples": check_samples, "fresh_samples": fresh_samples,
            "position_error": position_error, "time_limit": time_limit, "preview": preview,
            "continuity": continuity, "membrane": membrane, "thickness": thickness,
            "foldover_damping": foldover_damping, "poisson": poisson, "weld": weld, "fix": fix, "no_align": no_align,
            "no_scene": no_scene, "solver": solver, "seed": seed, "threads": threads,
        },
        vertex_count,
    )  # fmt: skip
    drawn, drawn_path = _poses.surface_of(surface)
    data, report, missed = core.bake(source, options, drawn, drawn_path, listening(progress), _poses.warner(3))
    asset = Asset._of_bake(data, json.loads(report))
    if missed is not None:
        raise ToleranceError([finding(True, 4405, "", *missed)], asset=asset)
    return asset


def average(
    poses: npt.ArrayLike | _poses.Poses | Sequence[Mesh],
    faces: npt.ArrayLike | None = None,
    weights: npt.ArrayLike | None = None,
    *,
    tets: npt.ArrayLike | None = None,
    blend: Blend | None = None,
    material: Material | None = None,
    continuity: Continuity | None = None,
    membrane: Membrane | None = None,
    thickness: float | None = None,
    foldover_damping: float | None = None,
    poisson: float | None = None,
    weld: float | None = None,
    fix: npt.ArrayLike | None = None,
    no_align: bool = False,
    solver: Solver | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> npt.NDArray[np.float64]:
    """The unreduced elastic average: the slow reference that blends approximate. The same as `pliant average`.

    poses, faces, tets  as for bake()
    weights             (m,) or (k, m): one number >= 0 per pose; only their ratios matter. With blend="layers" (m - 1,) or
                        (k, m - 1): any number per layer, 1 is all of it
    blend               as for bake()
    The options are those of bake() that define the energy; progress is called as by bake().

    Returns (n, 3) float64, or (k, n, 3): positions in the order and units of the poses. Several rows in one call cost less
    than several calls, since the average of all poses, from which each row starts, is computed once.

    Raises the errors of bake() for arguments and poses; Error P1204 for weights that are negative, not finite or all zero,
    P4303 if an average does not converge, P4305 if layers have no shape together. Warns (P4406) where the average jumps.
    """
    if weights is None:
        raise TypeError("average() needs weights: (m,) or (k, m), one per pose")
    source, pose_count, vertex_count, blend = source_of(poses, faces, tets, None, blend)
    if blend == "layers":
        rows, is_single = _arrays.rows("weights", weights, pose_count - 1, "one per layer")
    else:
        rows, is_single = _arrays.rows("weights", weights, pose_count, "one per pose")
    options = _options.checked(
        {
            "blend": blend,
            "material": material, "continuity": continuity, "membrane": membrane, "thickness": thickness,
            "foldover_damping": foldover_damping, "poisson": poisson, "weld": weld, "fix": fix, "no_align": no_align,
            "solver": solver, "threads": threads,
        },
        vertex_count,
    )  # fmt: skip
    shapes = core.average(source, rows, options, listening(progress), _poses.warner(3))
    return shapes[0] if is_single else shapes
