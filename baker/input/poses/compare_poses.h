// Do several meshes show the same character? Pose k against pose 0.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/triangulate.h"

namespace pliant {

// Same number of vertices and the same faces in the same order; a face may start at another corner. Errors: P3003 other
// number of vertices, P3004 other faces, P3005 the same surface with its vertices renumbered. True if the faces are the
// same.
bool check_same_faces(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics);

// The same for solids: the same tetrahedra in the same order; one may be numbered from another corner, but not the other way
// round. The same errors, and P3012 if one is a solid and the other a surface.
bool check_same_tets(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics);
bool check_same_kind(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics);

// Warning P3015 if the other has materials that the first one has not. The tetrahedra must be the same.
void check_same_materials(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics);

// Same number of vertices, else P3003.
bool check_same_vertex_count(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics);

// Do vertices of equal number lie on equal places of the character? Errors: P3006 they do not, P3007 mirror image, P3008
// another unit of length. Warnings: P3011 perhaps a mirror image, P3014
// inside out for a large part. The faces must be the same and have areas. Of solids the boundary is looked at.
void check_correspondence(const MeshFile& first, const MeshFile& other, const Triangulation& triangulation,
                          DiagnosticList& diagnostics);

// Poses that differ by nothing but rounding; with `align` also by nothing but a rigid motion. Error P3009 if all are the
// same, warning P3010 for every pose that repeats an earlier one.
void check_distinct(const std::vector<MeshFile>& poses, const Triangulation& triangulation, bool align,
                    DiagnosticList& diagnostics);

} // namespace pliant
