// What an asset stores of a subspace: rest positions and basis in coordinates of its own, the basis in small factors,
// bounding boxes.
#pragma once

#include "base/mesh/embedding.h"
#include "reduced/subspace/subspace.h"

#include <cstdint>
#include <vector>

namespace pliant {

// Coordinates of the asset: q = offset + axes * stored.
struct Frame {
    Eigen::VectorXd offset; // d
    Eigen::MatrixXd axes;   // d x d, orthonormal

    Eigen::VectorXd stored(const Eigen::VectorXd& q) const { return axes.transpose() * (q - offset); }
    Eigen::VectorXd coordinates(const Eigen::VectorXd& stored) const { return offset + axes * stored; }
};

// The frame that changes nothing.
Frame plain_frame(Eigen::Index dimension);

// The principal axes of `reachable` (d x samples), those first along which a vertex moves furthest, around the middle of its
// box; of the poses' box if that is far from them.
Frame principal_frame(const Subspace& subspace, const Eigen::MatrixXd& reachable);

struct StoredShape {
    Frame frame;
    Eigen::VectorXd rest; // 3 x vertices: the shape at the frame's offset, relative to the set's, normalized units
    // Chunk BASF, which has the rest positions in it; empty: BASI in single precision is smaller, or the only one that is
    // exact enough
    std::vector<std::uint8_t> basis;
    std::vector<std::uint8_t> bounds; // chunk BNDS
    double largest_error = 0; // of a vertex by fewer bits, over `reachable` made wider by reach_margin; normalized units
};

// Blends are kept to the error within this many times their box's middle: weights in between training weights.
constexpr double reach_margin = 1.05;

// The basis so that no vertex is off by more than `error` (normalized units) at any of the coordinates `reachable` (d x
// samples), hence nowhere in their convex hull, made wider by reach_margin. error = 0: as it is. `embedding`: of what is
// drawn, or null. `boundary_count`: vertices from there on are inside a solid and seldom rebuilt. Cost: some ten products of
// the basis with `reachable`.
StoredShape store_shape(const NormalizedPoses& set, const Subspace& subspace, const Embedding* embedding,
                        const Eigen::MatrixXd& reachable, double error, std::size_t boundary_count);

} // namespace pliant
