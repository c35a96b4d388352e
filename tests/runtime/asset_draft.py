"""A good asset taken apart, to be spoilt; and the results that the C runtime answers."""
import struct
import zlib

# pliant_result
ALIGNMENT, TRUNCATED, NOT_PLIANT, VERSION, LIMIT, LAYOUT, NUMBER, INDEX, CHECKSUM = 12, 20, 21, 22, 23, 24, 25, 26, 27


class Draft:
    """A good file taken apart: edit it, then join()."""

    def __init__(self, blob):
        self.header = bytearray(blob[:64])
        count = struct.unpack_from("<I", blob, 24)[0]
        self.table = [list(struct.unpack_from("<4sIQQII", blob, 64 + 32 * i)) for i in range(count)]
        self.data = {entry[0]: bytearray(blob[entry[2]:entry[2] + entry[3]]) for entry in self.table}
        self.good = bytes(blob)

    def put(self, tag, offset, form, *values):
        struct.pack_into("<" + form, self.data[tag], offset, *values)

    def join(self, lay_out=True, checksums=True, count=None):
        """Bytes of the file. lay_out: place the chunks anew; else where the table says."""
        at = 64 + 32 * len(self.table)
        if lay_out:
            for entry in self.table:
                alignment = 4096 if entry[0] == b"BASI" else 64
                at += -at % alignment
                entry[2], entry[3] = at, len(self.data[entry[0]])
                at += entry[3]
        blob = bytearray(at if lay_out else len(self.good))
        for entry in self.table:
            data = self.data[entry[0]][:entry[3]]
            if entry[2] + len(data) <= len(blob):
                blob[entry[2]:entry[2] + len(data)] = data
            if checksums:
                entry[4] = zlib.crc32(bytes(data))
        struct.pack_into("<QI", self.header, 16, len(blob), len(self.table) if count is None else count)
        struct.pack_into("<I", self.header, 28, 0)
        head = bytes(self.header) + b"".join(struct.pack("<4sIQQII", *entry) for entry in self.table)
        blob[:len(head)] = head
        if checksums:
            struct.pack_into("<I", blob, 28, zlib.crc32(head))
        return bytes(blob)

    def entry(self, tag):
        return next(entry for entry in self.table if entry[0] == tag)


def editor(good, tag):
    """edited(function of a Draft) and put(offset, form, values..., [tag]): the files that a change makes of `good`."""
    def edited(edit):
        d = Draft(good)
        edit(d)
        return d.join()

    def put(offset, form, *values, tag=tag):
        return edited(lambda d: d.put(tag, offset, form, *values))

    return edited, put
