#!/usr/bin/python3
"""Second implementation of the .pliant format, in numpy and double precision: reads an asset, evaluates its surrogate
energy, minimises it, rebuilds positions. Written from SPEC.md, sharing no code with the C runtime: where the two disagree,
one of them or the SPEC is wrong. Slow and readable.

    python3 pliant_reference.py ASSET                          what is in it
    python3 pliant_reference.py ASSET --weights 1,1 [-o OUT]   blend; OUT gets one "x y z" line a vertex
"""
import argparse
import struct
import sys
import zlib

import numpy as np

from pliant_reference_scene import Scene
from pliant_reference_shape import MAX_CLUSTERS, Clusters, Compact, Factored
from pliant_reference_solid import Layout, Quartic, evaluate_tet_mooney_rivlin, evaluate_tet_stvk

IDENTIFIER = bytes([0xAB]) + b"PLIANT" + bytes([0xBB]) + b"\r\n\x1a\n"
REQUIRED = ("SOLV", "TRIS", "NAME", "ANSW", "CERT")
KNOWN = REQUIRED + ("ELEM", "QUAR", "PRED", "LOAD", "REST", "POLY", "VERT", "SMTH", "MRNG", "GLTF", "BASI", "BASC", "BASF",
                    "BNDS")
HINGE, NEO_HOOKEAN, STVK, EDGE, ARAP, TET_STVK, TET_MOONEY_RIVLIN, TIE = range(1, 9)


class FormatError(Exception):
    """A file that breaks a rule; .rule is its number in SPEC.md section 5, e.g. "R06"."""

    def __init__(self, rule, text):
        super().__init__(f"{rule}: {text}")
        self.rule = rule


def require(condition, rule, text):
    if not condition:
        raise FormatError(rule, text)


def pad16(count):
    return (count + 15) // 16 * 16


def shape_of(kind, valence, is_closed):
    """R, F, K of a batch (SPEC.md, table of kinds)."""
    if kind == ARAP:
        edges = valence + (valence if is_closed else valence - 1)
        return 3 * valence, 0, 4 * edges + 1
    return {HINGE: (9, 2, 2), NEO_HOOKEAN: (6, 4, 5), STVK: (6, 0, 9), EDGE: (6, 4, 8), TET_STVK: (9, 0, 27),
            TET_MOONEY_RIVLIN: (9, 0, 20), TIE: (9, 0, 4)}[kind]


class Batch:
    """Elements of one kind: rows [1+d, R, E], fixed [F, E], poses [m, K, E]."""

    def __init__(self, kind, valence, is_closed, rows, fixed, poses):
        self.kind, self.valence, self.is_closed = kind, valence, is_closed
        self.rows, self.fixed, self.poses = rows, fixed, poses


# ------------------------------------------------------------------------------------------------------------ reading --

