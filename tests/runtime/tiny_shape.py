"""BASC, BASF and BNDS for tiny_asset.py, from SPEC.md section 4; the packing is simple and not the baker's."""
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


def right_factor(rows, scales):
    """Row scales and 16-bit numbers of `rows` [R, d], padded to a multiple of 8 rows."""
    rows = np.pad(rows, [(0, -len(rows) % 8), (0, 0)]) / scales
    units = (abs(rows).max(axis=1) / 32767).astype(np.float32)
    return units, np.round(rows / np.where(units > 0, units, 1)[:, None].astype(float)).astype("<i2")


def lanes_of_vertices(values):
    """[count, 3] as [parts, 48]: 16 times x, then y, then z."""
    padded = np.pad(values, [(0, -len(values) % 16), (0, 0)])
    return padded.reshape(-1, 16, 3).transpose(0, 2, 1).reshape(-1, 48)


def product_tile(rest, basis, scales, error):
    """Tile record without offset, its data without the vertices, and the magnitudes that each column adds up at most: `rest`
    [k, 3], `basis` [d, k, 3]."""
    count, d = len(rest), len(basis)
    origin = rest.min(axis=0).astype(np.float32)
    scale = np.float32(max(np.ptp(rest, axis=0).max() / 60000, 1e-6))
    numbers = np.clip(np.round((rest - origin) / float(scale)), 0, 65535)
    factor = np.kron(np.column_stack([np.ones(count), numbers]), np.eye(3))  # [3 k, 12]
    columns = basis.reshape(d, 3 * count).T
    affine = np.linalg.lstsq(factor, columns, rcond=1e-9)[0]
    left, singular, _ = np.linalg.svd(columns - factor @ affine, full_matrices=False)
    r = int((singular > error / 4).sum())
    left = left[:, :r]
    units = error / np.maximum(abs(left.T @ (columns - factor @ affine)).max(axis=1), error)
    fields = np.round(left / units).astype(int)
    rows = np.vstack([affine, (left * units).T @ (columns - factor @ affine)])
    row_scales, right = right_factor(rows, scales)
    terms = (abs(rows[:12]).reshape(4, 3, d) * np.array([1, 65535, 65535, 65535])[:, None, None]).sum(axis=0).max(axis=0)
    terms = terms + 3 * abs(fields).max(axis=0) @ abs(rows[12:])
    record = struct.pack("<HH3ff", count, r, *origin, scale)
    data = row_scales.tobytes() + right.T.tobytes()
    by_vertex = fields.reshape(count, 3, r)
    lows = by_vertex.min(axis=0)
    widths = [int((by_vertex[:, :, i] - lows[:, i]).max()).bit_length() for i in range(r)]
    widths = [width + 1 if width > 15 else width for width in widths]  # a base may lie below the lowest by up to 2^shift
    shifts = np.array([max(0, width - 15) for width in widths], int)
    bases = lows >> shifts
    data += b"".join(struct.pack("<3hH", *bases[:, i], widths[i]) for i in range(r))
    bases = bases << shifts
    data += lanes_of_vertices(numbers).astype("<u2").tobytes()
    parts = [lanes_of_vertices(by_vertex[:, :, i] - bases[:, i]) for i in range(r)]
    for part in range((count + 15) // 16):
        lanes, at = [0] * 48, 0
        for i, width in enumerate(widths):
            for lane, value in enumerate(parts[i][part]):
                lanes[lane] |= int(value) << at
            at += width
        data += part_bytes(lanes, (at + 3) // 4 * 4)
    return record, data, terms


def still_tile(rest):
    return struct.pack("<HH3ff", len(rest), 0, 0, 0, 0, 0), lanes_of_vertices(rest).astype("<f4").tobytes(), 0.0


def factored_chunk(rest, basis, error):
    """`rest` [n, 3] relative to the origin, `basis` [d, n, 3]. Blocks of 64 vertices, whose tiles take turns; in the last
    block one tile is still, whatever the basis says."""
    d, n, _ = basis.shape
    scales = np.float32(0.5) * np.float32(2.0) ** (np.arange(d, dtype=np.float32) % 3)
    blocks, records, data, reach = [0], b"", b"", np.zeros(d)
    for first in range(0, n, 64):
        size = min(64, n - first)
        for turn in range(3):
            vertices = np.arange(turn, size, 3)
            is_still = first + 64 >= n and turn == 1
            x, u = rest[first + vertices], basis[:, first + vertices]
            record, tile, terms = still_tile(x) if is_still else product_tile(x, u, scales.astype(float), error)
            reach = np.maximum(reach, np.maximum(np.linalg.norm(u, axis=2).max(axis=1) + error, terms / 8))
            records += struct.pack("<I", len(data) // 4) + record
            data += np.pad(vertices, (0, -len(vertices) % 16)).astype("<u2").tobytes() + tile
        blocks.append(blocks[-1] + 3)
    columns = b"".join(struct.pack("<fIff", scales[j], 0, np.nextafter(np.float32(reach[j]), np.float32(np.inf)), 2.0)
                       for j in range(d))
    head = struct.pack("<IfI52x", blocks[-1], error, 64) + columns + bytes(-len(columns) % 64)
    head += np.array(blocks, "<u4").tobytes()
    head += bytes(-len(head) % 64) + records
    return head + bytes(-len(head) % 64) + data


def unpacked_factors(chunk, dimension, vertex_count):
    """Rest positions and basis, as a reader makes them of it."""
    from pliant_reference_shape import Factored

    def require(condition, rule, text):
        if not condition:
            raise AssertionError(f"{rule}: {text}")

    found = Factored(chunk, 1, dimension, vertex_count, require)
    return found.rest, found.basis


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
