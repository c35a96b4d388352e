"""Builds small but real assets for tests, following formats/SPEC.md section 4; the baker is not needed.

    python3 tiny_asset.py OUT.pliant --mesh tube --poses 3 --dim 8 --material neo-hookean --predictor
"""
import argparse
import json
import struct
import sys
import zlib
from types import SimpleNamespace

import numpy as np

import tiny_elements
import tiny_layers
import tiny_mesh
import tiny_scene
import tiny_shape
import tiny_solids
from pliant_reference import (IDENTIFIER, LAYERED_ARAP, LAYERED_HINGE, LAYERED_NEO_HOOKEAN, TET_STVK, TIE, Asset, Batch,
                              pad16)
from pliant_reference_solid import Layout, Quartic


# ---------------------------------------------------------------------------------------------------------- model --

class StandIn(Asset):
    """The evaluator of the reference without a file behind it."""

    def __init__(self, batches, dimension, layers=None):
        self.batches, self.dimension, self.energy_scale, self.layers = batches, dimension, 1.0, layers
        self.centres = self.load_coefficients = self.quartic = None


def sample_weights(m):
    """Corners, edge mid-points, the centre."""
    corners = list(np.eye(m))
    middles = [(corners[i] + corners[j]) / 2 for i in range(m) for j in range(i)] if m <= 5 else []
    return np.array(corners + middles + ([np.full(m, 1 / m)] if m > 2 else []))


def make_mesh(mesh, size, has_layers):
    """Rest positions, triangles, cells, the module that knows their elements, and for a solid what VERT says."""
    if mesh == "beam":
        rest, tets, source, boundary_count = tiny_solids.beam(*size)
        return rest, tiny_solids.boundary_of(tets), tets, tiny_solids, (source, boundary_count)
    rest, faces = getattr(tiny_mesh, mesh)(*size)
    return rest, faces, tiny_elements.Topology(faces, len(rest)), tiny_layers if has_layers else tiny_elements, None


def find_average(make, x, basis, dimension):
    """The equal-weight average is z = 0, its inverse Hessian S S^T: first around pose 0, then around the average."""
    equal = np.full(len(x), 1 / len(x))
    mean, _ = StandIn(make(x[0], basis), dimension).minimise(equal, np.tensordot(basis, x.mean(axis=0) - x[0], 2))
    return mean, equal


def make_model(mesh, size, poses, dimension, material, predictor, load, seed, quartic=False, has_layers=False):
    """All numbers of an asset, in double precision."""
    random = np.random.default_rng(seed)
    rest, faces, topology, elements, vertices = make_mesh(mesh, size, has_layers)
    x = (tiny_layers if has_layers else tiny_mesh).make_poses(rest, poses, random)
    basis = tiny_mesh.make_subspace(x[:1 + tiny_layers.FREE] if has_layers else x, rest, dimension, random)
    layers = tiny_layers.ranges(poses - 1) if has_layers else None

    def make(base, directions):
        return elements.make_batches(topology, x, material, base, directions)

    mean, middle = (np.zeros(dimension), np.eye(poses)[0]) if has_layers else find_average(make, x, basis, dimension)
    centre = x[0] + np.tensordot(mean, basis, 1)
    stand_in = StandIn(make(centre, basis), dimension)
    values, vectors = np.linalg.eigh(stand_in.hessian(np.zeros(dimension), middle))
    whitening = vectors / np.sqrt(values)
    directions = np.tensordot(whitening.T, basis, 1)
    stand_in = StandIn(make(centre, directions), dimension, layers)

    def absolute(weights, y):
        return elements.absolute_energy(topology, x, material, weights, y)

    if quartic:
        stand_in.quartic, stand_in.batches = tiny_solids.quartic_of(stand_in.batches[0], dimension), []

    # The surrogate energy and the textbook differ by a constant, or one of them is wrong.
    w = tiny_layers.random_weights(poses, random) if has_layers else random.dirichlet(np.ones(poses))
    z = 0.05 * random.standard_normal(dimension)
    relative = stand_in.evaluate(z, w)[0]
    textbook = absolute(w, centre + np.tensordot(z, directions, 1)) - absolute(w, centre)
    size = max(abs(absolute(middle, centre)), abs(absolute(w, centre)), abs(textbook))
    if not abs(relative - textbook) < 1e-9 * size:
        raise AssertionError(f"{material}: the surrogate energy gives {relative}, the definition {textbook}")

    samples = (tiny_layers if has_layers else sys.modules[__name__]).sample_weights(poses)
    answers = [stand_in.minimise(user_weights(w, layers), np.zeros(dimension))[0] for w in samples]
    scale = np.mean([absolute(w, centre) + stand_in.evaluate(z, w)[0] for w, z in zip(samples, answers)])
    model = SimpleNamespace(x=x, faces=faces, basis=basis, mean=mean, whitening=whitening, stand_in=stand_in, scale=scale,
                            samples=samples, answers=answers, centres=None, coefficients=None, load=None, vertices=vertices,
                            layers=layers,
                            pose_coordinates=np.array([np.tensordot(basis, pose - x[0], 2) for pose in x]))
    if predictor:
        model.centres = samples
        model.coefficients = fit_predictor(samples, np.array(answers))
    if load:
        add_load(model, random)
    return model


