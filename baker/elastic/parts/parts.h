// The parts of a surface.
#pragma once

#include "base/mesh/shape_set.h"

namespace pliant {

// A part is all faces that can be reached across hinges, with their vertices; a vertex in which two parts touch belongs to both. A
// vertex without a face is a part of its own.
struct Parts {
    std::vector<std::vector<std::uint32_t>>
        vertices;                       // per part, ascending; in the order of their lowest face, single vertices last
    std::size_t surface_count = 0;      // leading parts with faces
    std::vector<std::uint32_t> of_face; // per face

    std::size_t count() const { return vertices.size(); }
};

Parts find_parts(const ShapeSet& set);

constexpr std::size_t no_part = ~std::size_t(0);

} // namespace pliant
