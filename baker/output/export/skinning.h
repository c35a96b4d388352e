// Linear blend skinning that comes closest to given shapes: weights and rigid bones, by smooth skinning decomposition (Le,
// Deng: Smooth skinning decomposition with rigid bones, ACM Transactions on Graphics 31 (6), 2012).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

constexpr std::size_t max_influences = 4; // of a vertex: what JOINTS_0 and WEIGHTS_0 hold

struct BoneMotion {
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();

    Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
};

// Where all bones are in one shape: takes the rest pose there.
using BonePose = std::vector<BoneMotion>;

struct Influences {
    std::array<std::uint16_t, max_influences> bones {};
    std::array<double, max_influences> weights {}; // >= 0, sum 1
};

struct Skin {
    Eigen::Matrix3Xd rest;
    std::vector<Influences> influences; // per vertex
    std::size_t bone_count = 0;

    Eigen::Matrix3Xd shape(const BonePose& pose) const;
    Eigen::Vector3d centre(std::size_t bone) const; // of what it moves, at rest
};

struct SkinFit {
    Skin skin;
    std::vector<BonePose> poses; // per shape
};

// Bones found by splitting clusters of vertices that move alike, then rounds of bones and weights. Fewer bones than asked
// for where the mesh has too few vertices. Deterministic. Cost: O(rounds * n * shapes * bones).
SkinFit fit_skin(const Eigen::Matrix3Xd& rest, const std::vector<Eigen::Matrix3Xd>& shapes, std::size_t bone_count);

// The bones of another shape for the skin as it is, starting from `start`. Cost: O(n) a sweep, some ten sweeps.
BonePose fit_bones(const Skin& skin, const Eigen::Matrix3Xd& shape, BonePose start);

} // namespace pliant
