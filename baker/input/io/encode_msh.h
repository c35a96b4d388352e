// Gmsh's format as Pliant writes it.
#pragma once

#include "base/mesh/pose_set.h"

#include <string>

namespace pliant {

// A Gmsh file of version 2.2, ASCII, in memory: vertices and tetrahedra in the order given, every double exactly.
std::string encode_msh(const Positions& positions, const std::vector<Tetrahedron>& tets);

} // namespace pliant
