"""Asset: a baked character, blended by the C runtime."""
from __future__ import annotations

import json
import mmap
import os
from typing import Any, Mapping, Union

import numpy as np
import numpy.typing as npt

from . import _arrays
from ._errors import Error, finding
from ._module import core

Weights = Union[npt.ArrayLike, Mapping[str, npt.ArrayLike]]
Source = Union[str, "os.PathLike[str]", bytes, bytearray, memoryview, mmap.mmap, Any]


class Asset:
    """A baked character, made by bake() and Asset.open(). It is immutable and may be used from several threads at once: each
    concurrent call uses a solver of its own, 16 to 350 KiB, which is kept for later calls.

    Vertices are in the order of the baked poses (with surface=, of that surface); lengths are in the units of the poses.
    """

    def __init__(self, view: core.AssetView, report: dict[str, Any] | None = None) -> None:
        self._view = view
        self._report = report

    @classmethod
    def open(cls, source: Source, *, verify: bool = True) -> Asset:
        """Opens an asset from a file or from bytes.

        source  a path, whose file is read into memory, or an object with a buffer. `bytes` and read-only `mmap.mmap` objects
                are kept and used in place, without a copy, if their address is a multiple of 16 (it is for both). Objects
                that may change (bytearray, memoryview, arrays) are copied. Do not write to a mapped file while the asset is
                used. The tools of Pliant replace files and never modify them.
        verify  compare all checksums, which reads every byte. Without it damage to the basis is not detected,
                but is harmless.

        Raises Error: P2001 if the file cannot be read, P5102 if the bytes are not an asset. Any bytes are safe to open.
        """
        if isinstance(source, (str, os.PathLike)):
            name = os.fspath(source)
            return cls(core.AssetView(core.read_file(name), name, verify))
        if not isinstance(source, (bytes, mmap.mmap)):
            try:
                source = bytes(memoryview(source))
            except TypeError:
                raise TypeError(f"source: expected a path or bytes, got {type(source).__name__}") from None
        return cls(core.AssetView(source, "the bytes given", verify))

    @classmethod
    def _of_bake(cls, data: bytes, report: dict[str, Any]) -> Asset:
        return cls(core.AssetView(data, "the asset just baked", False), report)

    # ------------------------------------------------------------------------------------------------------- what it is

    @property
    def pose_count(self) -> int:
        """m: the number of poses; of layers the rest shape and the layers."""
        return self._view.pose_count

    @property
    def has_layers(self) -> bool:
        """Whether weights add layers to the rest shape, pose 0; otherwise blends are averages of the poses."""
        return self._view.has_layers

    @property
    def weight_count(self) -> int:
        """The number of weights of a blend: m, or of layers m - 1."""
        return self._view.weight_count

    @property
    def weight_names(self) -> list[str]:
        """The names of the weights of a blend: of the poses, or of the layers."""
        return [name for name, _, _, _ in self._weights()]

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """By name the weights whose blends the bake has measured, (low, high); (0, 1) of averages. Layers may leave them."""
        return {name: (low, high) for name, low, high, _ in reversed(self._weights())}

    def _weights(self) -> list[tuple[str, float, float, float]]:
        return [(name.decode("utf-8", "replace"), low, high, start) for name, low, high, start in self._view.weights()]

    @property
    def vertex_count(self) -> int:
        """n: the number of vertices, including those inside a solid."""
        return self._view.vertex_count

    @property
    def dimension(self) -> int:
        """d: the number of reduced coordinates of a blend."""
        return self._view.dimension

    @property
    def names(self) -> list[str]:
        """The names of the m poses."""
        return [name.decode("utf-8", "replace") for name in self._view.names()]

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """(f, k) uint32: the baked faces if all have k corners, otherwise their triangles (t, 3). For a solid,
        its boundary."""
        return self._view.faces()

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """(t, 3) uint32: the triangles to render."""
        return self._view.triangles()

    @property
    def certificate(self) -> dict[str, Any]:
        """How the asset was baked and what was measured (formats/schema/certificate.schema.json). Raises Error P5103 if the
        certificate cannot be read."""
        try:
            certificate = json.loads(self._view.certificate())
        except (ValueError, RecursionError):
            certificate = None
        if not isinstance(certificate, dict):
            raise Error([finding(True, 5103, "", "its certificate cannot be read", "bake it again with this version")], 3)
        return certificate

    @property
    def report(self) -> dict[str, Any] | None:
        """The report of `pliant bake --report`: the certificate and the seconds of each stage. None for an opened asset."""
        return self._report

    # ---------------------------------------------------------------------------------------------------------- blending

    def _rows(self, weights: Weights) -> tuple[npt.NDArray[np.float32], bool]:
        if isinstance(weights, Mapping):  # what is not named: as the asset starts, of averages nothing
            start = [initial if self.has_layers else 0.0 for _, _, _, initial in self._weights()]
            weights = _arrays.by_name(weights, self.weight_names, start)
        what = "one per layer" if self.has_layers else "one per pose"
        rows, is_single = _arrays.rows("weights", weights, self.weight_count, what)
        return _arrays.rounded(rows), is_single

    def blend(self, weights: Weights, *, continuous: bool = False) -> npt.NDArray[np.float32]:
        """Positions of the elastic blend.

        weights     (m,) or (k, m): one number >= 0 per pose; only their ratios matter. Of layers (m - 1,) or (k, m - 1): any
                    number per layer, 0 none of it, 1 all of it. Or {name: number or (k,)}: layers that are not named have
                    the weight that the asset starts with, mostly 0, and poses take no part
        continuous  rows are frames, and each continues from the previous one as in a game (`pliant blend --path`). Otherwise
                    every row is solved independently (`pliant blend --weights`)

        Returns (n, 3) float32, or (k, n, 3), with the bits of the C runtime on every machine. Releases the interpreter's
        lock. Raises ValueError or TypeError for a wrong shape or dtype and for unknown names, Error P1204 for weights that
        are not finite, or of averages negative or all zero.
        """
        rows, is_single = self._rows(weights)
        positions = self._view.reconstruct(self._view.solve(rows, continuous), 0, self.vertex_count)
        return positions[0] if is_single else positions

    def coordinates(self, weights: Weights, *, continuous: bool = False) -> npt.NDArray[np.float32]:
        """The reduced coordinates q of a blend, (d,) or (k, d) float32: blend() without the reconstruction. Arguments and
        errors are those of blend()."""
        rows, is_single = self._rows(weights)
        q = self._view.solve(rows, continuous)
        return q[0] if is_single else q

    def reconstruct(self, q: npt.ArrayLike, first: int = 0, count: int | None = None) -> npt.NDArray[np.float32]:
        """Positions for any reduced coordinates.

        q             (d,) or (k, d)
        first, count  the vertices first .. first + count - 1; None: all from first on.
                      For a solid any range costs as much as all

        Returns (count, 3) float32, or (k, count, 3). Raises ValueError or TypeError for a wrong shape, dtype or range.
        """
        rows, is_single = _arrays.rows("q", q, self.dimension, "the coordinates of a blend")
        n = self.vertex_count
        if not 0 <= first <= n:
            raise ValueError(f"first: expected 0 to {n}, got {first}")
        if count is None:
            count = n - first
        if not 0 <= count <= n - first:
            raise ValueError(f"count: expected 0 to {n - first} from vertex {first} on, got {count}")
        positions = self._view.reconstruct(_arrays.rounded(rows), first, count)
        return positions[0] if is_single else positions

    def normals(self, positions: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Normals of a blend, of length 1, weighted by the areas of triangles. Welded seams are smooth.

        positions  (n, 3) or (k, n, 3), as returned by blend()

        Returns float32 of the same shape. Vertices without a triangle, such as those inside a solid, have (0, 0, 1).
        """
        n = self.vertex_count
        expected = f"({n}, 3) or (k, {n}, 3): positions of a blend"
        array = np.asarray(positions)
        is_single = array.ndim == 2
        shape = (n, 3) if is_single else (None, n, 3)
        rows = _arrays.rounded(_arrays.numbers("positions", array, shape, expected)).reshape(-1, n, 3)
        normals = self._view.normals(rows)
        return normals[0] if is_single else normals

    # -------------------------------------------------------------------------------------------------- the reduced model

    @property
    def rest(self) -> npt.NDArray[np.float32]:
        """(n, 3) float32: positions for q = 0, in the units of the poses. Blends are rest + basis @ q."""
        rest: npt.NDArray[np.float32] = self.reconstruct(np.zeros(self.dimension))
        return rest

    @property
    def basis(self) -> npt.NDArray[np.float32]:
        """(n, 3, d) float32: the basis of the subspace. rest + basis @ q is reconstruct(q) to single precision, and
        basis.reshape(-1, d) has a row for each of the 3 n coordinates. Of a compressed basis these are the numbers that the
        runtime unpacks. Computed anew at each access, by d reconstructions: keep it."""
        scale = 2.0**20  # beside which the rest positions are rounding; a power of two changes no digit
        rest = self.rest.astype(np.float64)
        basis = np.empty((self.vertex_count, 3, self.dimension), np.float32)
        for j, unit in enumerate(scale * np.eye(self.dimension)):
            basis[..., j] = (self.reconstruct(unit) - rest) / scale
        return basis

    @property
    def pose_coordinates(self) -> npt.NDArray[np.float32]:
        """(m, d) float32: the reduced coordinates of the poses; reconstruct() makes the poses of them."""
        return self._view.pose_coordinates()

    def linear_blend(self, weights: Weights) -> npt.NDArray[np.float32]:
        """The linear blend of the poses, or of layers the rest shape and the weighted differences from it: what morph
        targets draw, to compare with. Arguments, result and errors are those of blend()."""
        rows, is_single = self._rows(weights)
        self._view.solve(rows, False)  # refuses what blend() refuses
        shares = rows.astype(np.float64)
        if self.has_layers:
            shares = np.column_stack([1 - shares.sum(1), shares])
        else:
            shares /= shares.sum(1, keepdims=True)
        positions = self._view.reconstruct((shares @ self.pose_coordinates).astype(np.float32), 0, self.vertex_count)
        return positions[0] if is_single else positions

    def energy(self, weights: Weights, q: npt.ArrayLike) -> Any:
        """The function of q that blend() minimises for the weights: the surrogate energy and, if the asset has one, its dead
        load. Relative to the average of equal weights, or of layers to the rest shape, so it may be negative.

        weights  as for blend()
        q        (d,) or (k, d): reduced coordinates. One row of either goes with all rows of the other

        Returns a float, or (k,) float64, in the unit of pliant.energy(); +inf where it is not finite. The runtime computes
        it in single precision: differences below 2e-5 of the energies of the poses are noise. Raises the errors of blend()
        for the weights, and ValueError or TypeError for q.
        """
        values, _, is_single = self._energies(weights, q)
        return float(values[0]) if is_single else values

    def energy_gradient(self, weights: Weights, q: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The derivatives of energy() by q, (d,) or (k, d) float64, to single precision; arguments as there. At
        coordinates(weights) they are as small as the runtime's tolerance demands."""
        _, gradients, is_single = self._energies(weights, q)
        return gradients[0] if is_single else gradients

    def energy_hessian(self, weights: Weights, q: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """The second derivatives of energy() by q, (d, d) float64, for one row of each. The runtime has none (it minimises
        by BFGS): these are central differences of energy_gradient(), made symmetric, over 1e-3 of the largest coordinate
        of the poses. They have three to five digits."""
        centre = _arrays.numbers("q", q, (self.dimension,), f"({self.dimension},): reduced coordinates")
        rows, is_single = self._rows(weights)
        if not is_single:
            raise ValueError(f"weights: expected ({self.weight_count},), got {rows.shape}")
        step = 1e-3 * float(np.abs(self.pose_coordinates).max()) or 1e-3
        steps = step * np.eye(self.dimension)
        change = self.energy_gradient(rows[0], centre + steps) - self.energy_gradient(rows[0], centre - steps)
        hessian: npt.NDArray[np.float64] = (change + change.T) / (4 * step)
        return hessian

    def _energies(
        self, weights: Weights, q: npt.ArrayLike
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], bool]:
        rows, is_one_weight = self._rows(weights)
        points, is_one_point = _arrays.rows("q", q, self.dimension, "reduced coordinates")
        count = len(points) if len(rows) == 1 else len(rows)
        if len(points) not in (1, count):
            raise ValueError(f"q: expected 1 or {count} rows, as there are rows of weights, got {len(points)}")
        rows = np.ascontiguousarray(np.broadcast_to(rows, (count, rows.shape[1])))
        points = np.ascontiguousarray(np.broadcast_to(points, (count, self.dimension)))
        return (*self._view.energy(rows, points), is_one_weight and is_one_point)

    # ------------------------------------------------------------------------------------------------------------ bytes

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the .pliant file atomically, through a temporary file in the same folder. Raises Error P40xx if that fails;
        an existing file is then unchanged."""
        core.write_file(os.fspath(path), bytes(self))

    def __bytes__(self) -> bytes:
        """The bytes that save() writes."""
        return self._view.bytes()

    def __len__(self) -> int:
        """The number of bytes."""
        return self._view.size

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickle, (bytes(self), self._report)

    def __repr__(self) -> str:
        kind = "solid" if self._view.is_solid else "surface"
        what = f"{self.weight_count} layers on {self.names[0]}" if self.has_layers else f"{self.pose_count} poses"
        return (
            f"<pliant.Asset {kind}: {what} ({', '.join(self.weight_names)}), {self.vertex_count} vertices, "
            f"d = {self.dimension}, {len(self) / 1048576:.1f} MiB>"
        )


def _unpickle(data: bytes, report: dict[str, Any] | None) -> Asset:
    return Asset(core.AssetView(data, "the pickled asset", True), report)
