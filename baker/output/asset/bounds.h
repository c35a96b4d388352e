// Clusters of vertices whose boxes are known for any coordinates: chunk BNDS of formats/SPEC.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace pliant {

// Of the shapes centre + rest + columns * q (3n rows, input units, the numbers that the asset has). `samples` (d x s):
// blends, for clusters that stay small. Cost: a few passes over some samples of the shape.
std::vector<std::uint8_t> encode_bounds(const Eigen::Vector3d& centre, const Eigen::VectorXd& rest,
                                        const Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples);

} // namespace pliant