def user_weights(w, layers):
    return w if layers is None else w[1:]


def with_wrong_weight(batch, factors, layers):
    if layers is not None:
        return tiny_layers.weighted(batch, factors)
    return Batch(batch.kind, batch.valence, batch.is_closed, batch.rows, batch.fixed, batch.poses * factors)


def add_load(model, random):
    """Elements with wrong weights, as a coarse sample of a mesh has them, and the load that puts the minimisers back where
    those of the right ones are. z stays whitened for the right ones."""
    dimension = len(model.mean)
    quartic = model.stand_in.quartic
    if quartic is not None:
        quartic = Quartic(quartic.indices, quartic.coefficients * random.uniform(0.7, 1.3, (len(quartic.coefficients), 1)))
    rough = [with_wrong_weight(batch, random.uniform(0.6, 1.4, batch.poses.shape[2]), model.layers)
             for batch in model.stand_in.batches]
    unloaded, loaded = StandIn(rough, dimension, model.layers), StandIn(rough, dimension, model.layers)
    unloaded.quartic = loaded.quartic = quartic
    forces = [unloaded.evaluate(z, w)[1] for w, z in zip(model.samples, model.answers)]
    model.load = fit_predictor(model.samples, -np.array(forces))
    loaded.centres, loaded.load_coefficients = model.samples, model.load

    def error(stand_in):
        found = [stand_in.minimise(user_weights(w, model.layers), z)[0] for w, z in zip(model.samples, model.answers)]
        return abs(np.array(found) - model.answers).max() / abs(np.array(model.answers)).max()

    if not (error(loaded) < 1e-6 and error(unloaded) > 2e-3):
        raise AssertionError(f"off by {error(loaded)} with the load, {error(unloaded)} without: this load tests nothing")
    model.stand_in = loaded


def fit_predictor(centres, answers):
    """Interpolation by |w - c|^3 and a linear part in w."""
    kernel = np.linalg.norm(centres[:, None] - centres[None], axis=2) ** 3
    m = centres.shape[1]
    system = np.block([[kernel, centres], [centres.T, np.zeros((m, m))]])
    return np.linalg.lstsq(system, np.concatenate([answers, np.zeros((m, answers.shape[1]))]), rcond=None)[0]


# --------------------------------------------------------------------------------------------------------- writing --

def floats(values):
    return np.ascontiguousarray(values, "<f4").tobytes()


def padded(values, width):
    values = np.asarray(values)
    result = np.zeros(values.shape[:-1] + (width,))
    result[..., :values.shape[-1]] = values
    return result


def align(data, alignment):
    return data + bytes(-len(data) % alignment)


def solver_chunk(model):
    wide = pad16(len(model.mean))
    return (floats([model.scale]) + bytes(60) + floats(padded(model.mean, wide)) + floats(padded(model.whitening.T, wide))
            + floats(padded(model.pose_coordinates, wide)))


