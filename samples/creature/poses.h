// The five poses of the character, as data.
#pragma once

#include <string>
#include <vector>

namespace pliant::creature {

// One bend of a part: between the parameters `from` and `to` of its axis the axis turns, along a rounded arc, by `side`
// degrees towards its side direction and by `up` degrees towards its up direction, and the cross-sections turn by `twist`
// degrees about the axis, counted from side to up, on the way from `from` to `to`. Directions are those of the untwisted,
// rotation-minimising frame, so twist does not deflect the bends behind it.
struct Bend {
    std::string part;
    double from, to;
    double side, up, twist;
};

struct Pose {
    std::string name;
    double pitch, roll, yaw; // of the whole body about the root, in degrees
    std::vector<Bend> bends;
};

// The five poses of the character; the first is "rest".
std::vector<Pose> character_poses();

} // namespace pliant::creature
