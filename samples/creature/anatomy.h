// The parts of the character, their straight axes in the bind shape, and the implicit surface around them.
#pragma once

#include "field.h"

#include <string>

namespace pliant::creature {

// A part with a straight axis in the bind shape, along which poses bend and twist it. Part 0 is the spine; all other
// parts are attached to it.
struct Part {
    std::string name; // "spine", "arm.left", ...: used by poses
    Axis axis;
    double first, last; // axis parameters of both ends; the root of every part is at parameter 0
    Shape shape;        // the part alone
};

struct Anatomy {
    std::vector<Part> parts;
    Shape skin;                                // all parts joined, with the face cut in
    std::function<double(const Vec3&)> sizing; // relative triangle size: smaller at face, feet and crest
    Vec3 box_min, box_max;                     // contains the skin with a margin
};

// The bind shape, about 10 units long: x forward, y left, z up, spine along x, limbs spread.
Anatomy build_anatomy();

} // namespace pliant::creature
