// Poses of the character, as data.
#pragma once

#include <string>
#include <vector>

namespace pliant::creature {

// One bend of a part. From parameter `from` to parameter `to`, the axis follows a rounded arc that turns it by `side`
// degrees towards its side direction and by `up` degrees towards its up direction, and the cross-sections rotate by
// `twist` degrees about the axis, from side towards up. Directions are those of the untwisted, rotation-minimising frame,
// so a twist does not change the direction of later bends.
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
