"""The museum's files of layers: LAYR, the kinds of elements beside it, and how layers change the numbers of elements."""
import struct

from asset_draft import INDEX, LAYOUT, LIMIT, NUMBER, Draft, editor
from pliant_reference import LAYERED_ARAP, LAYERED_HINGE, LAYERED_NEO_HOOKEAN, TIE, shape_of

NAN, INF = float("nan"), float("inf")


def bad_ranges_of_layers(layered):
    """(name, code, bytes): what can be wrong with LAYR. Two layers or more."""
    edited, put = editor(layered, b"LAYR")
    size = len(Draft(layered).data[b"LAYR"])
    count = (size - 64) // 16
    last = size - 16

    yield "R05_LAYR_none", LIMIT, put(0, "I", 0)
    yield "R05_LAYR_many", LIMIT, put(0, "I", 65)
    yield "R05_LAYR_count_overflows", LIMIT, put(0, "I", 0xFFFFFFFF)

    def with_poses(poses, keep):
        d = Draft(layered)
        struct.pack_into("<I", d.header, 44, poses)
        if not keep:
            d.table.remove(d.entry(b"LAYR"))
        return d.join()

    yield "R05_layers_66_poses", LIMIT, with_poses(66, True)
    yield "R05_65_poses_without_layers", LIMIT, with_poses(65, False)
    yield "R09_LAYR_short", LAYOUT, edited(lambda d: d.data[b"LAYR"].__delitem__(slice(size - 4, size)))
    yield "R09_LAYR_long", LAYOUT, edited(lambda d: d.data[b"LAYR"].extend(bytes(4)))
    yield "R09_LAYR_head_cut", LAYOUT, edited(lambda d: d.data[b"LAYR"].__delitem__(slice(60, size)))
    yield "R09_LAYR_head_only", LAYOUT, edited(lambda d: d.data[b"LAYR"].__delitem__(slice(64, size)))
    for name, place, value in (("low_nan", 0, NAN), ("low_inf", 0, -INF), ("high_nan", 4, NAN), ("high_inf", 4, INF),
                               ("initial_nan", 8, NAN), ("initial_inf", 8, INF)):
        yield f"R10_LAYR_{name}", NUMBER, put(last + place, "f", value)
    yield "R14_LAYR_head", LAYOUT, put(60, "I", 1)
    yield "R14_LAYR_first_layer", LAYOUT, put(64 + 12, "I", 1)
    yield "R14_LAYR_last_layer", LAYOUT, put(size - 4, "f", -0.0)
    yield "R23_not_required", LAYOUT, edited(lambda d: d.entry(b"LAYR").__setitem__(1, 0))
    yield "R23_one_layer_less", LAYOUT, put(0, "I", count - 1)
    yield "R23_one_layer_more", LAYOUT, put(0, "I", count + 1)
    yield "R23_64_layers", LAYOUT, put(0, "I", 64)
    for name, layers in (("removed", count - 1), ("added", count + 1)):
        d = Draft(layered)
        d.data[b"LAYR"] = (d.data[b"LAYR"] + d.data[b"LAYR"][-16:])[:64 + 16 * layers]
        d.put(b"LAYR", 0, "I", layers)
        yield f"R23_layer_{name}", LAYOUT, d.join()
    for name, values in (("empty_range", (0, 0, 0)), ("low_above_high", (0.5, -0.5, 0)), ("low_positive", (0.1, 1, 0.5)),
                         ("high_negative", (-1, -0.1, -0.5)), ("initial_low", (-1, 1, -1.01)),
                         ("initial_high", (-1, 1, 1.01))):
        for where, at in (("first", 64), ("last", last)):
            yield f"R23_{name}_{where}", NUMBER, put(at, "3f", *values)


def with_quartic(quartic):
    """QUAR beside LAYR, which is right but for that."""
    d = Draft(quartic)
    layers = struct.unpack_from("<I", d.header, 44)[0] - 1
    d.table.insert(2, [b"LAYR", 1, 0, 0, 0, 0])
    d.data[b"LAYR"] = bytearray(struct.pack("<I60x", layers) + struct.pack("<3fI", -1, 1, 0, 0) * layers)
    return d.join()


def records_of(blob):
    """(offset of the record, kind, lanes, numbers K, offset and number of the changes) of every batch."""
    data = Draft(blob).data[b"ELEM"]
    for i in range(struct.unpack_from("<I", data)[0]):
        kind, count, valence, is_closed, _, _, _, at, changes = struct.unpack_from("<4I4QI", data, 64 + 64 * i)
        yield 64 + 64 * i, kind, (count + 15) // 16 * 16, shape_of(kind, valence, is_closed)[2], at, changes