class Asset:
    def __init__(self, blob, verify=True):
        self.blob = bytes(blob)
        self.read_header()
        self.read_chunk_table()
        if verify:
            self.verify_checksums()
        self.read_solver()
        self.batches, self.quartic = [], None
        if "ELEM" in self.chunks:
            self.read_elements()
        else:
            self.read_quartic()
        self.read_predictor()
        self.read_load()
        self.read_shape()
        self.read_topology()
        self.read_answers()
        self.read_morph_ranges()

    def read_header(self):
        blob = self.blob
        require(len(blob) >= 64, "R01", f"{len(blob)} bytes are less than a header")
        require(blob[:12] == IDENTIFIER, "R02", "not a .pliant file")
        major, self.minor = struct.unpack_from("<HH", blob, 12)
        require(major == 1, "R03", f"format {major}, this reads 1")
        size, self.chunk_count, self.header_crc = struct.unpack_from("<QII", blob, 16)
        require(size == len(blob), "R04", f"states {size} bytes, has {len(blob)}")
        self.vertex_count, self.triangle_count, self.dimension, self.pose_count = struct.unpack_from("<4I", blob, 32)
        for count, low, high in ((self.chunk_count, 1, 64), (self.vertex_count, 1, 1 << 26),
                                 (self.triangle_count, 1, 1 << 27), (self.dimension, 1, 256), (self.pose_count, 2, 64)):
            require(low <= count <= high, "R05", f"a count is {count}, not in {low} .. {high}")
        self.origin = np.frombuffer(blob, "<f4", 3, 48).astype(float)
        require(np.isfinite(self.origin).all(), "R10", "origin")
        require(blob[60:64] == bytes(4), "R14", "reserved word of the header")

    def read_chunk_table(self):
        self.chunks, self.crcs, self.flags = {}, {}, {}
        end = 64 + 32 * self.chunk_count
        require(end <= len(self.blob), "R06", "chunk table past the end of the file")
        unknown = []
        for i in range(self.chunk_count):
            tag, flags, offset, size, crc, reserved = struct.unpack_from("<4sIQQII", self.blob, 64 + 32 * i)
            tag = tag.decode("latin-1")
            alignment = 4096 if tag == "BASI" else 64
            require(offset % alignment == 0, "R06", f"{tag} at {offset} is not aligned")
            require(offset >= end, "R06", f"{tag} overlaps what is before it")
            end = offset + size
            require(end <= len(self.blob), "R06", f"{tag} ends past the file")
            require(tag not in self.chunks, "R06", f"{tag} twice")
            require(flags in (0, 1) and reserved == 0, "R14", f"reserved bits of {tag}")
            self.chunks[tag], self.crcs[tag], self.flags[tag] = (offset, size), crc, flags
            if tag not in KNOWN and flags & 1:
                unknown.append(tag)
        require(not unknown, "R07", f"unknown chunks are required: {unknown}")
        for tag in REQUIRED:
            require(tag in self.chunks, "R07", f"{tag} is missing")
        require(("ELEM" in self.chunks) != ("QUAR" in self.chunks), "R07", "not exactly one of ELEM and QUAR")
        require(sum(tag in self.chunks for tag in ("BASI", "BASC", "BASF")) == 1, "R07", "not exactly one basis")
        require(("REST" in self.chunks) != ("BASF" in self.chunks), "R07", "not exactly one of REST and BASF")

    def verify_checksums(self):
        head = bytearray(self.blob[:64 + 32 * self.chunk_count])
        head[28:32] = bytes(4)
        require(zlib.crc32(head) == self.header_crc, "R08", "header checksum")
        for tag in self.chunks:
            require(zlib.crc32(self.bytes_of(tag)) == self.crcs[tag], "R12", f"checksum of {tag}")

    def bytes_of(self, tag):
        offset, size = self.chunks[tag]
        return self.blob[offset:offset + size]

    def counted(self, tag, limit):
        """Bytes of a chunk that starts with a count and 60 zero bytes, and the count."""
        data = self.bytes_of(tag)
        require(len(data) >= 64, "R09", f"{tag} is shorter than its head")
        count = struct.unpack_from("<I", data)[0]
        require(1 <= count <= limit, "R05", f"{tag} counts {count}")
        require(data[4:64] == bytes(60), "R14", f"reserved bytes of {tag}")
        return data, count

    def read_solver(self):
        data, d, m, wide = self.bytes_of("SOLV"), self.dimension, self.pose_count, pad16(self.dimension)
        require(len(data) == 64 + 4 * wide * (1 + d + m), "R09", "size of SOLV")
        require(data[4:64] == bytes(60), "R14", "reserved bytes of SOLV")
        self.energy_scale = float(np.frombuffer(data, "<f4", 1)[0])
        table = np.frombuffer(data, "<f4", offset=64).reshape(1 + d + m, wide).astype(float)
        require(np.isfinite(table).all() and np.isfinite(self.energy_scale) and self.energy_scale > 0, "R10", "SOLV")
        self.mean = table[0, :d]
        self.whitening = table[1:1 + d, :d].T  # columns of S are stored as rows
        self.pose_coordinates = table[1 + d:, :d]

    def read_elements(self):
        data, count = self.counted("ELEM", 64)
        require(len(data) >= 64 + 64 * count, "R09", "records of ELEM")
        self.batches = [self.read_batch(data, 64 + 64 * i, 64 + 64 * count) for i in range(count)]

    def read_batch(self, data, at, data_start):
        kind, count, valence, is_closed, rows_at, fixed_at, poses_at = struct.unpack_from("<4I3Q", data, at)
        require(HINGE <= kind <= TIE, "R09", f"element kind {kind}")
        require(1 <= count <= 1 << 22, "R05", f"{count} elements")
        if kind == ARAP:
            require(2 <= valence <= 32, "R05", f"valence {valence}")
            require(is_closed == 0 or (is_closed == 1 and valence >= 3), "R14", "is_closed")
        else:
            require(valence == 0 and is_closed == 0, "R14", "valence of a kind without one")
        require(data[at + 40:at + 64] == bytes(24), "R14", "reserved bytes of a batch")
        row_count, fixed_count, number_count = shape_of(kind, valence, is_closed)
        lanes = pad16(count)

        def lanes_of(offset, *shape):
            require(offset % 64 == 0 and offset >= data_start, "R09", "offset of an array of ELEM")
            floats = int(np.prod(shape)) * lanes
            require(offset + 4 * floats <= len(data), "R09", "array of ELEM past its chunk")
            values = np.frombuffer(data, "<f4", floats, offset).reshape(*shape, lanes).astype(float)
            require(np.isfinite(values).all(), "R10", "ELEM")
            return values

        arrays = (lanes_of(rows_at, 1 + self.dimension, row_count), lanes_of(fixed_at, fixed_count),
                  lanes_of(poses_at, self.pose_count, number_count))
        if kind in (TET_STVK, TET_MOONEY_RIVLIN):
            require((arrays[0][0] == np.eye(3).reshape(9, 1)).all(), "R17",
                    "a tetrahedron that is not the identity at z = 0")
        return Batch(kind, valence, is_closed, *(array[..., :count] for array in arrays))

    def read_quartic(self):
        require(self.dimension <= 64, "R05", f"QUAR with dimension {self.dimension}")
        layout, m = Layout(self.dimension), self.pose_count
        data, count = self.counted("QUAR", (1 << 32) - 1)
        require(self.flags["QUAR"] & 1, "R16", "QUAR without the required flag")
        require(count == layout.count, "R16", f"QUAR counts {count} floats of a table, there are {layout.count}")
        require(len(data) == 64 + 4 * m * layout.padded_count, "R09", "size of QUAR")
        tables = np.frombuffer(data, "<f4", offset=64).reshape(m, -1)
        require(np.isfinite(tables).all(), "R10", "QUAR")
        rest = tables.view("<u4").copy()
        rest[:, layout.places[1:]] = 0
        require(not rest.any(), "R14", "padding or constant term of QUAR")
        self.quartic = Quartic(layout.indices, tables[:, layout.places].astype(float))

    def read_predictor(self):
        self.centres = None
        if "PRED" not in self.chunks:
            return
        data, count = self.counted("PRED", 4096)
        m, wide = self.pose_count, pad16(self.dimension)
        end = 64 + 4 * count * m
        start = (end + 63) // 64 * 64
        require(len(data) == start + 4 * (count + m) * wide, "R09", "size of PRED")
        require(not any(data[end:start]), "R14", "bytes behind the centres")
        self.centres = np.frombuffer(data, "<f4", count * m, 64).reshape(count, m).astype(float)
        table = np.frombuffer(data, "<f4", offset=start).reshape(count + m, wide)
        self.coefficients = table[:, :self.dimension].astype(float)
        require(np.isfinite(self.centres).all() and np.isfinite(self.coefficients).all(), "R10", "PRED")

    def read_load(self):
        self.load_coefficients = None
        if "LOAD" not in self.chunks:
            return
        data, count = self.counted("LOAD", 4096)
        require(self.flags["LOAD"] & 1, "R15", "LOAD without the required flag")
        require(self.centres is not None, "R15", "LOAD without PRED")
        require(count == len(self.centres), "R15", f"LOAD has {count} centres, PRED {len(self.centres)}")
        rows, wide = count + self.pose_count, pad16(self.dimension)
        require(len(data) == 64 + 4 * rows * wide, "R09", "size of LOAD")
        table = np.frombuffer(data, "<f4", offset=64).reshape(rows, wide)
        require(np.isfinite(table).all(), "R10", "LOAD")
        require(not table[:, self.dimension:].tobytes().strip(b"\0"), "R14", "padding of LOAD")
        self.load_coefficients = table[:, :self.dimension].astype(float)

    def read_shape(self):
        tiles, d, n = (self.vertex_count + 15) // 16, self.dimension, self.vertex_count
        self.compact, self.factored, self.clusters = None, None, None
        if "BASF" in self.chunks:
            self.factored = Factored(self.bytes_of("BASF"), self.flags["BASF"], d, n, require)
            self.rest, self.basis = self.factored.rest, self.factored.basis
        else:
            rest = self.bytes_of("REST")
            require(len(rest) == tiles * 192, "R09", "size of REST")
            self.rest = np.frombuffer(rest, "<f4").reshape(tiles * 16, 3)[:n].astype(float)
        if "BASC" in self.chunks:
            self.compact = Compact(self.bytes_of("BASC"), self.flags["BASC"], d, n, require)
            self.basis = self.compact.basis
        elif not self.factored:
            basis = self.bytes_of("BASI")
            require(len(basis) == tiles * d * 192, "R09", "size of BASI")
            tiled = np.frombuffer(basis, "<f4").reshape(tiles, d, 16, 3)
            self.basis = tiled.transpose(1, 0, 2, 3).reshape(d, tiles * 16, 3)[:, :n].astype(float)
        if "BNDS" in self.chunks:
            data, count = self.counted("BNDS", MAX_CLUSTERS)
            self.clusters = Clusters(data, count, d, require)

    def read_topology(self):
        data, n = self.bytes_of("TRIS"), self.vertex_count
        require(len(data) == 12 * self.triangle_count, "R09", "size of TRIS")
        self.triangles = np.frombuffer(data, "<u4").reshape(-1, 3)
        self.read_vertices()
        n = self.boundary_vertex_count
        require(self.triangles.max() < n, "R11", "TRIS names a vertex that does not exist or is not of the boundary")
        self.smoothing = np.arange(self.vertex_count)
        if "SMTH" in self.chunks:
            data = self.bytes_of("SMTH")
            require(len(data) == 4 * self.vertex_count, "R09", "size of SMTH")
            self.smoothing = np.frombuffer(data, "<u4")
            require(self.smoothing.max() < self.vertex_count, "R11", "SMTH names a group that does not exist")
        self.polygons = None
        if "POLY" in self.chunks:
            words = self.bytes_of("POLY")
            require(len(words) >= 8, "R09", "size of POLY")
            faces, indices = struct.unpack_from("<2I", words)
            require(len(words) == 8 + 4 * (faces + indices), "R09", "size of POLY")
            sizes = np.frombuffer(words, "<u4", faces, 8)
            corners = np.frombuffer(words, "<u4", indices, 8 + 4 * faces)
            require((sizes >= 3).all() and sizes.astype(int).sum() == indices, "R11", "sizes of POLY")
            require((corners < n).all(), "R11", "POLY names a vertex that does not exist or is not of the boundary")
            self.polygons = np.split(corners, np.cumsum(sizes)[:-1])
        names = self.bytes_of("NAME")
        require(names.count(0) == self.pose_count and names.endswith(b"\0"), "R11", "number of names")
        self.names = [name.decode("utf-8", "replace") for name in names[:-1].split(b"\0")]

    def read_vertices(self):
        self.boundary_vertex_count, self.source_vertices = self.vertex_count, None
        if "VERT" in self.chunks:
            data, self.boundary_vertex_count = self.counted("VERT", self.vertex_count)
            require(len(data) == 64 + 4 * self.vertex_count, "R09", "size of VERT")
            self.source_vertices = np.frombuffer(data, "<u4", offset=64)
            require(self.source_vertices.max() < self.vertex_count, "R11", "VERT names a vertex that does not exist")

    def read_answers(self):
        data, count = self.counted("ANSW", 64)
        width = self.pose_count + self.dimension
        require(len(data) == 64 + 4 * count * width, "R09", "size of ANSW")
        table = np.frombuffer(data, "<f4", offset=64).reshape(count, width).astype(float)
        weights = table[:, :self.pose_count]
        require(np.isfinite(table).all() and (weights >= 0).all(), "R13", "ANSW")
        require((abs(weights.sum(axis=1) - 1) <= 1e-3).all(), "R13", "sum of an answer's weights")
        self.answers = [(row[:self.pose_count], row[self.pose_count:]) for row in table]

    def scene(self):
        """What is drawn with the vertices (pliant_reference_scene.Scene), or None.
        Opening an asset does not look into it."""
        return Scene(self.bytes_of("GLTF"), self.boundary_vertex_count, require) if "GLTF" in self.chunks else None

    def read_morph_ranges(self):
        self.morph_ranges = None
        if "MRNG" in self.chunks:
            data, d = self.bytes_of("MRNG"), self.dimension
            require(len(data) == 2 * 4 * pad16(d), "R09", "size of MRNG")
            table = np.frombuffer(data, "<f4").reshape(2, -1)
            require(np.isfinite(table).all(), "R10", "MRNG")
            width = table[1, :d].astype(float) - table[0, :d]
            require((width >= 0).all() and np.isfinite(width.astype("<f4")).all(), "R20", "a range of MRNG")
            require(not table[:, d:].tobytes().strip(b"\0"), "R14", "padding of MRNG")
            self.morph_ranges = table[:, :d].astype(float)

    # ------------------------------------------------------------------------------------------------------ solving --

    def morph_weights(self, q):
        """q as weights of morph targets; 0 for a target that moves nothing."""
        low, high = self.morph_ranges
        width = high - low
        return np.where(width > 0, (q - low) / np.where(width > 0, width, 1), 0)

    def features(self, weights):
        """What PRED and LOAD are linear in: the cubed distances from the centres, and the weights."""
        return np.concatenate([np.linalg.norm(weights - self.centres, axis=1) ** 3, weights])

    def predict(self, weights):
        return np.zeros(self.dimension) if self.centres is None else self.features(weights) @ self.coefficients

    def load(self, weights):
        """The dead load c(w)."""
        if self.load_coefficients is None:
            return np.zeros(self.dimension)
        return self.features(weights) @ self.load_coefficients

    def evaluate(self, z, weights):
        """Energy and gradient of the surrogate energy, its load included; (inf, None) where it is not defined."""
        gradient = self.load(weights)
        energy = gradient @ z
        if self.quartic is not None:
            value, slope = self.quartic.evaluate(z, weights)
            energy, gradient = energy + value, gradient + slope
        for batch in self.batches:
            differences = batch.rows[0] + np.tensordot(z, batch.rows[1:], 1)
            value, force = EVALUATE[batch.kind](batch, differences, weights)
            if not np.isfinite(value):
                return np.inf, None
            energy += value
            gradient += np.tensordot(batch.rows[1:], force, 2)
        return energy, gradient

    def hessian(self, z, weights, step=1e-4):
        """Central differences of the gradient: z is whitened, so its natural step is a small part of 1."""
        columns = [(self.evaluate(z + step * e, weights)[1] - self.evaluate(z - step * e, weights)[1]) / (2 * step)
                   for e in np.eye(self.dimension)]
        return (np.array(columns) + np.array(columns).T) / 2

    def minimise(self, weights, z=None, tolerance=1e-9):
        """Newton with eigenvalues made positive and Armijo's rule. Returns z, energy."""
        weights = np.asarray(weights, float) / np.sum(weights)
        z = self.predict(weights) if z is None else np.array(z, float)
        energy, gradient = self.evaluate(z, weights)
        if gradient is None or energy > 0:
            z = np.zeros(self.dimension)
            energy, gradient = self.evaluate(z, weights)
        for _ in range(100):
            values, vectors = np.linalg.eigh(self.hessian(z, weights))
            step = -vectors @ ((vectors.T @ gradient) / np.maximum(abs(values), 1e-6 * abs(values).max()))
            slope = gradient @ step
            if -slope <= tolerance ** 2 * self.energy_scale:
                break
            length = 1.0
            while length > 1e-10:
                trial, trial_gradient = self.evaluate(z + length * step, weights)
                # Below 1e-12 of the scale differences of energies are rounding: take the step.
                if trial <= energy + 1e-4 * length * slope or (-slope < 1e-12 * self.energy_scale and np.isfinite(trial)):
                    break
                length /= 2
            else:
                break
            z, energy, gradient = z + length * step, trial, trial_gradient
        return z, energy

    def coordinates(self, z):
        return self.mean + self.whitening @ z

    def reconstruct(self, q):
        return self.origin + self.rest + np.tensordot(q, self.basis, 1)

    def normals(self, positions):
        """One of length 1 for each vertex (SPEC.md, SMTH)."""
        sums = np.zeros_like(positions)
        members = [np.flatnonzero(self.smoothing == group) for group in range(self.vertex_count)]
        for triangle in self.triangles.astype(int):
            for a, b, c in (triangle, np.roll(triangle, -1), np.roll(triangle, -2)):
                for v in members[self.smoothing[a]]:
                    sums[v] += np.cross(positions[b] - positions[v], positions[c] - positions[v])
        lengths = np.linalg.norm(sums, axis=1)
        sums[lengths == 0] = 0, 0, 1
        return sums / np.where(lengths == 0, 1, lengths)[:, None]

    def bounds(self, q):
        """Lowest and highest corner of a box round all vertices."""
        if self.clusters is not None:
            return self.clusters.box(q)
        positions = self.reconstruct(q)
        return positions.min(axis=0), positions.max(axis=0)


