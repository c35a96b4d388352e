"""BASC and BNDS for tiny_asset.py, from SPEC.md section 4; the packing is simple and not the baker's."""
import struct

import numpy as np


def part_bytes(lanes, bits):
    """`lanes`: 48 integers of `bits` bits, a multiple of 4."""
    data = b""
    while bits >= 32:
        data += struct.pack("<48I", *(lane & 0xFFFFFFFF for lane in lanes))
        lanes, bits = [lane >> 32 for lane in lanes], bits - 32
    if bits & 16:
        data += struct.pack("<48H", *(lane & 0xFFFF for lane in lanes))
        lanes = [lane >> 16 for lane in lanes]
    if bits & 8:
        data += struct.pack("<48B", *(lane & 0xFF for lane in lanes))
        lanes = [lane >> 8 for lane in lanes]
    if bits & 4:
        data += bytes(lanes[i] | lanes[i + 24] << 4 for i in range(24))
    return data


def compact_chunk(basis, error):
    """`basis` [d, n, 3]: numbers to within `error`, in units that differ from column to column and from tile to tile."""
    d, n, _ = basis.shape
    scales = np.float32(error) * np.float32(2.0) ** -(np.arange(d, dtype=np.float32) % 3)
    tiles = (n + 63) // 64
    factors = [np.float32(1.0 - 0.25 * (t % 3)) for t in range(tiles)]
    numbers = [np.round(basis[:, 64 * t:64 * t + 64] / (factors[t] * scales)[:, None, None].astype(float)).astype(int)
               for t in range(tiles)]
    lows = np.array([tile.min(axis=1) for tile in numbers])  # [tiles, d, 3]
    shifts = [next(s for s in range(16) if (abs(lows[:, j] >> s) < 32768).all()) for j in range(d)]
    records, fields, data = b"", b"", b""
    reach = np.zeros(d)
    for t, tile in enumerate(numbers):
        packed = tile * (factors[t] * scales)[:, None, None].astype(float)
        reach = np.maximum(reach, np.linalg.norm(packed, axis=2).max(axis=1))
        bases = lows[t] >> np.array(shifts)[:, None]
        rest = tile - (bases << np.array(shifts)[:, None])[:, None]
        widths = [int(rest[j].max()).bit_length() for j in range(d)]
        records += struct.pack("<If", len(data) // 4, factors[t])
        fields += b"".join(struct.pack("<3hH", *bases[j], widths[j]) for j in range(d))
        for first in range(0, tile.shape[1], 16):
            lanes, at = [0] * 48, 0
            for j, width in enumerate(widths):
                for lane, value in enumerate(rest[j, first:first + 16].ravel()):
                    lanes[lane] |= int(value) << at
                at += width
            data += part_bytes(lanes, (at + 3) // 4 * 4)
    columns = b"".join(struct.pack("<fIff", scales[j], shifts[j], np.nextafter(np.float32(reach[j]), np.float32(np.inf)),
                                   2.0)
                       for j in range(d))
    head = struct.pack("<If56x", tiles, error) + columns + bytes(-len(columns) % 64) + records + fields
    return head + bytes(-len(head) % 64) + data


def unpacked(chunk, dimension, vertex_count):
    """What a reader makes of it."""
    from pliant_reference_shape import Compact

    def require(condition, rule, text):
        if not condition:
            raise AssertionError(f"{rule}: {text}")

    return Compact(chunk, 1, dimension, vertex_count, require).basis


def bounds_chunk(rest, basis, clusters):
    """`rest` [n, 3] with the origin, `basis` [d, n, 3], as a reader has them; clusters of neighbouring numbers."""
    data = struct.pack("<I60x", clusters)
    for vertices in np.array_split(np.arange(len(rest)), clusters):
        for values in [rest, *basis]:
            low, high = values[vertices].min(axis=0), values[vertices].max(axis=0)
            centre = ((low + high) / 2).astype(np.float32)
            radius = np.maximum(high - centre, centre - low).astype(np.float32)
            data += np.concatenate([centre, np.nextafter(radius, np.float32(np.inf))]).astype("<f4").tobytes()
    return data
