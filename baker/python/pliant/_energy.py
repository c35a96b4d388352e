"""energy(): the unreduced elastic energy with its derivatives, for research and for checks."""
from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, Sequence

import numpy as np
import numpy.typing as npt

from . import _arrays, _bake, _options, _poses
from ._bake import Continuity, Material, Membrane, Progress, Solver
from ._meshes import Mesh
from ._module import core
from ._poses import Blend

if TYPE_CHECKING:
    import scipy.sparse  # type: ignore[import-untyped,import-not-found,unused-ignore]


class Energy:
    """The elastic energy W(w, x) of a mesh, made by energy(): how much the shape x is strained against the poses.

    Of averages W(w, x) = sum_k w_k W_k(x) with the weights divided by their sum, and W_k is zero at pose k. So
    value(x, [1, 0]) is W_0(x) of two poses, and average() is where W(w, .) is least. Of layers W(w, x) is the energy of one
    body whose rest state is blended from the layers; without weights that of the rest shape.

    x        (n, 3): positions of all vertices, in the order and units of the poses. Of vertices that were welded the energy
             looks at the first, and derivatives by the others are zero; `vertices` lists those that it looks at
    weights  (m,), or of layers (m - 1,); None: equal weights, or no layer
    value    a number without unit, which depends neither on the size nor on the place of the character: lengths are divided
             by `length`. +inf where a material refuses a collapsed element; derivatives are nan there
    gradient, hessian  are by x, in the units of the poses: 1 / unit and 1 / unit^2

    All numbers are float64. An Energy is immutable and may be used from several threads at once. Its functions release the
    interpreter's lock. They raise ValueError or TypeError for a wrong shape, dtype, or positions that are not finite, and
    Error P1204 for weights that are not finite, or of averages negative or all zero.
    """

    def __init__(self, view: core.EnergyView, has_layers: bool) -> None:
        self._view = view
        self._has_layers = has_layers
        try:  # here and not in hessian(): a child that is forked while another thread imports would wait for ever
            self._sparse: Any = importlib.import_module("scipy.sparse")
        except ImportError:
            self._sparse = None

    @property
    def vertex_count(self) -> int:
        """n: the number of vertices of the poses."""
        return self._view.vertex_count

    @property
    def weight_count(self) -> int:
        """The number of weights: m, or of layers m - 1."""
        return self._view.weight_count

    @property
    def poses(self) -> npt.NDArray[np.float64]:
        """(m, n, 3): the poses as the energy knows them, aligned to the first one unless no_align or fix was given."""
        return self._view.poses()

    @property
    def vertices(self) -> npt.NDArray[np.uint32]:
        """(k,) uint32: the vertices that the energy looks at, all but those that another one stands for."""
        return self._view.vertices()

    @property
    def masses(self) -> npt.NDArray[np.float64]:
        """(n,): the share of the area or volume around each vertex, with the sum 1: the inner product in which errors are
        measured. Zero for vertices that another one stands for."""
        return self._view.masses()

    @property
    def length(self) -> float:
        """The unit of length of the energy, in units of the poses: the root of the mean area of the poses, or of a solid
        the cube root of its mean volume."""
        return self._view.length

    def value(self, x: npt.ArrayLike, weights: npt.ArrayLike | None = None) -> float:
        """W(w, x). Cost: linear in the faces or tetrahedra."""
        return self._view.value(self._positions(x), self._weights(weights))

    def gradient(self, x: npt.ArrayLike, weights: npt.ArrayLike | None = None) -> npt.NDArray[np.float64]:
        """(n, 3): the derivatives of value() by x. Cost: linear in the faces or tetrahedra."""
        return self._view.gradient(self._positions(x), self._weights(weights))

    def hessian(
        self, x: npt.ArrayLike, weights: npt.ArrayLike | None = None, *, projected: bool = False
    ) -> scipy.sparse.csc_matrix | tuple[npt.NDArray[np.int64], npt.NDArray[np.int64], npt.NDArray[np.float64]]:
        """The second derivatives of value(): (3 n, 3 n), both triangles; coordinate c of vertex v has the number 3 v + c.

        projected  the part of each element is made positive semidefinite, as Newton steps far from a minimum want it

        Returns a scipy.sparse.csc_matrix, or without scipy the arrays (rows, columns, values), each entry once.
        """
        rows, columns, values = self._view.hessian(self._positions(x), self._weights(weights), bool(projected))
        if self._sparse is None:
            return rows, columns, values
        size = 3 * self.vertex_count
        return self._sparse.csc_matrix((values, (rows, columns)), shape=(size, size))

    def _positions(self, x: npt.ArrayLike) -> npt.NDArray[np.float64]:
        n = self.vertex_count
        array = _arrays.numbers("x", x, (n, 3), f"({n}, 3): positions of the vertices")
        if not np.isfinite(array).all():
            raise ValueError("x: a position is not finite")
        return array

    def _weights(self, weights: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
        count = self.weight_count
        if weights is None:
            return np.zeros(count) if self._has_layers else np.full(count, 1 / count)
        expected = f"({count},): one per {'layer' if self._has_layers else 'pose'}"
        return _arrays.numbers("weights", weights, (count,), expected)

    def __repr__(self) -> str:
        what = f"{self.weight_count} layers" if self._has_layers else f"{self.weight_count} poses"
        return f"<pliant.Energy of {what}, {self.vertex_count} vertices>"


def energy(
    poses: npt.ArrayLike | _poses.Poses | Sequence[Mesh],
    faces: npt.ArrayLike | None = None,
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
) -> Energy:
    """The unreduced elastic energy that average() minimises and that a bake reduces (baker/elastic/THEORY.md).

        energy = pliant.energy(poses, faces)
        energy.value(x, [0.5, 0.5]), energy.gradient(x, [0.5, 0.5]), energy.hessian(x, [0.5, 0.5])

    Arguments are those of average(). Making it checks and aligns the poses; of a character in several parts it also computes
    some averages, by which the ties between parts are calibrated. Raises the errors of bake() for arguments and poses.
    """
    source, _, vertex_count, blend = _bake.source_of(poses, faces, tets, None, blend)
    given: dict[str, Any] = {
        "blend": blend,
        "material": material, "continuity": continuity, "membrane": membrane, "thickness": thickness,
        "foldover_damping": foldover_damping, "poisson": poisson, "weld": weld, "fix": fix, "no_align": no_align,
        "solver": solver, "threads": threads,
    }  # fmt: skip
    options = _options.checked(given, vertex_count)
    view = core.EnergyView(source, options, _bake.listening(progress), _poses.warner(3))
    return Energy(view, blend == "layers")
