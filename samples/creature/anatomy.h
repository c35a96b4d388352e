// What the character is made of: its parts, their straight axes in the bind shape, and the implicit surface around them.
#pragma once

#include "field.h"

#include <string>

namespace pliant::creature {

// A part has a straight axis in the bind shape, along which poses bend and twist it. Part 0 is the spine; all others are
// rooted in it.
struct Part {
    std::string name; // "spine", "arm.left", ...: what poses call it
    Axis axis;
    double first, last; // axis parameters of both ends; the spine's root, and that of every other part, is parameter 0
    Shape shape;        // the part alone
};

struct Anatomy {
    std::vector<Part> parts;
    Shape skin;                                // all parts, joined and finished
    std::function<double(const Vec3&)> sizing; // relative triangle size: less at face, feet and crest
    Vec3 box_min, box_max;                     // contains the skin with room to spare
};

// The bind shape, about 10 units long: x forward, y left, z up, spine along x, limbs spread.
Anatomy build_anatomy();

} // namespace pliant::creature
