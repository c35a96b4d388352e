"""For make_bad_assets.py: what can be wrong with BASC, BASF and BNDS."""
import struct

from asset_draft import INDEX, LAYOUT, LIMIT, NUMBER, Draft, editor


def bad_compacts(compact):
    """(name, code, bytes): what can be wrong with BASC and BNDS."""
    edited, put = editor(compact, b"BASC")
    n, dim = struct.unpack_from("<I4xI", compact, 32)
    chunk, bounds = Draft(compact).data[b"BASC"], Draft(compact).data[b"BNDS"]
    tiles = (n + 63) // 64
    tiles_at = 64 + (16 * dim + 63) // 64 * 64
    fields_at = tiles_at + 8 * tiles
    fields_end = fields_at + 8 * tiles * dim
    data_at = (fields_end + 63) // 64 * 64
    offset, width = struct.unpack_from("<I", chunk, tiles_at + 8)[0], struct.unpack_from("<H", chunk, fields_at + 6)[0]
    if tiles != 2 or fields_end == data_at or dim % 4 == 0:
        raise SystemExit("give a compact file with two tiles and padding")

    yield "R05_BNDS_none", LIMIT, put(0, "I", 0, tag=b"BNDS")
    yield "R05_BNDS_many", LIMIT, put(0, "I", 257, tag=b"BNDS")
    yield "R07_without_BASC", LAYOUT, edited(lambda d: d.table.remove(d.entry(b"BASC")))
    d = Draft(compact)
    d.table.append([b"BASI", 1, 0, 0, 0, 0])
    d.data[b"BASI"] = bytearray(192 * dim * ((n + 15) // 16))
    yield "R07_BASC_and_BASI", LAYOUT, d.join()
    yield "R09_BNDS_short", LAYOUT, edited(lambda d: d.data[b"BNDS"].__delitem__(slice(len(bounds) - 4, None)))
    yield "R09_BNDS_long", LAYOUT, edited(lambda d: d.data[b"BNDS"].extend(bytes(4)))
    yield "R09_BNDS_head_cut", LAYOUT, edited(lambda d: d.data[b"BNDS"].__delitem__(slice(60, None)))
    yield "R14_BNDS_head", LAYOUT, put(60, "I", 1, tag=b"BNDS")
    yield "R14_BASC_head", LAYOUT, put(60, "I", 1)
    yield "R14_BASC_behind_columns", LAYOUT, put(tiles_at - 1, "B", 1)
    yield "R14_BASC_behind_fields", LAYOUT, put(data_at - 1, "B", 1)
    yield "R18_not_required", LAYOUT, edited(lambda d: d.entry(b"BASC").__setitem__(1, 0))
    yield "R18_tile_less", LAYOUT, put(0, "I", tiles - 1)
    yield "R18_tile_more", LAYOUT, put(0, "I", tiles + 1)
    yield "R18_all_tiles", LAYOUT, put(0, "I", 0xFFFFFFFF)
    yield "R18_shift", LAYOUT, put(64 + 4, "I", 16)
    yield "R18_shift_of_all_bits", LAYOUT, put(64 + 4, "I", 0xFFFFFFFF)
    yield "R18_width", LAYOUT, put(fields_at + 6, "H", 25)
    yield "R18_width_of_all_bits", LAYOUT, put(fields_at + 6, "H", 0xFFFF)
    for name, tile in (("first", 0), ("last", tiles - 1)):
        d = Draft(compact)
        for j in range(dim):
            d.put(b"BASC", fields_at + 8 * (dim * tile + j) + 6, "H", 24)
        yield f"R18_{name}_wider", LAYOUT, d.join()
    yield "R18_narrower", LAYOUT, put(fields_at + 6, "H", width - 4)
    yield "R18_first_offset", LAYOUT, put(tiles_at, "I", 1)
    yield "R18_offset", LAYOUT, put(tiles_at + 8, "I", offset + 6)
    yield "R18_offset_past_end", LAYOUT, put(tiles_at + 8, "I", 0xFFFFFFFF)
    yield "R18_short", LAYOUT, edited(lambda d: d.data[b"BASC"].__delitem__(slice(len(chunk) - 4, None)))
    yield "R18_long", LAYOUT, edited(lambda d: d.data[b"BASC"].extend(bytes(4)))
    for name, end in (("head_cut", 60), ("head_only", 64), ("without_tiles", tiles_at), ("without_fields", fields_at),
                      ("without_data", data_at)):
        yield f"R18_{name}", LAYOUT, edited(lambda d, end=end: d.data[b"BASC"].__delitem__(slice(end, None)))
    for name, at in (("error", 4), ("scale", 64), ("reach", 72), ("limit", 76), ("factor", tiles_at + 4)):
        yield f"R19_{name}_nan", NUMBER, put(at, "f", float("nan"))
        yield f"R19_{name}_inf", NUMBER, put(at, "f", float("inf"))
        yield f"R19_{name}_negative", NUMBER, put(at, "f", -1.0)
    yield "R19_centre_nan", NUMBER, put(64, "f", float("nan"), tag=b"BNDS")
    yield "R19_last_radius_inf", NUMBER, put(len(bounds) - 4, "f", float("inf"), tag=b"BNDS")
    yield "R19_radius_negative", NUMBER, put(64 + 12, "f", -1e-30, tag=b"BNDS")


def bad_factors(factored):
    """(name, code, bytes): what can be wrong with BASF."""
    edited, put = editor(factored, b"BASF")
    n, dim = struct.unpack_from("<I4xI", factored, 32)
    chunk = Draft(factored).data[b"BASF"]
    tiles, block = struct.unpack_from("<I4xI", chunk)
    blocks = (n + block - 1) // block
    blocks_at = 64 + (16 * dim + 63) // 64 * 64
    tiles_at = (blocks_at + 4 * (blocks + 1) + 63) // 64 * 64
    data_at = (tiles_at + 24 * tiles + 63) // 64 * 64
    heads = [struct.unpack_from("<IHH3ff", chunk, tiles_at + 24 * t) for t in range(tiles)]
    still = next(t for t in range(tiles) if heads[t][-1] == 0)
    parts = (heads[0][1] + 15) // 16
    rows = (12 + heads[0][2] + 7) // 8 * 8
    scales_at = data_at + 32 * parts
    fields_at = scales_at + 4 * rows + 2 * rows * dim
    vertices_at = data_at + 4 * heads[1][0]
    if blocks < 3 or heads[0][2] < 2 or heads[0][1] % 16 == 0 or tiles_at + 24 * tiles == data_at or dim % 4:
        raise SystemExit("give a factored file with blocks, columns, padding and a still tile")

    def tile(t, offset, form, value):
        return put(tiles_at + 24 * t + offset, form, value)

    yield "R07_without_BASF", LAYOUT, edited(lambda d: d.table.remove(d.entry(b"BASF")))
    for tag, size in ((b"BASI", 192 * dim * ((n + 15) // 16)), (b"REST", 192 * ((n + 15) // 16))):
        d = Draft(factored)
        d.table.append([tag, 1, 0, 0, 0, 0])
        d.data[tag] = bytearray(size)
        yield f"R07_BASF_and_{tag.decode()}", LAYOUT, d.join()
    for name, at in (("head", 60), ("column", 64 + 4), ("behind_blocks", blocks_at + 4 * (blocks + 1)),
                     ("behind_tiles", data_at - 4), ("behind_vertices", scales_at - 4)):
        yield f"R14_BASF_{name}", LAYOUT, put(at, "I", 1)
    for name, at in (("error", 4), ("scale", 64), ("reach", 72), ("limit", 76), ("rest_scale", tiles_at + 20)):
        yield f"R19_BASF_{name}_nan", NUMBER, put(at, "f", float("nan"))
        yield f"R19_BASF_{name}_inf", NUMBER, put(at, "f", float("inf"))
        yield f"R19_BASF_{name}_negative", NUMBER, put(at, "f", -1.0)
    yield "R19_BASF_origin_nan", NUMBER, tile(0, 8, "f", float("nan"))
    yield "R19_BASF_row_scale_inf", NUMBER, put(scales_at, "f", float("inf"))
    yield "R19_BASF_last_row_scale_nan", NUMBER, put(scales_at + 4 * rows - 4, "f", float("nan"))
    yield "R21_not_required", LAYOUT, edited(lambda d: d.entry(b"BASF").__setitem__(1, 0))
    for name, value in (("none", 0), ("odd", 65), ("huge", 65600), ("of_all_bits", 0xFFFFFFC0)):
        yield f"R21_block_{name}", LAYOUT, put(8, "I", value)
    for name, value in (("less", tiles - 1), ("more", tiles + 1), ("many", n + 1), ("of_all_bits", 0xFFFFFFFF)):
        yield f"R21_tiles_{name}", LAYOUT, put(0, "I", value)
    for name, at, value in (("first", 0, 1), ("falling", 4, blocks + 100), ("of_all_bits", 4, 0xFFFFFFFF),
                            ("last", 4 * blocks, tiles - 1)):
        yield f"R21_block_start_{name}", LAYOUT, put(blocks_at + at, "I", value)
    for name, offset, form, value in (("offset", 0, "I", heads[1][0] + 1), ("offset_of_all_bits", 0, "I", 0xFFFFFFFF),
                                      ("no_vertices", 4, "H", 0), ("many_vertices", 4, "H", 65),
                                      ("columns", 6, "H", 193)):
        yield f"R21_{name}", LAYOUT, tile(1, offset, form, value)
    yield "R21_first_offset", LAYOUT, tile(0, 0, "I", 1)
    yield "R21_still_with_columns", LAYOUT, tile(still, 6, "H", 1)
    yield "R21_not_still", LAYOUT, tile(still, 20, "f", 1.0)
    yield "R21_not_still_by_a_denormal", LAYOUT, tile(still, 20, "f", 1e-40)
    yield "R21_still", LAYOUT, put(tiles_at + 6, "Hffff", 0, 0, 0, 0, 0)
    yield "R21_width", LAYOUT, put(fields_at + 6, "H", 25)
    yield "R21_width_of_all_bits", LAYOUT, put(fields_at + 6, "H", 0xFFFF)
    yield "R21_wider", LAYOUT, put(fields_at + 6, "H", 24)
    yield "R21_short", LAYOUT, edited(lambda d: d.data[b"BASF"].__delitem__(slice(len(chunk) - 4, None)))
    yield "R21_long", LAYOUT, edited(lambda d: d.data[b"BASF"].extend(bytes(4)))
    yield "R21_odd_end", LAYOUT, edited(lambda d: d.data[b"BASF"].extend(bytes(2)))
    for name, end in (("head_cut", 60), ("head_only", 64), ("without_blocks", blocks_at), ("without_tiles", tiles_at),
                      ("without_data", data_at), ("cut_in_scales", scales_at + 4), ("cut_in_fields", fields_at + 4)):
        yield f"R21_{name}", LAYOUT, edited(lambda d, end=end: d.data[b"BASF"].__delitem__(slice(end, None)))
    yield "R22_vertex_twice_in_a_tile", INDEX, put(data_at + 2, "H", 0)
    yield "R22_vertices_fall", INDEX, put(data_at, "HH", 3, 0)
    yield "R22_vertex_of_another_tile", INDEX, put(vertices_at, "H", 0)
    yield "R22_vertex_outside", INDEX, put(data_at + 2 * heads[0][1] - 2, "H", 64)
    yield "R22_vertex_of_all_bits", INDEX, put(data_at + 2 * heads[0][1] - 2, "H", 0xFFFF)
