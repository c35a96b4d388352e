"""REST, BASI, BASC and BNDS of the second implementation (pliant_reference.py): what positions are rebuilt from."""
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
