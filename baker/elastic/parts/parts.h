// The connected parts of a surface.
#pragma once

#include "base/mesh/normalized_poses.h"

namespace pliant {

// A part is a set of faces connected across hinges (edges of two faces), with their vertices. A vertex in which two parts
// touch belongs to both. A vertex without a face is a part of its own.
struct Parts {
    // Per part, ascending. Parts are in the order of their lowest face; single vertices come last.
    std::vector<std::vector<std::uint32_t>> vertices;
    std::size_t surface_count = 0;      // number of parts with faces; they come first
    std::vector<std::uint32_t> of_face; // the part of each face

    std::size_t count() const { return vertices.size(); }
};

// Cost: nearly linear in the number of faces.
Parts find_parts(const NormalizedPoses& set);

constexpr std::size_t no_part = ~std::size_t(0);

} // namespace pliant
