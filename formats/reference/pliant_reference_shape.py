"""REST, BASI, BASC, BASF and BNDS of the second implementation (pliant_reference.py): what positions are rebuilt from."""
import struct

import numpy as np

MAX_WIDTH, MAX_SHIFT, MAX_CLUSTERS, PARTS = 24, 15, 256, 4


def pad64(size):
    return (size + 63) // 64 * 64


def lanes_of(bits, data):
    """[48] integers of `bits` bits: one part (SPEC.md, BASC). Python's integers have no width to run out of."""
    words, at = bits // 32, 0
    lanes = [0] * 48
    for word in range(words):
        for lane, value in enumerate(struct.unpack_from("<48I", data, 192 * word)):
            lanes[lane] |= value << (32 * word)
    position, at = 32 * words, 192 * words
    for width, form in ((16, "<48H"), (8, "<48B")):
        if bits & width:
            for lane, value in enumerate(struct.unpack_from(form, data, at)):
                lanes[lane] |= value << position
            position, at = position + width, at + 6 * width
    if bits & 4:
        for i, value in enumerate(struct.unpack_from("<24B", data, at)):
            lanes[i] |= (value & 15) << position
            lanes[i + 24] |= (value >> 4) << position
    return lanes


def finite_size(values):
    return np.isfinite(values).all() and (np.asarray(values) >= 0).all()


