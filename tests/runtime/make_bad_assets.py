"""The museum: one file for each way to break each rule of formats/SPEC.md section 5.

    make_bad_assets.py GOOD.pliant LOADED.pliant SOLID.pliant QUARTIC.pliant COMPACT.pliant TIED.pliant RANGED.pliant
        FACTORED.pliant LAYERED.pliant FOLDER

GOOD: a shell with all optional chunks but LOAD, LOADED: one with a dead load, SOLID: with tetrahedra, QUARTIC: with QUAR,
COMPACT: with BASC and BNDS, TIED: with ties, RANGED: with MRNG, FACTORED: with BASF, LAYERED: layers with all their kinds of
elements.

Files are named RULE_what.CODE.pliant, CODE being the pliant_result that the C runtime must answer; the script itself checks
that the numpy reference refuses each one, naming the same rule. Every file has right checksums except those that are about
checksums: a hostile file would have them too.
"""
import struct
import sys
from pathlib import Path

import numpy as np

import pliant_reference_path  # noqa: F401
from asset_draft import ALIGNMENT, CHECKSUM, INDEX, LAYOUT, LIMIT, NOT_PLIANT, NUMBER, TRUNCATED, VERSION, Draft, editor
from bad_layers import (bad_answers_of_layers, bad_batches_of_layers, bad_changes, bad_ranges_of_layers, good_layers,
                        with_quartic)
from bad_shapes import bad_compacts, bad_factors
from pliant_reference import TIE, Asset, FormatError
from pliant_reference_solid import Layout