# ----------------------------------------------------------------------------------------------------------- elements --
# Each takes differences [R, E] and returns the energy of the whole batch and its derivatives by the differences, [R, E].

def vectors_of(rows):
    return rows.reshape(-1, 3, rows.shape[1])


def dot(a, b):
    return (a * b).sum(axis=0)


def cross(a, b):
    return np.cross(a, b, axis=0)


def combined(batch, weights):
    return np.tensordot(weights, batch.poses, 1)


def evaluate_hinges(batch, differences, weights):
    e, a, b = vectors_of(differences)
    centre, t0 = batch.fixed
    beta, gamma = combined(batch, weights)
    n1, n2, length = cross(e, a), cross(b, e), np.sqrt(dot(e, e))
    theta = np.arctan2(dot(e, cross(n1, n2)) / length, dot(n1, n2))
    t = theta - centre
    t = t - 2 * np.pi * np.round(t / (2 * np.pi))
    energy = ((t - t0) * (beta * (t + t0) - 2 * gamma)).sum()
    slope = 2 * (beta * t - gamma)
    # Gradient of the dihedral angle: the opposite vertices move it by length / |N|^2 along the normals; the edge's end takes
    # the share that its position along the edge demands, as a rotation of the whole leaves the angle alone.
    u1, u2 = n1 * (length / dot(n1, n1)), n2 * (length / dot(n2, n2))
    along1, along2 = dot(a, e) / dot(e, e), dot(b, e) / dot(e, e)
    force = np.stack([along1 * u1 + along2 * u2, -u1, -u2]) * slope
    return energy, force.reshape(9, -1)


