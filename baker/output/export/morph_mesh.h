// An asset as the mesh that engines draw: rows of its reduced space, and the same as morph targets with weights in [0,1].
#pragma once

#include "output/asset/reachable.h"
#include "output/export/normals.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

// What is drawn, in input units: y(q) = at_zero + columns q. Of a solid the boundary.
struct DrawnSpace {
    std::string path;                     // of the asset, for messages
    std::vector<std::uint32_t> triangles; // three corners each
    std::vector<std::uint32_t> groups;    // of vertices that share a normal (SMTH), any numbers; empty: each has its own
    Eigen::VectorXd at_zero;              // 3n: q = 0
    Eigen::VectorXf first_pose;           // q of pose 0
    Eigen::MatrixXd columns;              // 3n x d

    std::size_t vertex_count() const { return std::size_t(at_zero.size() / 3); }
    Eigen::VectorXd shape(const Eigen::VectorXf& q) const { return at_zero + columns * q.cast<double>(); }
    Eigen::VectorXd rest() const { return shape(first_pose); } // 3n: pose 0
};

// Asks the runtime for the shapes of unit coordinates, whatever the asset's encoding of the basis. Cost: d + 1
// reconstructions. `path` is for the message. Throws Failure (bad_input, P5102) where a shape is not finite or beyond 1e18.
DrawnSpace drawn_space(const RuntimeBlender& blender, const std::string& path);

// Unit normals (3n) of a shape (3n).
Eigen::VectorXd drawn_normals(const DrawnSpace& space, const Eigen::VectorXd& shape);

struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = Eigen::Vector3d::Constant(-1e300);

    void include(const Eigen::VectorXd& positions);                                          // 3n
    Eigen::VectorXd corners() const { return (Eigen::VectorXd(6) << low, high).finished(); } // as two positions
    double diagonal() const { return (high - low).norm(); }
};

struct MorphMesh {
    MorphRanges ranges;
    bool has_stored_ranges = false; // from the asset, so that pliant_morph_weights uses the same
    Eigen::VectorXf base;           // 3n: the shape of weights 0
    Eigen::MatrixXf deltas;         // 3n x d
    Eigen::MatrixXf fitted, judged; // weights of blends (d x blends): to fit to, and others that only judge
    Eigen::MatrixXf poses;          // those of the poses
    Eigen::MatrixXf frames;         // those of the animation, whose weights may leave the ranges
    Box reachable;                  // of all these shapes, with a margin
    NormalFit::Result normals;      // empty without normals
    NormalError normal_error;       // over the judged blends

    Eigen::VectorXf weights(const Eigen::VectorXf& q) const; // as pliant_morph_weights, to the bit
    // 3n x blends, of weights (d x blends).
    Eigen::MatrixXd shapes(const Eigen::MatrixXf& weights) const;
};

// Calls use(first, count) for all blends in turn: as many at once as matrices of `rows` rows should have, since matrix
// products of several columns need far less of the memory's time.
template <class Use> void for_each_batch(Eigen::Index rows, Eigen::Index blend_count, const Use& use)
{
    constexpr Eigen::Index most_numbers = 1 << 23, most_blends = 64;
    const Eigen::Index batch = std::clamp<Eigen::Index>(most_numbers / rows, 1, most_blends);
    for (Eigen::Index first = 0; first < blend_count; first += batch) use(first, std::min(batch, blend_count - first));
}

// Throws Failure (bad_input, P5102) naming `path` unless all are numbers that a glTF file can hold and an engine use.
void require_usable_weights(const Eigen::MatrixXf& weights, const std::string& path);

// Fits. `path`: coordinates of the animation, d x frames. Cost: (8 d + 300) shapes, with their normals if these are wanted,
// the solves for them, and a shape for each frame.
MorphMesh make_morph_mesh(RuntimeBlender& blender, const DrawnSpace& space, const Eigen::MatrixXf& path, bool with_normals);

// Of the judged blends.
NormalError normal_error_of(const NormalFit::Result& normals, const MorphMesh& mesh, const DrawnSpace& space);

} // namespace pliant