def bad_batches_of_layers(layered, averaged):
    """(name, code, bytes): kinds and records that do not go with layers, or only with them."""
    _, put = editor(layered, b"ELEM")
    _, put_averaged = editor(averaged, b"ELEM")
    records = {kind: (at, lanes) for at, kind, lanes, *_ in records_of(layered)}
    if set(records) != {TIE, LAYERED_HINGE, LAYERED_NEO_HOOKEAN, LAYERED_ARAP}:
        raise SystemExit("give layers with all kinds of elements")
    for kind in (0, 12, 0xFFFFFFFF):
        yield f"R09_layers_kind_{kind}", LAYOUT, put(64, "I", kind)
    for kind in range(1, TIE):
        yield f"R23_layers_kind_{kind}", LAYOUT, put(64, "I", kind)
    for kind in (LAYERED_HINGE, LAYERED_NEO_HOOKEAN, LAYERED_ARAP):
        yield f"R23_kind_{kind}_without_layers", LAYOUT, put_averaged(64, "I", kind)
    yield "R23_changes_without_layers", LAYOUT, put_averaged(64 + 48, "I", 1)
    yield "R23_offset_of_changes_without_layers", LAYOUT, put_averaged(64 + 40, "Q", 64 * 4)
    cell, lanes = records[LAYERED_ARAP]
    yield "R05_layered_cell_valence_1", LIMIT, put(cell + 8, "I", 1)
    yield "R05_layered_cell_valence_33", LIMIT, put(cell + 8, "I", 33)
    yield "R14_layered_cell_closed_2", LAYOUT, put(cell + 12, "I", 2)
    yield "R14_layered_cell_closed_pair", LAYOUT, put(cell + 8, "2I", 2, 1)
    for kind in (LAYERED_HINGE, LAYERED_NEO_HOOKEAN):
        yield f"R14_layered_{kind}_valence", LAYOUT, put(records[kind][0] + 8, "I", 3)
        yield f"R14_layered_{kind}_closed", LAYOUT, put(records[kind][0] + 12, "I", 1)
        yield f"R05_layered_{kind}_none", LIMIT, put(records[kind][0] + 4, "I", 0)
    for byte in (52, 63):
        yield f"R14_layered_batch_byte_{byte}", LAYOUT, put(64 + byte, "B", 1)
    poses = struct.unpack_from("<I", layered, 44)[0]
    yield "R05_one_change_too_many", LIMIT, put(cell + 48, "I", (poses - 1) * lanes // 16 + 1)
    yield "R05_changes_overflow", LIMIT, put(cell + 48, "I", 0xFFFFFFFF)
    for kind in records:
        for name, field in (("rows", 16), ("fixed", 24), ("numbers", 32)):
            if (kind, name) != (TIE, "fixed"):
                at = struct.unpack_from("<Q", Draft(layered).data[b"ELEM"], records[kind][0] + field)[0]
                yield f"R10_layered_{kind}_{name}", NUMBER, put(at, "f", INF)


def bad_changes(layered):
    """(name, code, bytes): what can be wrong with the changes of ELEM."""
    edited, put = editor(layered, b"ELEM")
    data = Draft(layered).data[b"ELEM"]
    layers = struct.unpack_from("<I", layered, 44)[0] - 1
    # Of three groups of lanes or more, the last batch that is not full, so that its changes end the chunk or not.
    record, _, lanes, numbers, at, count = next(entry for entry in records_of(layered)
                                                if entry[2] > 32 and 3 < entry[5] < layers * entry[2] // 16
                                                and 8 * entry[5] % 64)
    floats_at = at + (8 * count + 63) // 64 * 64
    last = floats_at + 64 * count * numbers - 4
    pairs = list(struct.iter_unpack("<2I", data[at:at + 8 * count]))
    step = next(i for i in range(count - 1) if pairs[i][0] == pairs[i + 1][0])  # two groups of one layer
    turn = next(i for i in range(count - 1) if pairs[i][0] != pairs[i + 1][0])  # two layers

    yield "R24_changes_in_records", LAYOUT, put(record + 40, "Q", 0)
    yield "R24_changes_misaligned", LAYOUT, put(record + 40, "Q", at + 8)
    yield "R24_changes_past_end", LAYOUT, put(record + 40, "Q", (len(data) + 63) // 64 * 64)
    yield "R24_changes_wrap_around", LAYOUT, put(record + 40, "Q", 0xFFFFFFFFFFFFFFC0)
    yield "R24_changes_far_off", LAYOUT, put(record + 40, "Q", 1 << 63)
    cut, end = records_at_the_end(layered, record, pairs)
    yield "R24_records_only", LAYOUT, cut(end)
    yield "R24_records_cut", LAYOUT, cut(end - 8)
    yield "R24_without_padding", LAYOUT, cut(end + 4)
    yield "R24_last_change_cut", LAYOUT, edited(lambda d: cut_last_change(d))
    yield "R24_layer", INDEX, put(at + 8 * (count - 1), "I", layers)
    yield "R24_layer_huge", INDEX, put(at + 8 * (count - 1), "I", 0xFFFFFFFF)
    yield "R24_group", INDEX, put(at + 8 * (count - 1) + 4, "I", lanes // 16)
    yield "R24_group_huge", INDEX, put(at + 4, "I", 0xFFFFFFFF)
    yield "R24_twice", INDEX, put(at + 8 * (step + 1), "2I", *pairs[step])
    yield "R24_groups_descend", INDEX, put(at + 8 * step, "4I", *pairs[step + 1], *pairs[step])
    yield "R24_layers_descend", INDEX, put(at + 8 * turn, "4I", *pairs[turn + 1], *pairs[turn])
    yield "R24_first_byte_behind_records", LAYOUT, put(at + 8 * count, "B", 1)
    yield "R24_last_byte_behind_records", LAYOUT, put(floats_at - 1, "B", 0x80)
    yield "R24_first_change_nan", NUMBER, put(floats_at, "f", NAN)
    yield "R24_last_change_inf", NUMBER, put(last, "f", INF)


def records_at_the_end(layered, record, pairs):
    """A function that cuts the chunk at a place, the records of a batch having been moved to its end, and where they end."""
    data = Draft(layered).data[b"ELEM"]
    start = (len(data) + 63) // 64 * 64
    moved = data + bytes(start - len(data)) + b"".join(struct.pack("<2I", *pair) for pair in pairs) + bytes(64)
    struct.pack_into("<Q", moved, record + 40, start)

    def cut(end):
        d = Draft(layered)
        d.data[b"ELEM"] = moved[:end]
        return d.join()

    return cut, start + 8 * len(pairs)


def cut_last_change(d):
    data = d.data[b"ELEM"]
    ends = [at + (8 * count + 63) // 64 * 64 + 64 * count * numbers for _, _, _, numbers, at, count in records_of(d.good)]
    del data[max(ends) - 4:]


def bad_answers_of_layers(layered):
    """(name, code, bytes): weights of ANSW."""
    edited, put = editor(layered, b"ANSW")
    poses, dimension = struct.unpack_from("<I", layered, 44)[0], struct.unpack_from("<I", layered, 40)[0]
    count = struct.unpack_from("<I", Draft(layered).data[b"ANSW"])[0]
    last = 64 + 4 * (count - 1) * (poses + dimension)
    yield "R13_layers_first_weight_0", NUMBER, put(64, "f", 0.0)
    yield "R13_layers_last_answer", NUMBER, put(last, "f", 0.9999)
    yield "R13_layers_weight_nan", NUMBER, put(64 + 4, "f", NAN)


def good_layers(layered):
    """Files that a reader must accept: any weights in answers, a batch that no layer changes, an older minor version."""
    edited, put = editor(layered, b"ANSW")
    yield "good_layers", Draft(layered).join()
    yield "good_layers_answer", put(64 + 4, "2f", -7.0, 1e30)
    _, put = editor(layered, b"ELEM")
    yield "good_layers_without_changes", put(64 + 48, "I", 0)
    d = Draft(layered)
    struct.pack_into("<H", d.header, 14, 0)
    yield "good_layers_older_minor", d.join()
    d = Draft(layered)
    d.put(b"LAYR", 64, "3f", 0.0, 1e-45, 0.0)
    d.put(b"LAYR", 80, "3f", -3.4e38, 3.4e38, 3.4e38)
    yield "good_layers_extreme_ranges", d.join()
    d = Draft(layered)
    d.table.insert(0, d.table.pop(d.table.index(d.entry(b"LAYR"))))
    yield "good_layers_first", d.join()
