// The types that all stages of the generator share.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace pliant::creature {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Face = std::array<std::int32_t, 3>;

// A closed triangle mesh; faces are counter-clockwise seen from outside.
struct Mesh {
    std::vector<Vec3> points;
    std::vector<Face> faces;
};

} // namespace pliant::creature
