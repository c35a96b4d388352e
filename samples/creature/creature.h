// The generator as one function.
#pragma once

#include "types.h"

#include <string>

namespace pliant::creature {

struct NamedShape {
    std::string name; // "rest", "reach", ...
    std::vector<Vec3> points;
};

struct Character {
    std::vector<Face> faces;       // the same for all poses
    std::vector<NamedShape> poses; // the first is "rest"
};

// Builds the character with about `vertex_count` vertices (8,000 to 20,000). Deterministic. Takes seconds.
Character build_character(int vertex_count);

} // namespace pliant::creature
