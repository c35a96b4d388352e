// Cells of a body (triangles of a surface, tetrahedra of a solid), and the shape that fits what they are to do.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/average/sparse_cholesky.h"

#include <Eigen/LU>
#include <limits>

namespace pliant {

template <std::size_t Corners> using Cell = std::array<std::uint32_t, Corners>;

// A collapsed cell says nothing about its rotation: what dual() adds of the trace.
constexpr double collapsed_cell = 1e-6;

// The most_weight of a CellFit for interpolated coordinates: the rotations of slivers are hardly ever interpolated well.
constexpr double sliver_weight = 2;

// Turns about the vector by its length.
Eigen::Matrix3d rotation_by(const Eigen::Vector3d& vector);

// Corner 0 to the others, as columns.
template <std::size_t Corners>
Eigen::Matrix<double, 3, int(Corners) - 1> edges_of(const Shape& shape, const Cell<Corners>& cell)
{
    Eigen::Matrix<double, 3, int(Corners) - 1> edges;
    for (std::size_t i = 1; i < Corners; ++i) edges.col(Eigen::Index(i) - 1) = point(shape, cell[i]) - point(shape, cell[0]);
    return edges;
}

// Rows: gradients of the coordinates along the edges. The Gram matrix is regularized by a part of its trace, for collapsed
// cells.
template <int Edges>
Eigen::Matrix<double, Edges, 3> dual(const Eigen::Matrix<double, 3, Edges>& edges, double regularization)
{
    Eigen::Matrix<double, Edges, Edges> gram = edges.transpose() * edges;
    gram.diagonal().array() += regularization * gram.trace() + 1e-300;
    return gram.inverse() * edges.transpose();
}

// Moves vertices such that the edges of all cells change as nearly as they can by what is asked for (least squares, weights
// are cotangents). Fixed vertices stay; each free part keeps its centroid. One for each thread.
class CellFit {
public:
    // The set must outlive it. most_weight: no edge weighs more than this many times the median. Without it slivers, whose
    // cotangents are large, decide where their neighbours go.
    CellFit(const NormalizedPoses& set, SolverKind kind, double most_weight = std::numeric_limits<double>::infinity());

    // changes: of the edges from corner 0 of cell 0, of cell 1 ... (columns; 2 a triangle, 3 a tetrahedron).
    // Cost: a solve with one unknown per vertex.
    Shape operator()(const Shape& shape, const Eigen::Matrix3Xd& changes) const;

private:
    const NormalizedPoses& set_;
    std::vector<double> weights_; // of the edges of cell 0, of cell 1 ...: 3 a triangle, 6 a tetrahedron
    SparseCholesky laplacian_;
};

} // namespace pliant