def face_metric(batch, differences):
    """e, a and the change of the metric since z = 0."""
    e, a = vectors_of(differences)
    e0, a0 = vectors_of(batch.rows[0])
    de, da = e - e0, a - a0
    return e, a, dot(e + e0, de), dot(de, a) + dot(e0, da), dot(a + a0, da)


def face_force(e, a, f11, f12, f22):
    return np.stack([2 * f11 * e + f12 * a, f12 * e + 2 * f22 * a]).reshape(6, -1)


def evaluate_neo_hookean(batch, differences, weights):
    e, a, g11, g12, g22 = face_metric(batch, differences)
    i11, i12, i22, r = batch.fixed
    l11, l12, l22, area, barrier = combined(batch, weights)
    det = g11 * g22 - g12 ** 2
    u = i11 * g11 + 2 * i12 * g12 + i22 * g22 + r * det
    if (u <= -1).any():
        return np.inf, None
    energy = (l11 * g11 + l12 * g12 + l22 * g22 + area * det - barrier * (np.log1p(u) - u)).sum()
    fu = barrier * (1 - 1 / (1 + u))
    f11 = l11 + area * g22 + fu * (i11 + r * g22)
    f12 = l12 - 2 * area * g12 + fu * (2 * i12 - 2 * r * g12)
    f22 = l22 + area * g11 + fu * (i22 + r * g11)
    return energy, face_force(e, a, f11, f12, f22)


