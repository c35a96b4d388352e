"""bake() and average()."""
from __future__ import annotations

import json
import os
from typing import Any, Callable, Literal, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _arrays, _options, _poses
from ._asset import Asset
from ._errors import ToleranceError, finding
from ._module import core

Progress = Optional[Callable[[str, float, float], object]]
Material = Literal["discrete-shells", "arap", "stvk", "mooney-rivlin"]
Membrane = Literal["neo-hookean", "stvk", "edge"]
Solver = Literal["cholmod", "eigen"]
Surface = Union[str, "os.PathLike[str]", Tuple[npt.ArrayLike, npt.ArrayLike]]


def _source(poses: object, faces: object, tets: object, names: Sequence[str] | None) -> tuple[core.Poses, int, int]:
    """The poses with their count and the number of vertices of the first."""
    if not isinstance(poses, _poses.Poses):
        source = _poses.from_arrays(poses, faces, tets, names)
    elif faces is not None or tets is not None or names is not None:
        raise TypeError("Poses have faces, tets and names of their own: give none")
    else:
        source = poses._source
    return source, source.pose_count, source.vertex_count


def _listening(progress: object) -> Any:
    if progress is not None and not callable(progress):
        raise TypeError(f"progress: expected a callable of (stage, done, total), got {progress!r}")
    return progress


def bake(
    poses: npt.ArrayLike | _poses.Poses,
    faces: npt.ArrayLike | None = None,
    *,
    tets: npt.ArrayLike | None = None,
    names: Sequence[str] | None = None,
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
    """Turns poses into an asset: minutes for a character of some 15,000 vertices. `pliant bake` with arrays in and an Asset out; the
    same poses, names and options give the same bytes.

    poses  (m, n, 3) float64, 2 to 12 positions of one mesh in any unit, the rest pose first; or Poses, which bring their cells
    faces  (f, 3) integers, triangles of a surface with vertices from 0; or (f, k), polygons
    tets   (t, 4) integers, tetrahedra of a solid, in place of faces
    names  m strings that the asset keeps; pose_0, pose_1, ... by default

    Options have the names of the command line with underscores; None means its default. `pliant bake --help` explains them all.
    material, membrane, thickness, foldover_damping, poisson, weld   the elastic energy
    fix             (k,) vertex numbers that stay where they are; implies no_align
    no_align        take the poses where they stand
    surface         what a solid draws in the place of its boundary: a file, or a pair of positions (s, 3) and faces (g, k)
    tolerance       wanted mean relative L2 error of blends, 1e-8 to 1. Given and missed: ToleranceError. Left out, 1e-3 is an aim,
                    and missing it a warning (P4404)
    tolerance_max   the same for the largest error
    best_effort     the ToleranceError carries the asset
    subspace, dim, ritz, energy, elements, cubature, ghost_vertices   the reduced model
    check_samples, fresh_samples   unreduced averages that it is judged by
    position_error  how far a vertex may be moved by storing the basis in few bits, over the diagonal
    no_scene        of Poses from glTF: do not store materials and images
    solver, seed    results depend on them
    threads         results do not depend on it; None: all cores

    progress  called as progress(stage, done, total) on the calling thread, at most some 20 times a second: the name of the stage, and
              how much of it is done, of 1.0. What it raises stops the bake.

    Ctrl-C stops a bake at its next step, within a second up to some 6,000 vertices (the longest step is one sparse factorisation);
    nothing is left running. Warnings are
    PliantWarning; one that is made an error stops the bake, too.

    Raises TypeError and ValueError for arguments, naming them; Error for poses of which there is no elastic average (P2xxx, P3xxx) and
    for what fails while working (P4xxx); ToleranceError.
    """
    source, _, vertex_count = _source(poses, faces, tets, names)
    options = _options.checked(
        {
            "material": material, "tolerance": tolerance, "tolerance_max": tolerance_max, "best_effort": best_effort,
            "subspace": subspace, "dim": dim, "ritz": ritz, "energy": energy, "elements": elements, "cubature": cubature,
            "ghost_vertices": ghost_vertices, "check_samples": check_samples, "fresh_samples": fresh_samples,
            "position_error": position_error, "membrane": membrane, "thickness": thickness,
            "foldover_damping": foldover_damping, "poisson": poisson, "weld": weld, "fix": fix, "no_align": no_align,
            "no_scene": no_scene, "solver": solver, "seed": seed, "threads": threads,
        },
        vertex_count,
    )  # fmt: skip
    drawn, drawn_path = _poses.surface_of(surface)
    data, report, missed = core.bake(source, options, drawn, drawn_path, _listening(progress), _poses.warner(3))
    asset = Asset._of_bake(data, json.loads(report))
    if missed is not None:
        raise ToleranceError([finding(True, 4405, "", *missed)], asset=asset)
    return asset


def average(
    poses: npt.ArrayLike | _poses.Poses,
    faces: npt.ArrayLike | None = None,
    weights: npt.ArrayLike | None = None,
    *,
    tets: npt.ArrayLike | None = None,
    material: Material | None = None,
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
    """The unreduced elastic average, which blends approximate: the truth, slowly. `pliant average` with arrays.

    poses, faces, tets  as for bake()
    weights             (m,) or (k, m): one number >= 0 per pose, of which only the ratios matter
    The options are those of bake() that make the energy; progress is called as there.

    Returns (n, 3) float64, or (k, n, 3): positions in the order and units of the poses. Many rows in one call cost less than one by
    one: the average of all poses, from which each starts, is found once.

    Raises what bake() raises for arguments and poses; Error P1204 for weights that are negative, not finite or all zero, P4303 if an
    average does not converge. Warns (P4406) where the average jumps.
    """
    if weights is None:
        raise TypeError("average() needs weights: (m,) or (k, m), one per pose")
    source, pose_count, vertex_count = _source(poses, faces, tets, None)
    rows, is_single = _arrays.rows("weights", weights, pose_count, "one per pose")
    options = _options.checked(
        {
            "material": material, "membrane": membrane, "thickness": thickness, "foldover_damping": foldover_damping,
            "poisson": poisson, "weld": weld, "fix": fix, "no_align": no_align, "solver": solver, "threads": threads,
        },
        vertex_count,
    )  # fmt: skip
    shapes = core.average(source, rows, options, _listening(progress), _poses.warner(3))
    return shapes[0] if is_single else shapes
