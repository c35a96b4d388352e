"""Assets for the tests of pliant_gl: make_gl_assets.py TINY_ASSETS FOLDER NAME...

Copies the named small assets and makes large.pliant: many copies of tube_neo side by side, so more vertices than a texture's
row has texels; every second one has its normals smoothed in pairs (SMTH). large_compact.pliant is the same with a compact
basis of many widths, large_factored.pliant with a factored one. The surrogate energy looks at no vertices, so it remains
what it was.
"""
import shutil
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / "runtime")]
import pliant_reference_path  # noqa: E402, F401
from pliant_reference import Asset  # noqa: E402
import tiny_shape  # noqa: E402
from tiny_asset import assemble, floats, tiles_of  # noqa: E402

COPIES = 45


def multiplied(asset, copies, tag="BASI", error=0.0):
    n = asset.vertex_count
    shifts = np.array([[0.0, 2.0 * (i % 9), 2.0 * (i // 9)] for i in range(copies)])
    rest = (asset.rest[None] + shifts[:, None]).reshape(-1, 3)
    basis = np.tile(asset.basis, (1, copies, 1))
    basis *= np.repeat(0.05 + np.arange(copies) % 7 / 6, n)[:, None]  # so that tiles need different widths
    triangles = np.concatenate([asset.triangles + i * n for i in range(copies)])
    groups = np.arange(copies * n)
    groups -= (groups // n % 2) * (groups % 2)
    new = {"REST": floats(tiles_of(rest)), "BASI": floats(tiles_of(basis)), "TRIS": triangles.astype("<u4").tobytes()}
    chunks = [(tag, asset.flags[tag], new.get(tag) or asset.bytes_of(tag)) for tag in asset.chunks if tag != "POLY"]
    if tag == "BASC":
        chunks[-1] = (tag, 1, tiny_shape.compact_chunk(basis, error))
    if tag == "BASF":
        chunks[-1] = (tag, 1, tiny_shape.factored_chunk(rest, basis, error))
        chunks = [chunk for chunk in chunks if chunk[0] != "REST"]
    chunks.insert(-1, ("SMTH", 0, groups.astype("<u4").tobytes()))
    counts = (copies * n, len(triangles), asset.dimension, asset.pose_count)
    return assemble(counts, asset.origin, chunks)


def main():
    source, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[3:]:
        shutil.copy(source / f"{name}.pliant", folder)
    tube = Asset((source / "tube_neo.pliant").read_bytes())
    for name, tag, error in (("large", "BASI", 0.0), ("large_compact", "BASC", 1e-6), ("large_factored", "BASF", 1e-4)):
        blob = multiplied(tube, COPIES, tag, error)
        Asset(blob)
        (folder / f"{name}.pliant").write_bytes(blob)
    return 0


if __name__ == "__main__":
    sys.exit(main())