def bad_files(good):
    """(name, code, bytes)"""
    def draft():
        return Draft(good)

    def header(offset, form, *values):
        d = draft()
        struct.pack_into("<" + form, d.header, offset, *values)
        return d.join()

    def chunk(tag, offset, form, *values):
        d = draft()
        d.put(tag, offset, form, *values)
        return d.join()

    def table(tag, field, value):
        d = draft()
        d.join()
        d.entry(tag)[field] = value
        return d.join(lay_out=False)

    def resized(tag, change):
        d = draft()
        d.data[tag] = d.data[tag][:change] if change < 0 else d.data[tag] + bytes(change)
        return d.join()

    # One more batch, with the arrays of the first.
    def shared_batches():
        d = draft()
        data = d.data[b"ELEM"]
        count = struct.unpack_from("<I", data)[0]
        records = data[64:64 + 64 * count] + data[64:128]
        for at in range(16, len(records), 64):
            offsets = struct.unpack_from("<3Q", records, at)
            struct.pack_into("<3Q", records, at, *(offset + 64 for offset in offsets))
        d.data[b"ELEM"] = bytearray(struct.pack("<I", count + 1)) + data[4:64] + records + data[64 + 64 * count:]
        return d.join()

    n, t, dim, m = struct.unpack_from("<4I", good, 32)
    wide = (dim + 15) // 16 * 16
    nan, inf = float("nan"), float("inf")

    yield "R01_empty", TRUNCATED, b""
    yield "R01_half_a_header", TRUNCATED, good[:32]
    yield "R02_not_pliant", NOT_PLIANT, b"\x89PNG\r\n\x1a\n" + good[8:]
    yield "R02_text_mode", NOT_PLIANT, good[:8] + b"\n\x1a\n" + good[11:]
    yield "R03_next_major", VERSION, header(12, "H", 2)
    yield "R03_other_byte_order", VERSION, header(12, "H", 256)
    yield "R04_cut", TRUNCATED, good[:-1]
    yield "R04_longer", TRUNCATED, good + bytes(64)
    yield "R05_no_chunks", LIMIT, draft().join(count=0)
    yield "R05_many_chunks", LIMIT, draft().join(count=65)
    for name, offset, low, high in (("vertices", 32, 0, (1 << 26) + 1), ("triangles", 36, 0, (1 << 27) + 1),
                                    ("dimension", 40, 0, 257), ("poses", 44, 1, 65)):
        yield f"R05_few_{name}", LIMIT, header(offset, "I", low)
        yield f"R05_many_{name}", LIMIT, header(offset, "I", high)
    yield "R05_no_batches", LIMIT, chunk(b"ELEM", 0, "I", 0)
    yield "R05_many_batches", LIMIT, chunk(b"ELEM", 0, "I", 65)
    yield "R05_no_elements", LIMIT, chunk(b"ELEM", 64 + 4, "I", 0)
    yield "R05_many_elements", LIMIT, chunk(b"ELEM", 64 + 4, "I", (1 << 22) + 1)
    yield "R05_no_centres", LIMIT, chunk(b"PRED", 0, "I", 0)
    yield "R05_no_answers", LIMIT, chunk(b"ANSW", 0, "I", 0)
    yield "R06_misaligned", LAYOUT, table(b"TRIS", 2, draft().entry(b"TRIS")[2] + 4)
    yield "R06_basis_off_page", LAYOUT, table(b"BASI", 2, draft().entry(b"BASI")[2] + 64)
    yield "R06_overlap", LAYOUT, table(b"ELEM", 2, draft().entry(b"SOLV")[2])
    yield "R06_into_table", LAYOUT, table(b"SOLV", 2, 64)
    yield "R06_past_end", LAYOUT, table(b"BASI", 3, len(good))
    yield "R06_wraps_around", LAYOUT, table(b"BASI", 3, 0xFFFFFFFFFFFFF000)
    yield "R06_offset_wraps_around", LAYOUT, table(b"BASI", 2, 0xFFFFFFFFFFFFF000)
    d = draft()
    d.table[-1][0], d.data[b"CERT"] = b"CERT", d.data[b"CERT"]
    yield "R06_twice", LAYOUT, d.join()
    d = draft()
    d.table.insert(0, [b"NEWS", 1, 0, 0, 0, 0])
    d.data[b"NEWS"] = bytearray(64)
    yield "R07_unknown_required", VERSION, d.join()
    for tag in (b"SOLV", b"ELEM", b"REST", b"TRIS", b"NAME", b"ANSW", b"CERT", b"BASI"):
        d = draft()
        d.table = [entry for entry in d.table if entry[0] != tag]
        yield f"R07_without_{tag.decode()}", LAYOUT, d.join()
    yield "R08_header_checksum", CHECKSUM, good[:28] + bytes([good[28] ^ 1]) + good[29:]
    for tag in (b"SOLV", b"ELEM", b"PRED", b"REST", b"TRIS", b"ANSW", b"BASI"):
        yield f"R09_{tag.decode()}_short", LAYOUT, resized(tag, -4)
        if tag != b"ELEM":
            yield f"R09_{tag.decode()}_long", LAYOUT, resized(tag, 4)
    yield "R09_POLY_short", LAYOUT, resized(b"POLY", -4)
    yield "R09_kind_0", LAYOUT, chunk(b"ELEM", 64, "I", 0)
    yield "R09_kind_12", LAYOUT, chunk(b"ELEM", 64, "I", 12)
    yield "R09_rows_in_records", LAYOUT, chunk(b"ELEM", 64 + 16, "Q", 0)
    yield "R09_rows_misaligned", LAYOUT, chunk(b"ELEM", 64 + 16, "Q", 64 * 4 + 4)
    yield "R09_rows_shared", LAYOUT, shared_batches()
    yield "R09_numbers_past_end", LAYOUT, chunk(b"ELEM", 64 + 32, "Q", (len(draft().data[b"ELEM"]) + 63) // 64 * 64)
    yield "R09_numbers_wrap_around", LAYOUT, chunk(b"ELEM", 64 + 32, "Q", 0xFFFFFFFFFFFFFFC0)
    yield "R09_more_elements_than_bytes", LAYOUT, chunk(b"ELEM", 64 + 4, "I", 1 << 22)
    yield "R10_scale_nan", NUMBER, chunk(b"SOLV", 0, "f", nan)
    yield "R10_scale_zero", NUMBER, chunk(b"SOLV", 0, "f", 0.0)
    yield "R10_scale_negative", NUMBER, chunk(b"SOLV", 0, "f", -1.0)
    yield "R10_mean_inf", NUMBER, chunk(b"SOLV", 64, "f", inf)
    yield "R10_pose_nan", NUMBER, chunk(b"SOLV", 64 + 4 * wide * (1 + dim), "f", nan)
    for name, field in (("rows", 16), ("fixed", 24), ("numbers", 32)):
        at = struct.unpack_from("<Q", draft().data[b"ELEM"], 64 + field)[0]
        yield f"R10_{name}_nan", NUMBER, chunk(b"ELEM", at, "f", nan)
    yield "R10_centre_inf", NUMBER, chunk(b"PRED", 64, "f", inf)
    yield "R10_coefficient_nan", NUMBER, chunk(b"PRED", len(draft().data[b"PRED"]) - 4 * wide, "f", nan)
    yield "R10_origin_nan", NUMBER, header(48, "f", nan)
    yield "R11_triangle", INDEX, chunk(b"TRIS", 12 * t - 4, "I", n)
    yield "R11_polygon_index", INDEX, chunk(b"POLY", len(draft().data[b"POLY"]) - 4, "I", n)
    yield "R11_polygon_of_two", INDEX, chunk(b"POLY", 8, "I", 2)
    yield "R11_polygon_sum", INDEX, chunk(b"POLY", 8, "I", 5)
    yield "R11_one_name_less", INDEX, resized(b"NAME", -1)
    yield "R11_one_name_more", INDEX, resized(b"NAME", 1)
    d = draft()
    d.data[b"NAME"] = bytearray()
    yield "R11_no_names", INDEX, d.join()
    for tag in (b"SOLV", b"BASI"):
        offset = draft().entry(tag)[2] + 64
        yield f"R12_{tag.decode()}_checksum", CHECKSUM, good[:offset] + bytes([good[offset] ^ 1]) + good[offset + 1:]
    yield "R13_answer_nan", NUMBER, chunk(b"ANSW", 64, "f", nan)
    yield "R13_answer_negative", NUMBER, chunk(b"ANSW", 64, "2f", -0.5, 1.5)
    yield "R13_answer_sum", NUMBER, chunk(b"ANSW", 64, "2f", 0.5, 0.6)
    yield "R13_answer_q_inf", NUMBER, chunk(b"ANSW", 64 + 4 * m, "f", inf)
    yield "R14_header", LAYOUT, header(60, "I", 1)
    yield "R14_table", LAYOUT, table(b"TRIS", 5, 1)
    yield "R14_flag", LAYOUT, table(b"TRIS", 1, 3)
    for tag in (b"SOLV", b"ELEM", b"PRED", b"ANSW"):
        yield f"R14_{tag.decode()}", LAYOUT, chunk(tag, 60, "I", 1)
    yield "R14_batch", LAYOUT, chunk(b"ELEM", 64 + 63, "B", 1)
    yield "R14_valence", LAYOUT, chunk(b"ELEM", 64 + 8, "I", 3)
    yield "R14_closed", LAYOUT, chunk(b"ELEM", 64 + 12, "I", 1)
    padding = 64 + 4 * m * struct.unpack_from("<I", draft().data[b"PRED"])[0]
    if padding % 64:
        yield "R14_behind_centres", LAYOUT, chunk(b"PRED", padding, "B", 1)


def bad_loads(loaded):
    """(name, code, bytes): what can be wrong with LOAD."""
    edited, _ = editor(loaded, b"LOAD")
    def with_count(count):
        return edited(lambda d: d.put(b"LOAD", 0, "I", count))

    dim, m = struct.unpack_from("<2I", loaded, 40)
    wide = (dim + 15) // 16 * 16
    size = len(Draft(loaded).data[b"LOAD"])
    count = struct.unpack_from("<I", Draft(loaded).data[b"LOAD"])[0]
    if wide == dim:
        raise SystemExit("give a loaded file with padding")

    yield "R05_LOAD_no_centres", LIMIT, with_count(0)
    yield "R05_LOAD_many_centres", LIMIT, with_count(4097)
    yield "R05_LOAD_count_overflows", LIMIT, with_count(0xFFFFFFFF)
    yield "R05_LOAD_size_overflows", LIMIT, with_count((1 << 32) // (4 * wide) - m)
    yield "R09_LOAD_short", LAYOUT, edited(lambda d: d.data[b"LOAD"].__delitem__(slice(size - 4, size)))
    yield "R09_LOAD_long", LAYOUT, edited(lambda d: d.data[b"LOAD"].extend(bytes(4)))
    yield "R09_LOAD_head_cut", LAYOUT, edited(lambda d: d.data[b"LOAD"].__delitem__(slice(60, size)))
    yield "R09_LOAD_head_only", LAYOUT, edited(lambda d: d.data[b"LOAD"].__delitem__(slice(64, size)))
    yield "R10_LOAD_first_nan", NUMBER, edited(lambda d: d.put(b"LOAD", 64, "f", float("nan")))
    yield "R10_LOAD_last_inf", NUMBER, edited(lambda d: d.put(b"LOAD", size - 4 * (wide - dim + 1), "f", float("inf")))
    yield "R10_LOAD_padding_nan", NUMBER, edited(lambda d: d.put(b"LOAD", size - 4, "f", float("nan")))
    yield "R14_LOAD_head", LAYOUT, edited(lambda d: d.put(b"LOAD", 60, "I", 1))
    yield "R14_LOAD_padding", LAYOUT, edited(lambda d: d.put(b"LOAD", size - 4, "f", 1.0))
    yield "R14_LOAD_minus_zero", LAYOUT, edited(lambda d: d.put(b"LOAD", 64 + 4 * dim, "f", -0.0))
    yield "R15_one_centre_less", LAYOUT, with_count(count - 1)
    yield "R15_one_centre_more", LAYOUT, with_count(count + 1)
    yield "R15_all_centres", LAYOUT, with_count(4096)
    yield "R15_without_PRED", LAYOUT, edited(lambda d: d.table.remove(d.entry(b"PRED")))
    yield "R15_not_required", LAYOUT, edited(lambda d: d.entry(b"LOAD").__setitem__(1, 0))


def bad_solids(solid):
    """(name, code, bytes): what can be wrong with tetrahedra and with VERT."""
    def edited(tag, offset, form, *values):
        d = Draft(solid)
        d.put(tag, offset, form, *values)
        return d.join()

    n, t = struct.unpack_from("<2I", solid, 32)
    vertices, size = Draft(solid).data[b"VERT"], 64 + 4 * n
    boundary = struct.unpack_from("<I", vertices)[0]
    count, rows = struct.unpack_from("<4xI8xQ", Draft(solid).data[b"ELEM"], 64)
    lanes = (count + 15) // 16 * 16
    if boundary == n or count == lanes:
        raise SystemExit("give a solid with a vertex inside and padding")

    yield "R05_VERT_no_boundary", LIMIT, edited(b"VERT", 0, "I", 0)
    yield "R05_VERT_large_boundary", LIMIT, edited(b"VERT", 0, "I", n + 1)
    d = Draft(solid)
    d.data[b"VERT"] = vertices[:size - 4]
    yield "R09_VERT_short", LAYOUT, d.join()
    d.data[b"VERT"] = vertices + bytes(4)
    yield "R09_VERT_long", LAYOUT, d.join()
    d.data[b"VERT"] = vertices[:60]
    yield "R09_VERT_head_cut", LAYOUT, d.join()
    yield "R11_VERT_number", INDEX, edited(b"VERT", size - 4, "I", n)
    yield "R11_triangle_inside", INDEX, edited(b"TRIS", 12 * t - 4, "I", boundary)
    yield "R11_boundary_too_small", INDEX, edited(b"VERT", 0, "I", boundary - 1)
    d = Draft(solid)
    d.table.insert(-1, [b"POLY", 0, 0, 0, 0, 0])
    d.data[b"POLY"] = bytearray(struct.pack("<6I", 1, 3, 3, 0, 1, boundary))
    yield "R11_polygon_inside", INDEX, d.join()
    yield "R14_VERT_head", LAYOUT, edited(b"VERT", 60, "I", 1)
    yield "R14_tetrahedron_valence", LAYOUT, edited(b"ELEM", 64 + 8, "I", 3)
    for name, row, lane, value in (("one", 4, 0, 1 + 2.0 ** -23), ("zero", 5, 0, 1e-45), ("padding", 8, lanes - 1, 0.0)):
        yield f"R17_{name}", NUMBER, edited(b"ELEM", rows + 4 * (row * lanes + lane), "f", value)


def bad_ties(tied):
    """(name, code, bytes): what can be wrong with the last batch of elements, which are ties."""
    count = struct.unpack_from("<I", Draft(tied).data[b"ELEM"], 0)[0]
    record = 64 + 64 * (count - 1)
    kind, = struct.unpack_from("<I", Draft(tied).data[b"ELEM"], record)
    if kind != TIE:
        raise SystemExit("give an asset whose last batch are ties")
    poses, = struct.unpack_from("<Q", Draft(tied).data[b"ELEM"], record + 32)

    def edited(offset, form, *values):
        d = Draft(tied)
        d.put(b"ELEM", offset, form, *values)
        return d.join()

    def cut(floats):
        d = Draft(tied)
        del d.data[b"ELEM"][len(d.data[b"ELEM"]) - 4 * floats:]
        return d.join()

    yield "R05_no_ties", LIMIT, edited(record + 4, "I", 0)
    yield "R09_tie_rows_past_end", LAYOUT, edited(record + 16, "Q", poses)
    yield "R09_tie_numbers_cut", LAYOUT, cut(16)
    yield "R10_tie_stiffness_nan", NUMBER, edited(poses, "f", float("nan"))
    yield "R14_tie_valence", LAYOUT, edited(record + 8, "I", 3)
    yield "R14_tie_closed", LAYOUT, edited(record + 12, "I", 1)


def bad_quartics(quartic):
    """(name, code, bytes): what can be wrong with QUAR."""
    edited, put = editor(quartic, b"QUAR")
    dim, m = struct.unpack_from("<2I", quartic, 40)
    layout, size = Layout(dim), len(Draft(quartic).data[b"QUAR"])
    free = np.setdiff1d(np.arange(layout.count), layout.places)
    if layout.padded_count == layout.count or not len(free):
        raise SystemExit("give a quartic with padding")

    yield "R05_QUAR_none", LIMIT, put(0, "I", 0)
    d = Draft(quartic)
    struct.pack_into("<I", d.header, 40, 65)
    d.data[b"SOLV"] = bytearray(64 + 4 * 80 * (1 + 65 + m))
    d.put(b"SOLV", 0, "f", 1.0)
    yield "R05_QUAR_dimension", LIMIT, d.join()
    d = Draft(quartic)
    d.table.insert(2, [b"ELEM", 1, 0, 0, 0, 0])
    d.data[b"ELEM"] = bytearray(64)
    yield "R07_QUAR_and_ELEM", LAYOUT, d.join()
    yield "R07_without_QUAR", LAYOUT, edited(lambda d: d.table.remove(d.entry(b"QUAR")))
    yield "R09_QUAR_short", LAYOUT, edited(lambda d: d.data[b"QUAR"].__delitem__(slice(size - 4, size)))
    yield "R09_QUAR_long", LAYOUT, edited(lambda d: d.data[b"QUAR"].extend(bytes(4)))
    yield "R09_QUAR_head_cut", LAYOUT, edited(lambda d: d.data[b"QUAR"].__delitem__(slice(60, size)))
    yield "R09_QUAR_head_only", LAYOUT, edited(lambda d: d.data[b"QUAR"].__delitem__(slice(64, size)))
    yield "R10_QUAR_first_nan", NUMBER, put(64 + 4 * int(layout.places[1]), "f", float("nan"))
    yield "R10_QUAR_last_inf", NUMBER, put(size - 4 * (layout.padded_count - int(layout.places[-1])), "f", float("inf"))
    yield "R14_QUAR_head", LAYOUT, put(60, "I", 1)
    yield "R14_QUAR_constant", LAYOUT, put(64, "f", 1.0)
    yield "R14_QUAR_before_tail", LAYOUT, put(64 + 4 * int(free[-1]), "f", 1.0)
    yield "R14_QUAR_between_rows", LAYOUT, put(64 + 4 * int(free[0]), "f", 1.0)
    yield "R14_QUAR_minus_zero", LAYOUT, put(64 + 4 * int(free[0]), "f", -0.0)
    yield "R14_QUAR_last_padding", LAYOUT, put(size - 4, "f", 1.0)
    yield "R16_one_float_less", LAYOUT, put(0, "I", layout.count - 1)
    yield "R16_one_float_more", LAYOUT, put(0, "I", layout.count + 1)
    yield "R16_all_floats", LAYOUT, put(0, "I", 0xFFFFFFFF)
    yield "R16_not_required", LAYOUT, edited(lambda d: d.entry(b"QUAR").__setitem__(1, 0))


def with_smoothing(good):
    """A good file with a group for every pair of vertices."""
    d = Draft(good)
    groups = np.arange(struct.unpack_from("<I", good, 32)[0], dtype="<u4") // 2
    d.table.insert(-1, [b"SMTH", 0, 0, 0, 0, 0])
    d.data[b"SMTH"] = bytearray(groups.tobytes())
    struct.pack_into("<H", d.header, 14, 3)
    return d


def bad_smoothing(good):
    """(name, code, bytes): what can be wrong with SMTH."""
    n = struct.unpack_from("<I", good, 32)[0]
    for name, size in (("empty", 0), ("short", 4 * n - 4), ("long", 4 * n + 4)):
        d = with_smoothing(good)
        d.data[b"SMTH"] = (d.data[b"SMTH"] + bytes(4))[:size]
        yield f"R09_SMTH_{name}", LAYOUT, d.join()
    for name, value in (("number", n), ("huge", 0xFFFFFFFF)):
        d = with_smoothing(good)
        d.put(b"SMTH", 4 * n - 4, "I", value)
        yield f"R11_SMTH_{name}", INDEX, d.join()


def bad_ranges(ranged):
    """(name, code, bytes): what can be wrong with MRNG."""
    def put(offset, *values):
        d = Draft(ranged)
        d.put(b"MRNG", offset, f"{len(values)}f", *values)
        return d.join()

    dim = struct.unpack_from("<I", ranged, 40)[0]
    size = len(Draft(ranged).data[b"MRNG"])
    if size == 8 * dim:
        raise SystemExit("give ranges with padding")
    for name, change in (("short", -4), ("empty", -size), ("half", -size // 2), ("long", 4)):
        d = Draft(ranged)
        d.data[b"MRNG"] = d.data[b"MRNG"][:size + change] + bytes(max(change, 0))
        yield f"R09_MRNG_{name}", LAYOUT, d.join()
    yield "R10_MRNG_nan", NUMBER, put(0, float("nan"))
    yield "R10_MRNG_inf", NUMBER, put(size // 2 + 4 * (dim - 1), float("inf"))
    yield "R10_MRNG_padding_nan", NUMBER, put(size - 4, float("nan"))
    yield "R14_MRNG_padding", LAYOUT, put(size - 4, 1.0)
    yield "R14_MRNG_padding_of_lows", LAYOUT, put(4 * dim, -0.0)
    yield "R20_low_above_high", NUMBER, put(4, 2e30)
    high = struct.unpack_from("<f", Draft(ranged).data[b"MRNG"], size // 2)[0]
    yield "R20_a_little_above", NUMBER, put(0, np.nextafter(np.float32(high), np.float32(1e30)))
    yield "R20_width_overflows", NUMBER, width_overflow(ranged, size)


def width_overflow(ranged, size):
    d = Draft(ranged)
    d.put(b"MRNG", 0, "f", -3e38)
    d.put(b"MRNG", size // 2, "f", 3e38)
    return d.join()


def good_variants(good, loaded, solid, quartic, compact, tied, ranged, factored):
    """Files that differ in what a reader must tolerate."""
    yield "good_loaded", Draft(loaded).join()
    yield "good_solid", Draft(solid).join()
    yield "good_quartic", Draft(quartic).join()
    yield "good_smoothing", with_smoothing(good).join()
    yield "good_compact", Draft(compact).join()
    d = Draft(compact)
    d.table.remove(d.entry(b"BNDS"))
    yield "good_compact_without_bounds", d.join()
    yield "good_factored", Draft(factored).join()
    d = Draft(factored)
    d.table.remove(d.entry(b"BNDS"))
    yield "good_factored_without_bounds", d.join()
    d = Draft(good)
    d.table.insert(0, [b"BNDS", 0, 0, 0, 0, 0])
    dimension = struct.unpack_from("<I", good, 40)[0]
    d.data[b"BNDS"] = bytearray(struct.pack("<I60x", 1) + bytes(24 * (1 + dimension)))
    yield "good_bounds_beside_BASI", d.join()
    yield "good_tied", Draft(tied).join()
    yield "good_ranged", Draft(ranged).join()
    d = Draft(ranged)
    half = len(d.data[b"MRNG"]) // 2
    d.data[b"MRNG"][half:] = d.data[b"MRNG"][:half]
    yield "good_ranges_without_width", d.join()
    d = Draft(solid)
    d.table.remove(d.entry(b"VERT"))
    yield "good_solid_without_source", d.join()
    d = Draft(loaded)
    struct.pack_into("<H", d.header, 14, 0)
    yield "good_loaded_older_minor", d.join()
    d = Draft(loaded)
    d.table.insert(0, d.table.pop(d.table.index(d.entry(b"LOAD"))))
    yield "good_load_before_centres", d.join()
    d = Draft(loaded)
    d.table.remove(d.entry(b"LOAD"))
    yield "good_newer_minor_without_load", d.join()
    d = Draft(good)
    d.table.insert(0, [b"NEWS", 0, 0, 0, 0, 0])
    d.data[b"NEWS"] = bytearray(100)
    struct.pack_into("<H", d.header, 14, 7)
    yield "good_newer_minor_optional_chunk", d.join()
    d = Draft(good)
    d.table = [entry for entry in d.table if entry[0] not in (b"PRED", b"POLY")]
    yield "good_without_optional_chunks", d.join()
    yield "good", Draft(good).join()


def main():
    goods = [Path(path).read_bytes() for path in sys.argv[1:10]]
    good, loaded, solid, quartic, compact, tied, ranged, factored, layered = goods
    folder = Path(sys.argv[-1])
    folder.mkdir(parents=True, exist_ok=True)
    if any(Draft(blob).join() != blob for blob in goods):
        raise SystemExit("taking a good file apart and joining it changes it: give those of tiny_asset.py")
    rules, names = set(), []
    np.seterr(invalid="ignore", over="ignore")
    for name, code, blob in [*bad_files(good), *bad_loads(loaded), *bad_solids(solid), *bad_quartics(quartic),
                             *bad_smoothing(good), *bad_compacts(compact), *bad_ties(tied),
                             *bad_ranges(ranged), *bad_factors(factored), *bad_ranges_of_layers(layered),
                             *bad_batches_of_layers(layered, tied), *bad_changes(layered), *bad_answers_of_layers(layered),
                             ("R23_with_QUAR", LAYOUT, with_quartic(quartic))]:
        try:
            Asset(blob)
            raise SystemExit(f"{name}: the reference accepts it")
        except FormatError as error:
            if error.rule != name[:3]:
                raise SystemExit(f"{name}: the reference says {error}") from error
        rules.add(name[:3])
        names.append(f"{name}.{code}")
        (folder / f"{name}.{code}.pliant").write_bytes(blob)
    missing = {f"R{i:02}" for i in range(1, 25)} - rules
    if missing:
        raise SystemExit(f"no file breaks {missing}")
    for name, blob in [*good_variants(*goods[:8]), *good_layers(layered)]:
        Asset(blob)
        names.append(f"{name}.0")
        (folder / f"{name}.0.pliant").write_bytes(blob)
    (folder / "museum.txt").write_text("\n".join(names) + "\n")
    print(f"{len(names)} files, {len(rules)} rules")
    return 0


if __name__ == "__main__":
    sys.exit(main())