def evaluate_stvk(batch, differences, weights):
    e, a, *g = face_metric(batch, differences)
    g, c = np.array(g), combined(batch, weights)
    linear, matrix = c[:3], c[[[3, 4, 5], [4, 6, 7], [5, 7, 8]]]
    product = (matrix * g).sum(axis=1)
    return (linear * g + g * product / 2).sum(), face_force(e, a, *(linear + product))


def evaluate_edge(batch, differences, weights):
    e, a = vectors_of(differences)
    normal = cross(e, a)
    lengths = np.sqrt(np.stack([dot(e, e), dot(a, a), dot(a - e, a - e), dot(normal, normal) / 4]))
    c, b = combined(batch, weights).reshape(4, 2, -1).transpose(1, 0, 2)
    energy = ((lengths - batch.fixed) * (c * (lengths + batch.fixed) - 2 * b)).sum()
    slope = 2 * (c * lengths - b)
    f1, f2, f3 = slope[0] * e / lengths[0], slope[1] * a / lengths[1], slope[2] * (a - e) / lengths[2]
    unit = slope[3] * normal / (4 * lengths[3])  # d area = n . d(e x a) / (2 |e x a|)
    return energy, np.stack([f1 - f3 + cross(a, unit), f2 + f3 - cross(e, unit)]).reshape(6, -1)


