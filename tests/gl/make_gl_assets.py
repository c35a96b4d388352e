"""Assets for the tests of pliant_gl: make_gl_assets.py TINY_ASSETS FOLDER NAME...

Copies the named small assets and makes large.pliant: many copies of tube_neo side by side, so more vertices than a texture's row has
texels; every second one has its normals smoothed in pairs (SMTH). The stand-in looks at no vertices, so it remains what it was.
"""
import shutil
import sys
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / "runtime")]
import pliant_reference_path  # noqa: E402, F401
from pliant_reference import Asset  # noqa: E402
from tiny_asset import assemble, floats, tiles_of  # noqa: E402

COPIES = 45


def multiplied(asset, copies):
    n = asset.vertex_count
    shifts = np.array([[0.0, 2.0 * (i % 9), 2.0 * (i // 9)] for i in range(copies)])
    rest = (asset.rest[None] + shifts[:, None]).reshape(-1, 3)
    basis = np.tile(asset.basis, (1, copies, 1))
    triangles = np.concatenate([asset.triangles + i * n for i in range(copies)])
    groups = np.arange(copies * n)
    groups -= (groups // n % 2) * (groups % 2)
    new = {"REST": floats(tiles_of(rest)), "BASI": floats(tiles_of(basis)), "TRIS": triangles.astype("<u4").tobytes()}
    chunks = [(tag, asset.flags[tag], new.get(tag) or asset.bytes_of(tag)) for tag in asset.chunks if tag != "POLY"]
    chunks.insert(-1, ("SMTH", 0, groups.astype("<u4").tobytes()))
    counts = (copies * n, len(triangles), asset.dimension, asset.pose_count)
    return assemble(counts, asset.origin, chunks)


def main():
    source, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[3:]:
        shutil.copy(source / f"{name}.pliant", folder)
    blob = multiplied(Asset((source / "tube_neo.pliant").read_bytes()), COPIES)
    Asset(blob)
    (folder / "large.pliant").write_bytes(blob)
    return 0


if __name__ == "__main__":
    sys.exit(main())
