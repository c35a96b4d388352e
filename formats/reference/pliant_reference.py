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

from pliant_reference_elements import (combined, evaluate_arap, evaluate_edge, evaluate_hinges, evaluate_neo_hookean,
                                       evaluate_stvk, evaluate_tie)
from pliant_reference_layers import (MAX_LAYERS, evaluate_layered_arap, evaluate_layered_hinges,
                                     evaluate_layered_neo_hookean, read_changes, read_ranges)
from pliant_reference_scene import Scene
from pliant_reference_shape import MAX_CLUSTERS, Clusters, Compact, Factored
from pliant_reference_solid import Layout, Quartic, evaluate_tet_mooney_rivlin, evaluate_tet_stvk

IDENTIFIER = bytes([0xAB]) + b"PLIANT" + bytes([0xBB]) + b"\r\n\x1a\n"
REQUIRED = ("SOLV", "TRIS", "NAME", "ANSW", "CERT")
KNOWN = REQUIRED + ("ELEM", "QUAR", "LAYR", "PRED", "LOAD", "REST", "POLY", "VERT", "SMTH", "MRNG", "GLTF", "BASI", "BASC",
                    "BASF", "BNDS")
HINGE, NEO_HOOKEAN, STVK, EDGE, ARAP, TET_STVK, TET_MOONEY_RIVLIN, TIE = range(1, 9)
LAYERED_HINGE, LAYERED_NEO_HOOKEAN, LAYERED_ARAP = range(9, 12)


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
    if kind in (ARAP, LAYERED_ARAP):
        edges = valence + (valence if is_closed else valence - 1)
        return (3 * valence, 0, 4 * edges + 1) if kind == ARAP else (3 * valence, edges, 3 * edges)
    return {HINGE: (9, 2, 2), NEO_HOOKEAN: (6, 4, 5), STVK: (6, 0, 9), EDGE: (6, 4, 8), TET_STVK: (9, 0, 27),
            TET_MOONEY_RIVLIN: (9, 0, 20), TIE: (9, 0, 4), LAYERED_HINGE: (9, 2, 1), LAYERED_NEO_HOOKEAN: (6, 9, 3)}[kind]


class Batch:
    """Elements of one kind: rows [1+d, R, E], fixed [F, E], poses [m, K, E]. Of layers poses[0] are the numbers for v = 0,
    and the others how the layers change them: their sum with the weights w = (1, v) is right for both."""

    def __init__(self, kind, valence, is_closed, rows, fixed, poses):
        self.kind, self.valence, self.is_closed = kind, valence, is_closed
        self.rows, self.fixed, self.poses = rows, fixed, poses


# ------------------------------------------------------------------------------------------------------------ reading --

class Asset:
    layers = None

    def __init__(self, blob, verify=True):
        self.blob = bytes(blob)
        self.read_header()
        self.read_chunk_table()
        if verify:
            self.verify_checksums()
        self.read_solver()
        self.read_layers()
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
                                 (self.triangle_count, 1, 1 << 27), (self.dimension, 1, 256),
                                 (self.pose_count, 2, 1 + MAX_LAYERS)):
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
        require("LAYR" in self.chunks or self.pose_count <= 64, "R05", f"{self.pose_count} poses without LAYR")
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

    def read_layers(self):
        if "LAYR" in self.chunks:
            data, count = self.counted("LAYR", MAX_LAYERS)
            require(self.flags["LAYR"] & 1, "R23", "LAYR without the required flag")
            require(count == self.pose_count - 1, "R23", f"{count} layers of {self.pose_count} poses")
            require("QUAR" not in self.chunks, "R23", "LAYR and QUAR")
            self.layers = read_ranges(data, count, require)

    def read_elements(self):
        data, count = self.counted("ELEM", 64)
        require(len(data) >= 64 + 64 * count, "R09", "records of ELEM")
        self.batches = [self.read_batch(data, 64 + 64 * i, 64 + 64 * count) for i in range(count)]
        size = sum(self.size_of_arrays(*struct.unpack_from("<4I24xQI", data, 64 + 64 * i)) for i in range(count))
        require(size <= len(data) - 64 - 64 * count, "R09", "arrays of ELEM share bytes")

    def size_of_arrays(self, kind, count, valence, is_closed, changes_at, change_count):
        row_count, fixed_count, number_count = shape_of(kind, valence, is_closed)
        pose_count = 1 if self.layers is not None else self.pose_count
        rows = (1 + self.dimension) * row_count + fixed_count + pose_count * number_count
        return 4 * rows * pad16(count) + change_count * (8 + 64 * number_count)

    def read_batch(self, data, at, data_start):
        kind, count, valence, is_closed, rows_at, fixed_at, poses_at = struct.unpack_from("<4I3Q", data, at)
        changes_at, change_count = struct.unpack_from("<QI", data, at + 40)
        has_layers = self.layers is not None
        require(HINGE <= kind <= LAYERED_ARAP, "R09", f"element kind {kind}")
        require(TIE <= kind if has_layers else kind <= TIE, "R23", f"element kind {kind}")
        require(has_layers or (changes_at == 0 and change_count == 0), "R23", "changes without layers")
        require(1 <= count <= 1 << 22, "R05", f"{count} elements")
        require(change_count <= (self.pose_count - 1) * pad16(count) // 16, "R05", f"{change_count} changes")
        if kind in (ARAP, LAYERED_ARAP):
            require(2 <= valence <= 32, "R05", f"valence {valence}")
            require(is_closed == 0 or (is_closed == 1 and valence >= 3), "R14", "is_closed")
        else:
            require(valence == 0 and is_closed == 0, "R14", "valence of a kind without one")
        require(data[at + 52:at + 64] == bytes(12), "R14", "reserved bytes of a batch")
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
                  lanes_of(poses_at, 1 if has_layers else self.pose_count, number_count))
        if kind in (TET_STVK, TET_MOONEY_RIVLIN):
            require((arrays[0][0] == np.eye(3).reshape(9, 1)).all(), "R17",
                    "a tetrahedron that is not the identity at z = 0")
        if has_layers:
            changes = read_changes(data, data_start, changes_at, change_count,
                                   (self.pose_count - 1, number_count, lanes), require)
            arrays = *arrays[:2], np.concatenate([arrays[2], changes])
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
        require(np.isfinite(self.centres).all() and np.isfinite(table).all(), "R10", "PRED")

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
        require(np.isfinite(table).all(), "R13", "ANSW")
        if self.layers is not None:
            require((weights[:, 0] == 1).all(), "R13", "first weight of an answer")
        else:
            require((weights >= 0).all(), "R13", "a negative weight of an answer")
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

    def full_weights(self, weights):
        """w of the SPEC: the weights of an average with sum 1, or (1, v) for weights v of layers."""
        weights = np.asarray(weights, float)
        return weights / weights.sum() if self.layers is None else np.concatenate([[1.0], weights])

    def features(self, weights):
        """What PRED and LOAD are linear in: the cubed distances from the centres, and the weights; of layers their change
        since v = 0."""
        def at(w):
            return np.concatenate([np.linalg.norm(w - self.centres, axis=1) ** 3, w])
        return at(weights) if self.layers is None else at(weights) - at(np.eye(len(weights))[0])

    def predict(self, weights):
        return np.zeros(self.dimension) if self.centres is None else self.features(weights) @ self.coefficients

    def load(self, weights):
        """The dead load c(w)."""
        if self.load_coefficients is None:
            return np.zeros(self.dimension)
        return self.features(weights) @ self.load_coefficients

    def evaluate(self, z, weights):
        """Energy and gradient of the surrogate energy, its load included, for w as of full_weights(); (inf, None) where it
        is not defined."""
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
        """Newton with eigenvalues made positive and Armijo's rule, for weights as a user gives them. Returns z, energy."""
        weights = self.full_weights(weights)
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