def evaluate_arap(batch, differences, weights):
    def edges_of(rows):
        spokes = vectors_of(rows)
        rims = np.roll(spokes, -1, axis=0) - spokes
        return np.concatenate([spokes, rims if batch.is_closed else rims[:-1]])

    edges, edges0 = edges_of(differences), edges_of(batch.rows[0])
    growth = (edges ** 2 - edges0 ** 2).sum(axis=1)
    energy, edge_force = 0.0, np.zeros_like(edges)
    for weight, numbers in zip(weights, batch.poses):
        per_edge, sigma0 = numbers[:-1].reshape(len(edges), 4, -1), numbers[-1]
        c, p = per_edge[:, 0], per_edge[:, 1:]
        moments = np.einsum("nie,nje->eij", edges, p)
        left, values, right = np.linalg.svd(moments)
        values[:, 2] *= np.sign(np.linalg.det(left @ right))
        left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
        energy += weight * ((c * growth).sum() - 2 * (values.sum(axis=1) - sigma0).sum())
        edge_force += weight * 2 * (c[:, None] * edges - np.einsum("eij,nje->nie", left @ right, p))
    force = edge_force[:batch.valence].copy()
    for i, rim in enumerate(edge_force[batch.valence:]):
        force[(i + 1) % batch.valence] += rim
        force[i] -= rim
    return energy, force.reshape(3 * batch.valence, -1)


