"""Asset: a baked character, blended by the C runtime."""
from __future__ import annotations

import json
import mmap
import os
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _arrays
from ._errors import Error, finding
from ._module import core

Source = Union[str, "os.PathLike[str]", bytes, bytearray, memoryview, mmap.mmap, Any]


class Asset:
    """A baked character. Made by bake() and Asset.open(); it does not change, and may be used from several threads at once: every call
    has a solver of its own, 16 to 350 KiB, which is kept for later calls.

    Vertices have the order of the poses that were baked (of a bake with surface=, that of the surface), lengths their units.
    """

    def __init__(self, view: core.AssetView, report: dict[str, Any] | None = None) -> None:
        self._view = view
        self._report = report

    @classmethod
    def open(cls, source: Source, *, verify: bool = True) -> Asset:
        """An asset from a file or from bytes.

        source  a path, which is read into memory; or an object with a buffer. `bytes` and read-only `mmap.mmap` objects are kept and
                used where they are, without a copy, if they lie at a multiple of 16 (bytes do, and so do maps). What could change
                (bytearray, memoryview, arrays) is copied. A file behind a map must not be written to while the asset is used; our own
                tools replace files and never change them.
        verify  compare all checksums, which reads every byte. Without, damage to the basis goes unseen, but can do no harm.

        Raises Error: P2001 for a file that cannot be read, P5102 for bytes that are no asset. Any bytes are safe to open.
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
        """m: how many weights a blend has."""
        return self._view.pose_count

    @property
    def vertex_count(self) -> int:
        """n, those inside a solid included."""
        return self._view.vertex_count

    @property
    def dimension(self) -> int:
        """d: how many reduced coordinates a blend has."""
        return self._view.dimension

    @property
    def names(self) -> list[str]:
        """m names of poses."""
        return [name.decode("utf-8", "replace") for name in self._view.names()]

    @property
    def faces(self) -> npt.NDArray[np.uint32]:
        """(f, k) uint32, as they were baked, if all have k corners; else their triangles (t, 3). Of a solid its boundary."""
        return self._view.faces()

    @property
    def triangles(self) -> npt.NDArray[np.uint32]:
        """(t, 3) uint32: what is drawn."""
        return self._view.triangles()

    @property
    def certificate(self) -> dict[str, Any]:
        """What the asset says about how it was baked and what was measured (formats/schema/certificate.schema.json). Raises Error
        P5103 if it says nothing that can be read."""
        try:
            certificate = json.loads(self._view.certificate())
        except ValueError:
            certificate = None
        if not isinstance(certificate, dict):
            raise Error([finding(True, 5103, "", "its certificate cannot be read", "bake it again with this version")], 3)
        return certificate

    @property
    def report(self) -> dict[str, Any] | None:
        """What `pliant bake --report` writes: the certificate and the seconds of each stage. None for an asset that was opened."""
        return self._report

    # ---------------------------------------------------------------------------------------------------------- blending

    def blend(self, weights: npt.ArrayLike, *, continuous: bool = False) -> npt.NDArray[np.float32]:
        """Positions of the elastic blend.

        weights     (m,) or (k, m): one number >= 0 per pose, of which only the ratios matter
        continuous  rows are frames, and each goes on from the one before as in a game: `pliant blend --path`. Else every row is solved
                    as if it were alone: `pliant blend --weights`

        Returns (n, 3) float32, or (k, n, 3). The bits are those of the C runtime anywhere. Releases the interpreter's lock.
        Raises ValueError and TypeError for shapes and kinds, Error P1204 for weights that are negative, not finite or all zero.
        """
        rows, is_single = _arrays.rows("weights", weights, self.pose_count, "one per pose")
        positions = self._view.reconstruct(self._view.solve(_arrays.rounded(rows), continuous), 0, self.vertex_count)
        return positions[0] if is_single else positions

    def coordinates(self, weights: npt.ArrayLike, *, continuous: bool = False) -> npt.NDArray[np.float32]:
        """The reduced coordinates q of a blend, (d,) or (k, d) float32: the part of blend() that is solved. Arguments and errors as
        there."""
        rows, is_single = _arrays.rows("weights", weights, self.pose_count, "one per pose")
        q = self._view.solve(_arrays.rounded(rows), continuous)
        return q[0] if is_single else q

    def reconstruct(self, q: npt.ArrayLike, first: int = 0, count: int | None = None) -> npt.NDArray[np.float32]:
        """Positions for reduced coordinates, whatever they are.

        q             (d,) or (k, d)
        first, count  the vertices first .. first + count - 1; None: all from first on. Of a solid a part costs as much as all

        Returns (count, 3) float32, or (k, count, 3). Raises ValueError and TypeError for shapes, kinds and ranges.
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
        """Normals of a blend: of length 1, triangles weighted by their areas; seams that were welded are smooth.

        positions  (n, 3) or (k, n, 3), as blend() gives them

        Returns as many float32. Vertices without a triangle, those inside a solid among them, have (0, 0, 1).
        """
        n = self.vertex_count
        expected = f"({n}, 3) or (k, {n}, 3): positions of a blend"
        array = np.asarray(positions)
        is_single = array.ndim == 2
        shape = (n, 3) if is_single else (None, n, 3)
        rows = _arrays.rounded(_arrays.numbers("positions", array, shape, expected)).reshape(-1, n, 3)
        normals = self._view.normals(rows)
        return normals[0] if is_single else normals

    # ------------------------------------------------------------------------------------------------------------ bytes

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the .pliant file, whole or not at all: under a temporary name in the same folder first. Raises Error P40xx if that
        fails; then a file that was there is as it was."""
        core.write_file(os.fspath(path), bytes(self))

    def __bytes__(self) -> bytes:
        """What save() writes."""
        return self._view.bytes()

    def __len__(self) -> int:
        """The number of bytes."""
        return self._view.size

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickle, (bytes(self), self._report)

    def __repr__(self) -> str:
        kind = "solid" if self._view.is_solid else "surface"
        return (
            f"<pliant.Asset {kind}: {self.pose_count} poses ({', '.join(self.names)}), {self.vertex_count} vertices, "
            f"d = {self.dimension}, {len(self) / 1048576:.1f} MiB>"
        )


def _unpickle(data: bytes, report: dict[str, Any] | None) -> Asset:
    return Asset(core.AssetView(data, "the pickled asset", True), report)