EVALUATE = {HINGE: evaluate_hinges, NEO_HOOKEAN: evaluate_neo_hookean, STVK: evaluate_stvk, EDGE: evaluate_edge,
            ARAP: evaluate_arap, TIE: evaluate_tie, LAYERED_HINGE: evaluate_layered_hinges,
            LAYERED_NEO_HOOKEAN: evaluate_layered_neo_hookean, LAYERED_ARAP: evaluate_layered_arap,
            TET_STVK: lambda batch, rows, weights: evaluate_tet_stvk(combined(batch, weights), rows),
            TET_MOONEY_RIVLIN: lambda batch, rows, weights: evaluate_tet_mooney_rivlin(combined(batch, weights), rows)}


def printable(text):
    """For terminals: control characters, which names and tags of a file may hold, as \\x1b."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def main():
    parser = argparse.ArgumentParser(description="numpy reference of the .pliant format")
    parser.add_argument("asset")
    parser.add_argument("--weights", help="comma-separated, one a pose, or one a layer")
    parser.add_argument("-o", "--output", help="text file, one vertex a line")
    options = parser.parse_args()
    try:
        with open(options.asset, "rb") as file:
            asset = Asset(file.read())
        scene = asset.scene()
    except (OSError, FormatError) as error:
        print(printable(f"{options.asset}: {error}"), file=sys.stderr)
        return 3
    print(f"{asset.vertex_count} vertices, {asset.triangle_count} triangles, {asset.pose_count} poses "
          f"({printable(', '.join(asset.names))}), d = {asset.dimension}, "
          + (", ".join(f"{batch.rows.shape[2]} elements of kind {batch.kind}" for batch in asset.batches)
             or f"{asset.quartic.indices.shape[0]} coefficients"))
    print("chunks", *(f"{printable(tag)}:{size}" for tag, (_, size) in asset.chunks.items()))
    for name, (low, high, initial) in zip(asset.names[1:], asset.layers if asset.layers is not None else []):
        print(f"layer {printable(name)}: {low:.6g} .. {high:.6g}, at first {initial:.6g}")
    if scene:
        print(f"scene: {len(scene.parts)} parts, {len(scene.materials)} materials, {len(scene.images)} images")
    if options.weights is None:
        return 0
    try:
        weights = np.array([float(text) for text in options.weights.split(",")])
    except ValueError:
        print("--weights: need numbers with commas between", file=sys.stderr)
        return 2
    if asset.layers is not None:
        if len(weights) != len(asset.layers) or not np.isfinite(weights).all():
            print(f"--weights: need {len(asset.layers)} finite numbers", file=sys.stderr)
            return 2
    elif len(weights) != asset.pose_count or not (weights >= 0).all() or not weights.sum() > 0:
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
