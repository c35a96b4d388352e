// Reading mesh files, strictly. Surfaces: OBJ, PLY (ASCII, binary little- and big-endian) and OFF. Solids of tetrahedra:
// Gmsh (2.2 and 4.1, ASCII and binary), MEDIT (text), Vega (text), VTK (legacy unstructured grids, ASCII and binary).
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

#include <optional>
#include <string>

namespace pliant {

// Reads one mesh file; the extension says the format and the content must agree with it.
//
// What is kept: every vertex in the order of the file, coordinates as the nearest double, faces with all their corners. What
// is skipped: texture coordinates, normals, colours, materials, groups, further elements and properties. Accepted
// everywhere: any line end, a byte order mark, a missing final newline, any locale. Of solids: the vertices in the order of
// the file, the tetrahedra with four corners, and a Vega file's materials; elements of fewer dimensions are left out with a
// warning (P2115).
//
// Nothing is guessed or repaired: whatever else stands in the file is an error, and counts are compared with the size of the
// file before memory is taken. Time and memory are proportional to the size of the file, hostile content included.
// Throws Failure (bad_input) with everything wrong with the file, numbers P20xx (the file) and P21xx (its content).
// Thread-safe.
MeshFile read_mesh(const std::string& path);

// The same for many files: diagnostics are added to the list, and the result is empty if there was an error among them.
std::optional<MeshFile> read_mesh(const std::string& path, DiagnosticList& diagnostics);

// The same for bytes in memory; `path` is the name of messages, and its extension says the format.
std::optional<MeshFile> parse_mesh(const std::string& path, std::string bytes, DiagnosticList& diagnostics);

} // namespace pliant
