// The affine subspace y = tau + U q in which the runtime blends.
#pragma once

#include "base/mesh/align.h"
#include "elastic/average/family.h"

namespace pliant {

struct Subspace {
    Shape rest;                       // tau = pose 0 (3n)
    Eigen::MatrixXd basis;            // U (3n x d), orthonormal in the mass inner product
    Eigen::MatrixXd pose_coordinates; // d x m: pose k is exactly rest + basis * column k

    Eigen::Index dimension() const { return basis.cols(); }
    Shape shape(const Eigen::VectorXd& q) const { return rest + basis * q; }
};

// Spans the differences x_k - x_0, exactly and always, and of the rest of `vectors` (3n x r) the leading directions: all
// vectors are scaled to unit mass norm, what the differences span already is taken out, and a singular value decomposition
// orders what is left. Directions below 1e-9 are rounding and dropped. At most `max_dimension` columns in all.
Subspace build_subspace(const NormalizedPoses& set, const Eigen::MatrixXd& vectors, Eigen::Index max_dimension);

// The same with the first `dimension` columns only (at least as many as there are differences).
Subspace leading(const Subspace& subspace, Eigen::Index dimension);

// Coordinates of the shape's projection onto the subspace.
Eigen::VectorXd project(const Subspace& subspace, const Shape& shape, const Eigen::VectorXd& masses);

// How far the references lie from the subspace, relative L2: no surrogate energy brings blends nearer.
struct SubspaceError {
    double mean = 0, largest = 0;
};
SubspaceError subspace_error(const Subspace& subspace, const NormalizedPoses& set, const std::vector<CheckPoint>& checks);

} // namespace pliant
