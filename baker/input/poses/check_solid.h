// Is a mesh of tetrahedra a solid that has an elastic energy? Volumes first, then what hangs together with what.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

namespace pliant {

// Some programs number the corners of a tetrahedron the other way round. If all tetrahedra of the first mesh are of that
// kind, those of all meshes are turned, alike. Warning P2214.
void orient_tets(std::vector<MeshFile>& meshes, DiagnosticList& diagnostics);

// Checks the volumes in one pose. Errors: P2212 a tetrahedron with practically none, P2213 an inverted one. Warning: P2209
// coordinates too coarse for the distance from the origin. The verdict depends neither on the unit of length nor on the
// place. first: null for the first pose; if every tetrahedron of another one is inverted, it is mirrored against that:
// P3007. True if all volumes are positive.
bool check_volumes(const MeshFile& mesh, const MeshFile* first, DiagnosticList& diagnostics);

// Checks the tetrahedra of a mesh, positions unseen. Errors: P2207 vertices that no tetrahedron uses, P2208 several
// components (parts that share no face can turn against each other freely), P2211 a tetrahedron with a repeated vertex,
// P2215 the same tetrahedron twice, P2216 a face of three or more, P2218 two on the same side of their face (unless volumes
// were found to be wrong, which explains it). Warning: P2217 the boundary touches itself.
void check_tets(const MeshFile& mesh, bool has_good_volumes, DiagnosticList& diagnostics);

// Warning P3016 if the stiffest material that is used is so much stiffer than the softest that bakes miss their tolerance.
void check_stiffness(const MeshFile& mesh, DiagnosticList& diagnostics);

// "rod.msh:812" for tetrahedron 377 of a text file, "rod.msh" for one of a binary file.
std::string where_is_tet(const MeshFile& mesh, std::size_t tet);

// "3 8 1 5": the corners of a tetrahedron.
std::string corners_of(const Tetrahedron& tet);

} // namespace pliant