def lanes_of(values, repeat):
    """[..., E] to [..., pad16(E)]: the last lane repeated, or zero."""
    extra = pad16(values.shape[-1]) - values.shape[-1]
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, extra)], "edge" if repeat else "constant")


def arrays_of(batch, has_layers):
    """Rows, fixed numbers, numbers in whole groups of lanes: what weights an element is zero behind the last."""
    fixed = lanes_of(batch.fixed, batch.kind != LAYERED_ARAP)
    if has_layers and batch.kind in (LAYERED_HINGE, LAYERED_NEO_HOOKEAN):
        fixed[1 if batch.kind == LAYERED_HINGE else 7:, batch.fixed.shape[1]:] = 0
    return lanes_of(batch.rows, True), fixed, lanes_of(batch.poses, batch.kind in (LAYERED_HINGE, LAYERED_NEO_HOOKEAN))


def changes_of(poses):
    """The changes of layers [m-1, K, P] by groups that have any: records, changes."""
    groups = poses.reshape(*poses.shape[:2], -1, 16).transpose(0, 2, 1, 3)
    kept = (abs(groups) > 1e-9).any(axis=(2, 3))
    return np.argwhere(kept).astype("<u4").tobytes(), floats(groups[kept]), int(kept.sum())


def element_chunk(batches, has_layers=False):
    head, data, start = struct.pack("<I60x", len(batches)), b"", 64 + 64 * len(batches)
    for batch in batches:
        rows, fixed, poses = arrays_of(batch, has_layers)
        offsets, count = [], 0
        for values in (rows, fixed, poses[0] if has_layers else poses):
            offsets.append(start + len(data))
            data = align(data + floats(values), 64)
        offsets.append(start + len(data) if has_layers else 0)
        if has_layers:
            records, changes, count = changes_of(poses[1:])
            data = align(align(data + records, 64) + changes, 64)
        head += struct.pack("<4I4QI12x", batch.kind, batch.rows.shape[2], batch.valence, batch.is_closed, *offsets, count)
    return head + data


def layer_chunk(layers):
    return struct.pack("<I60x", len(layers)) + floats(np.column_stack([layers, np.zeros(len(layers))]))


def quartic_chunk(quartic, dimension):
    layout = Layout(dimension)
    tables = np.zeros((len(quartic.coefficients), layout.padded_count))
    tables[:, layout.places] = quartic.coefficients
    return struct.pack("<I60x", layout.count) + floats(tables)


def ranges_chunk(model):
    """MRNG: where q was found at a few weights, and the width of the widest on both sides."""
    q = np.concatenate([model.pose_coordinates, model.mean + np.array(model.answers) @ model.whitening.T])
    low, high = q.min(axis=0), q.max(axis=0)
    table = np.array([low - (high - low).max(), high + (high - low).max()])
    return floats(padded(table, pad16(len(model.mean))))


def vertex_chunk(source, boundary_count):
    return struct.pack("<I60x", boundary_count) + np.array(source, "<u4").tobytes()


def predictor_chunk(model):
    centres = struct.pack("<I60x", len(model.centres)) + floats(model.centres)
    return align(centres, 64) + floats(padded(model.coefficients, pad16(len(model.mean))))


def load_chunk(model):
    return struct.pack("<I60x", len(model.centres)) + floats(padded(model.load, pad16(len(model.mean))))


def tiles_of(fields):
    """[..., n, 3] to [tiles, ..., 48]"""
    fields = np.asarray(fields)
    padding = [(0, 0)] * (fields.ndim - 2) + [(0, -fields.shape[-2] % 16), (0, 0)]
    tiles = np.pad(fields, padding).reshape(*fields.shape[:-2], -1, 48)
    return np.moveaxis(tiles, -2, 0)


def polygon_chunk(faces):
    """As if neighbouring pairs of triangles had been quads in the input; enough to test readers."""
    sizes, corners = [], []
    for pair in faces.reshape(-1, 2, 3):
        polygon = list(pair[0]) + [v for v in pair[1] if v not in pair[0]]
        sizes.append(len(polygon))
        corners += polygon
    return struct.pack("<2I", len(sizes), len(corners)) + np.array(sizes + corners, "<u4").tobytes()


