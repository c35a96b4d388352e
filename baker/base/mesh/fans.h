// The faces around a vertex, in the order in which they follow each other.
#pragma once

#include "base/mesh/surface.h"

namespace pliant {

// Faces (centre, ring[i], ring[i + 1]), and (centre, last, first) where the ring is closed. Orientations do not matter.
struct Fan {
    std::uint32_t centre;
    std::vector<std::uint32_t> ring; // at least 2 vertices, all distinct
    bool is_closed = false;          // then at least 3

    std::size_t face_count() const { return ring.size() - (is_closed ? 0 : 1); }
};

// Larger fans come in pieces. One less than the format can have: an asset stores closed rings as open ones, which name
// their first vertex twice.
constexpr std::size_t ring_limit = 31;

// Fans that cover the faces around every vertex, ordered by their centres:
// - a chain of faces that share edges of exactly two faces is one fan, so there is one for every vertex of a manifold, two
//   at a bow-tie vertex, none at a vertex without faces;
// - at an edge of three or more faces every two faces that follow each other around it in `rest` are one fan more at both
//   of its ends;
// - a fan of more than ring_limit vertices is cut into open ones, each of which begins with the last face of the one before.
// Counter-clockwise in the orientation of their first face. No two triangles may have the same vertices.
std::vector<Fan> find_fans(const std::vector<Triangle>& triangles, const Shape& rest);

} // namespace pliant