class Compact:
    """BASC: .basis is [d, n, 3]."""

    def __init__(self, data, flags, dimension, vertex_count, require):
        d, n, tiles = dimension, vertex_count, (vertex_count + 63) // 64
        require(flags & 1, "R18", "BASC without the required flag")
        require(len(data) >= 64, "R18", "BASC is shorter than its head")
        count, self.position_error = struct.unpack_from("<If", data)
        require(count == tiles, "R18", f"BASC counts {count} tiles, there are {tiles}")
        require(not any(data[8:64]), "R14", "reserved bytes of BASC")
        tiles_at = 64 + pad64(16 * d)
        fields_at = tiles_at + 8 * tiles
        data_at = pad64(fields_at + 8 * d * tiles)
        require(len(data) >= data_at, "R18", "BASC ends before its data")
        columns = np.frombuffer(data, [("scale", "<f4"), ("shift", "<u4"), ("reach", "<f4"), ("limit", "<f4")], d, 64)
        records = np.frombuffer(data, [("offset", "<u4"), ("factor", "<f4")], tiles, tiles_at)
        fields = np.frombuffer(data, [("base", "<i2", 3), ("width", "<u2")], d * tiles, fields_at).reshape(tiles, d)
        require(not any(data[64 + 16 * d:tiles_at]), "R14", "bytes behind the columns of BASC")
        require(not any(data[fields_at + 8 * d * tiles:data_at]), "R14", "bytes behind the fields of BASC")
        require((columns["shift"] <= MAX_SHIFT).all(), "R18", "a shift of BASC")
        require((fields["width"] <= MAX_WIDTH).all(), "R18", "a width of BASC")
        for numbers in (self.position_error, columns["scale"], columns["reach"], columns["limit"], records["factor"]):
            require(finite_size(numbers), "R19", "a number of BASC is not finite or negative")
        self.columns, self.widths = columns, fields["width"]
        self.read_tiles(data[data_at:], records, fields, (n + 15) // 16, require)
        self.basis = self.basis[:, :n]

    def read_tiles(self, data, records, fields, parts_left, require):
        d, at = len(self.columns), 0
        self.basis = np.zeros((d, 16 * parts_left, 3))
        for t, (offset, factor) in enumerate(records):
            bits = int(fields[t]["width"].astype(int).sum())
            size, parts = (bits + 3) // 4 * 24, min(PARTS, parts_left - PARTS * t)
            require(4 * int(offset) == at, "R18", f"offset of tile {t} of BASC")
            require(at + parts * size <= len(data), "R18", "BASC ends inside a tile")
            for part in range(parts):
                self.read_part(lanes_of((bits + 3) // 4 * 4, data[at:at + size]), float(factor), fields[t],
                               16 * (PARTS * t + part))
                at += size
        require(at == len(data), "R18", "BASC goes on behind its last tile")

    def read_part(self, lanes, factor, fields, first):
        for j, (column, field) in enumerate(zip(self.columns, fields)):
            width = int(field["width"])
            numbers = np.array([lane & ((1 << width) - 1) for lane in lanes], float).reshape(16, 3)
            lanes = [lane >> width for lane in lanes]
            base = field["base"].astype(float) * 2.0 ** int(column["shift"])
            self.basis[j, first:first + 16] = factor * float(column["scale"]) * (base + numbers)


class Factored:
    """BASF: .rest is [n, 3] without the origin, .basis [d, n, 3]."""

    def __init__(self, data, flags, dimension, vertex_count, require):
        d, n = dimension, vertex_count
        require(flags & 1, "R21", "BASF without the required flag")
        require(len(data) >= 64, "R21", "BASF is shorter than its head")
        count, self.position_error, block = struct.unpack_from("<IfI", data)
        require(not any(data[12:64]), "R14", "reserved bytes of BASF")
        require(block % 64 == 0 and 64 <= block <= 65536, "R21", f"blocks of {block} vertices")
        require(count <= n, "R21", f"BASF counts {count} tiles of {n} vertices")
        blocks_at = 64 + pad64(16 * d)
        tiles_at = pad64(blocks_at + 4 * ((n + block - 1) // block + 1))
        data_at = pad64(tiles_at + 24 * count)
        require(len(data) >= data_at and len(data) % 4 == 0, "R21", "BASF ends before its data")
        self.columns = np.frombuffer(data, [("scale", "<f4"), ("zero", "<u4"), ("reach", "<f4"), ("limit", "<f4")], d, 64)
        blocks = np.frombuffer(data, "<u4", (n + block - 1) // block + 1, blocks_at).astype(int)
        tiles = np.frombuffer(data, [("offset", "<u4"), ("vertices", "<u2"), ("columns", "<u2"), ("origin", "<f4", 3),
                                     ("scale", "<f4")], count, tiles_at)
        require(not (any(data[64 + 16 * d:blocks_at]) or any(data[blocks_at + 4 * len(blocks):tiles_at])
                     or any(data[tiles_at + 24 * count:data_at])), "R14", "padding of BASF")
        require((self.columns["zero"] == 0).all(), "R14", "the second word of a column of BASF")
        for numbers in (self.position_error, self.columns["scale"], self.columns["reach"], self.columns["limit"],
                        tiles["scale"]):
            require(finite_size(numbers), "R19", "a number of BASF is not finite or negative")
        require(np.isfinite(tiles["origin"]).all(), "R19", "a rest_origin of BASF")
        require(blocks[0] == 0 and blocks[-1] == count and (np.diff(blocks) >= 0).all(), "R21", "blocks of BASF")
        require((tiles["vertices"] >= 1).all() and (tiles["vertices"] <= 64).all(), "R21", "vertices of a tile")
        require((tiles["columns"] <= min(192, d)).all() and not tiles["columns"][tiles["scale"] == 0].any(), "R21",
                "columns of a tile")
        self.rest, self.basis = np.zeros((n, 3)), np.zeros((d, n, 3))
        at, self.data, self.require = 0, data[data_at:], require
        for b in range(len(blocks) - 1):
            seen = []
            for tile in tiles[blocks[b]:blocks[b + 1]]:
                require(4 * int(tile["offset"]) == at, "R21", "offset of a tile of BASF")
                at, vertices = self.read_tile(tile, at, b * block, min(block, n - b * block))
                seen.extend(vertices)
            require(sorted(seen) == list(range(b * block, min(n, (b + 1) * block))), "R22", f"vertices of block {b}")
        require(at == len(self.data), "R21", "BASF goes on behind its last tile")

    def take(self, form, count, at):
        size = count * np.dtype(form).itemsize
        self.require(at + size <= len(self.data), "R21", "BASF ends inside a tile")
        return np.frombuffer(self.data, form, count, at), at + size

    def read_tile(self, tile, at, first, size):
        """Where it ends, and its vertices."""
        count, r, d = int(tile["vertices"]), int(tile["columns"]), len(self.columns)
        parts = (count + 15) // 16
        numbers, at = self.take("<u2", 16 * parts, at)
        self.require(not numbers[count:].any(), "R14", "vertices behind the last one of a tile")
        self.require((np.diff(numbers[:count].astype(int)) > 0).all() and numbers[:count].max() < size, "R22",
                     "vertices of a tile")
        vertices = first + numbers[:count].astype(int)
        per_vertex = lambda lanes: lanes.reshape(parts, 3, 16).transpose(0, 2, 1).reshape(-1, 3)[:count].astype(float)
        if tile["scale"] == 0:
            rest, at = self.take("<f4", 48 * parts, at)
            self.rest[vertices] = per_vertex(rest)
            return at, vertices
        rows = (12 + r + 7) // 8 * 8
        scales, at = self.take("<f4", rows, at)
        self.require(np.isfinite(scales).all(), "R19", "a row_scale of BASF")
        right, at = self.take("<i2", d * rows, at)
        factor = right.reshape(d, rows).T * scales[:, None].astype(float) * self.columns["scale"].astype(float)  # [rows, d]
        fields, at = self.take(np.dtype([("base", "<i2", 3), ("width", "<u2")]), r, at)
        self.require((fields["width"] <= MAX_WIDTH).all(), "R21", "a width of BASF")
        rest, at = self.take("<u2", 48 * parts, at)
        k = per_vertex(rest)
        self.rest[vertices] = tile["origin"].astype(float) + float(tile["scale"]) * k
        left = np.zeros((r, 16 * parts, 3))
        bits = (int(fields["width"].astype(int).sum()) + 3) // 4 * 4
        for part in range(parts):
            packed, at = self.take("<u1", 6 * bits, at)
            lanes = lanes_of(bits, packed.tobytes())
            for i, field in enumerate(fields):
                values = np.array([lane & ((1 << int(field["width"])) - 1) for lane in lanes], float).reshape(3, 16).T
                lanes = [lane >> int(field["width"]) for lane in lanes]
                bases = field["base"] * 2.0 ** max(0, int(field["width"]) - 15)
                left[i, 16 * part:16 * part + 16] = bases + values
        affine = factor[:12].reshape(4, 3, d)  # [constant and the three coordinates, c, d]
        basis = affine[0][None] + np.einsum("va,acd->vcd", k, affine[1:])
        basis = basis + np.einsum("ivc,id->vcd", left[:, :count], factor[12:12 + r])
        self.basis[:, vertices] = basis.transpose(2, 0, 1)
        return at, vertices


class Clusters:
    """BNDS: centres and radii [clusters, 1 + d, 3]."""

    def __init__(self, data, count, dimension, require):
        require(len(data) == 64 + 24 * count * (1 + dimension), "R09", "size of BNDS")
        table = np.frombuffer(data, "<f4", offset=64).reshape(count, 1 + dimension, 2, 3).astype(float)
        require(np.isfinite(table).all() and (table[:, :, 1] >= 0).all(), "R19", "BNDS")
        self.centres, self.radii = table[:, :, 0], table[:, :, 1]

    def box(self, q):
        """Lowest and highest corner."""
        row = np.concatenate([[1.0], q])
        centre, radius = np.tensordot(row, self.centres, (0, 1)), np.tensordot(abs(row), self.radii, (0, 1))
        return (centre - radius).min(axis=0), (centre + radius).max(axis=0)