def evaluate_tie(batch, differences, weights):
    def place(rows):
        r, e1, e2 = vectors_of(rows)
        return np.stack([dot(r, e1), dot(r, e2), dot(r, cross(e1, e2))])

    r, e1, e2 = vectors_of(differences)
    kappa, pull = np.split(combined(batch, weights), [1])
    moved = place(differences) - place(batch.rows[0])
    f1, f2, f3 = 2 * kappa * moved + pull
    force = np.stack([f1 * e1 + f2 * e2 + f3 * cross(e1, e2), f1 * r + f3 * cross(e2, r), f2 * r + f3 * cross(r, e1)])
    return (moved * (kappa * moved + pull)).sum(), force.reshape(9, -1)


EVALUATE = {HINGE: evaluate_hinges, NEO_HOOKEAN: evaluate_neo_hookean, STVK: evaluate_stvk, EDGE: evaluate_edge,
            ARAP: evaluate_arap, TIE: evaluate_tie,
            TET_STVK: lambda batch, rows, weights: evaluate_tet_stvk(combined(batch, weights), rows),
            TET_MOONEY_RIVLIN: lambda batch, rows, weights: evaluate_tet_mooney_rivlin(combined(batch, weights), rows)}


def main():
    parser = argparse.ArgumentParser(description="numpy reference of the .pliant format")
    parser.add_argument("asset")
    parser.add_argument("--weights", help="comma-separated, one a pose")
    parser.add_argument("-o", "--output", help="text file, one vertex a line")
    options = parser.parse_args()
    try:
        with open(options.asset, "rb") as file:
            asset = Asset(file.read())
        scene = asset.scene()
    except (OSError, FormatError) as error:
        print(f"{options.asset}: {error}", file=sys.stderr)
        return 3
    print(f"{asset.vertex_count} vertices, {asset.triangle_count} triangles, {asset.pose_count} poses "
          f"({', '.join(asset.names)}), d = {asset.dimension}, "
          + (", ".join(f"{batch.rows.shape[2]} elements of kind {batch.kind}" for batch in asset.batches)
             or f"{asset.quartic.indices.shape[0]} coefficients"))
    print("chunks", *(f"{tag}:{size}" for tag, (_, size) in asset.chunks.items()))
    if scene:
        print(f"scene: {len(scene.parts)} parts, {len(scene.materials)} materials, {len(scene.images)} images")
    if options.weights is None:
        return 0
    weights = np.array([float(text) for text in options.weights.split(",")])
    if len(weights) != asset.pose_count or not (weights >= 0).all() or not weights.sum() > 0:
        print(f"--weights: need {asset.pose_count} numbers >= 0, not all zero", file=sys.stderr)
        return 2
    z, energy = asset.minimise(weights)
    q = asset.coordinates(z)
    print(f"energy {energy:.9g}")
    print("q", *(f"{value:.9g}" for value in q))
    if options.output:
        np.savetxt(options.output, asset.reconstruct(q), fmt="%.9g")
    return 0


if __name__ == "__main__":
    sys.exit(main())
