// The shape of one pose of a surface: its triangles, its coordinates.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/triangulate.h"

namespace pliant {

// A triangle that has no area in a pose: flat, or too small against the others for an energy in double precision.
struct FlatTriangle {
    std::uint32_t triangle;
    double height, edge; // over the longest edge, which has this length; in the units of the file
};

// In the order of the triangles. The verdict depends neither on the unit of length nor on the place: both are removed first.
std::vector<FlatTriangle> find_flat_triangles(const MeshFile& mesh, const std::vector<Triangle>& triangles);

// Checks the positions of one pose. Warnings: P2209 too far from the origin for single precision, P2210 a polygon
// whose fan of triangles folds over.
void check_shape(const MeshFile& mesh, const Triangulation& triangulation, DiagnosticList& diagnostics);

// The part of it that looks at polygons: P2210.
void check_polygons(const MeshFile& mesh, const Triangulation& triangulation, DiagnosticList& diagnostics);

// The part of it that has nothing to do with surfaces: P2209.
void check_precision(const MeshFile& mesh, DiagnosticList& diagnostics);

// Rounding of the coordinates of a pose, in its units: half the distance between neighbouring numbers at the largest
// coordinate, of single precision if every coordinate is exactly a float (then that is where it came from), else of double.
double coordinate_rounding(const Positions& positions);

// Positions moved to the centre of their bounding box and divided by half its longest side; all within [-1, 1]. Safe for any
// finite input.
Positions to_unit_box(const Positions& positions);

// "run.obj:812" for face 377 of a text file, "run.ply" for one of a binary file.
std::string where_is_face(const MeshFile& mesh, std::size_t face);

} // namespace pliant