def shape_chunks(model, origin, compact, factored):
    """BASI, or BASC and BNDS, or BASF and BNDS."""
    if not compact and not factored:
        return [("BASI", 1, floats(tiles_of(model.basis)))]
    basis, rest = np.asarray(model.basis), np.float32(model.x[0] - np.float32(origin)).astype(float)
    if factored:
        chunk = tiny_shape.factored_chunk(rest, basis, factored)
        rest, packed = tiny_shape.unpacked_factors(chunk, *basis.shape[:2])
    else:
        chunk = tiny_shape.compact_chunk(basis, compact)
        packed = tiny_shape.unpacked(chunk, *basis.shape[:2])
    rest = np.float32(origin).astype(float) + rest
    return [("BNDS", 0, tiny_shape.bounds_chunk(rest, packed, min(5, len(rest)))),
            ("BASF" if factored else "BASC", 1, chunk)]


def chunks_of(model, polygons, compact=0.0, smoothing=False, ranges=False, scene=False, factored=0.0):
    m, d = len(model.x), len(model.mean)
    origin = model.x[0].mean(axis=0)
    answers = np.array([np.concatenate([w, model.mean + model.whitening @ z])
                        for w, z in zip(model.samples, model.answers)])[:8]
    chunks = [("SOLV", 1, solver_chunk(model))]
    if model.stand_in.quartic is not None:
        chunks.append(("QUAR", 1, quartic_chunk(model.stand_in.quartic, d)))
    else:
        chunks.append(("ELEM", 1, element_chunk(model.stand_in.batches, model.layers is not None)))
    if model.layers is not None:
        chunks.append(("LAYR", 1, layer_chunk(model.layers)))
    if model.centres is not None:
        chunks.append(("PRED", 0, predictor_chunk(model)))
    if model.load is not None:
        chunks.append(("LOAD", 1, load_chunk(model)))
    if ranges:
        chunks.append(("MRNG", 0, ranges_chunk(model)))
    if not factored:
        chunks.append(("REST", 1, floats(tiles_of(model.x[0] - np.float32(origin)))))
    chunks.append(("TRIS", 1, np.array(model.faces, "<u4").tobytes()))
    if model.vertices is not None:
        chunks.append(("VERT", 0, vertex_chunk(*model.vertices)))
    if smoothing:
        # Pairs of neighbours; that they do not lie at one place tests the definition all the harder.
        chunks.append(("SMTH", 0, (np.arange(len(model.x[0]), dtype="<u4") // 2 * 2).tobytes()))
    if polygons:
        chunks.append(("POLY", 0, polygon_chunk(model.faces)))
    names = "".join(f"pose {k}\0" for k in range(m)).encode()
    certificate = json.dumps({"writer": "tests/runtime/tiny_asset.py", "dimension": d}, sort_keys=True).encode()
    chunks += [("NAME", 1, names), ("ANSW", 1, struct.pack("<I60x", len(answers)) + floats(answers)),
               ("CERT", 1, certificate)]
    if scene:
        chunks.append(("GLTF", 0, tiny_scene.scene_chunk(np.asarray(model.faces), len(model.x[0]))))
    chunks += shape_chunks(model, origin, compact, factored)
    counts = (len(model.x[0]), len(model.faces), d, m)
    return counts, origin, chunks


def oldest_minor(chunks):
    """The format version that has all that a file holds."""
    if "LAYR" in chunks:
        return 5
    if "BASF" in chunks:
        return 4
    if any(tag in chunks for tag in ("BASC", "BNDS", "MRNG", "GLTF")):
        return 3
    elements = chunks.get("ELEM", bytes(64))
    kinds = [struct.unpack_from("<I", elements, 64 + 64 * i)[0] for i in range(struct.unpack_from("<I", elements)[0])]
    if "SMTH" in chunks or TIE in kinds:
        return 3
    if "QUAR" in chunks or "VERT" in chunks or any(kind >= TET_STVK for kind in kinds):
        return 2
    return int("LOAD" in chunks)


def assemble(counts, origin, chunks):
    """The file: header, table, chunks, checksums."""
    table, body, at = b"", b"", 64 + 32 * len(chunks)
    for tag, flags, data in chunks:
        alignment = 4096 if tag == "BASI" else 64
        body += bytes(-(at + len(body)) % alignment)
        table += struct.pack("<4sIQQII", tag.encode(), flags, at + len(body), len(data), zlib.crc32(data), 0)
        body += data
    size = at + len(body)
    minor = oldest_minor({tag: data for tag, _, data in chunks})

    def header(crc):
        return (IDENTIFIER + struct.pack("<HHQII4I", 1, minor, size, len(chunks), crc, *counts) + floats(origin)
                + bytes(4))

    return header(zlib.crc32(header(0) + table)) + table + body


def make_asset(mesh="strip", size=(7, 3), poses=2, dimension=4, material="neo-hookean", predictor=False, load=False,
               polygons=False, seed=1, quartic=False, compact=0.0, smoothing=False, ranges=False,
               scene=False, factored=0.0, layers=False):
    model = make_model(mesh, size, poses, dimension, material, predictor, load, seed, quartic, layers)
    return assemble(*chunks_of(model, polygons, compact, smoothing, ranges, scene, factored))


def main():
    parser = argparse.ArgumentParser(description="builds a tiny asset for tests")
    parser.add_argument("output")
    parser.add_argument("--mesh", choices=["strip", "tube", "beam"], default="strip")
    parser.add_argument("--size", type=int, nargs=2, default=(7, 3), metavar=("COLUMNS", "ROWS"))
    parser.add_argument("--poses", type=int, default=2)
    parser.add_argument("--dim", type=int, default=4)
    parser.add_argument("--material", default="neo-hookean",
                        choices=["neo-hookean", "stvk", "edge", "arap", "mixed", "tied", "tet-stvk", "mooney-rivlin",
                                 "tet-mixed"])
    parser.add_argument("--quartic", action="store_true", help="QUAR instead of ELEM, for tet-stvk")
    parser.add_argument("--predictor", action="store_true")
    parser.add_argument("--load", action="store_true", help="needs --predictor")
    parser.add_argument("--polygons", action="store_true")
    parser.add_argument("--smoothing", action="store_true", help="SMTH: pairs of vertices share a normal")
    parser.add_argument("--compact", type=float, default=0.0, help="BASC of about this accuracy, and BNDS, instead of BASI")
    parser.add_argument("--factored", type=float, default=0.0, help="BASF of about this accuracy, and BNDS")
    parser.add_argument("--ranges", action="store_true", help="with MRNG")
    parser.add_argument("--scene", action="store_true", help="with GLTF: two parts, a texture, vertex colours")
    parser.add_argument("--layers", action="store_true", help="LAYR: pose 0 is the rest shape, the others are layers")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.load and not options.predictor:
        parser.error("--load needs --predictor: it shares its centres")
    if (options.mesh == "beam") != (options.material in ("tet-stvk", "mooney-rivlin", "tet-mixed")):
        parser.error("a beam and the materials of tetrahedra go together")
    if options.compact and options.factored:
        parser.error("--compact and --factored exclude each other")
    if options.layers and options.material not in ("neo-hookean", "arap", "mixed", "tied"):
        parser.error("--layers needs --material neo-hookean, arap, mixed or tied")
    if options.quartic and options.material != "tet-stvk":
        parser.error("--quartic needs --material tet-stvk: no other is a polynomial")
    blob = make_asset(options.mesh, options.size, options.poses, options.dim, options.material, options.predictor,
                      options.load, options.polygons, options.seed, options.quartic, options.compact,
                      options.smoothing, options.ranges, options.scene, options.factored, options.layers)
    with open(options.output, "wb") as file:
        file.write(blob)
    return 0


if __name__ == "__main__":
    sys.exit(main())
