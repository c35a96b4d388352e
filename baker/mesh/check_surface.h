// Is one mesh a surface that has an elastic energy? Connectivity first, then the shape of every pose.
#pragma once

#include "mesh/triangulate.h"
#include "report/diagnostics.h"

namespace pliant {

// Checks the faces of a mesh, positions unseen. Errors: P2201 a face with a repeated vertex, P2203 an edge of three or more faces,
// P2204 neighbours of opposite orientation, P2205 the same face twice, P2207 vertices without a face, P2208 several components
// (parts that touch in single vertices only can turn there freely, so they count as several). Warning: P2206 bow-tie vertices.
void check_connectivity(const MeshFile& mesh, const Triangulation& triangulation, FindingList& findings);

// Checks the positions of one pose. Error: P2202 a triangle without area. Warnings: P2209 coordinates too coarse for the distance
// from the origin, P2210 a polygon whose fan of triangles folds over.
// The verdict depends neither on the unit of length nor on the place: both are removed first.
void check_shape(const MeshFile& mesh, const Triangulation& triangulation, FindingList& findings);

// The part of it that has nothing to do with surfaces: P2209.
void check_precision(const MeshFile& mesh, FindingList& findings);

// Rounding of the coordinates of a pose, in its units: half the distance between neighbouring numbers at the largest coordinate,
// of single precision if every coordinate is exactly a float (then that is where it came from), else of double.
double coordinate_rounding(const Positions& positions);

// Positions moved to the centre of their bounding box and divided by half its longest side; all within [-1, 1]. Safe for any
// finite input.
Positions to_unit_box(const Positions& positions);

// "run.obj:812" for face 377 of a text file, "run.ply" for one of a binary file.
std::string where_is_face(const MeshFile& mesh, std::size_t face);

} // namespace pliant
