#include "elastic/average/warp.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

namespace pliant {

namespace {

// The gradient of the displacement; of a triangle with the normal part that keeps the normal a normal.
template <int Edges>
Eigen::Matrix3d gradient_of(const Eigen::Matrix<double, 3, Edges>& edges, const Eigen::Matrix<double, 3, Edges>& change)
{
    Eigen::Matrix3d gradient = change * dual(edges, collapsed_cell);
    if constexpr (Edges == 2) {
        const Eigen::Vector3d normal = edges.col(0).cross(edges.col(1)).normalized();
        gradient -= (gradient.transpose() * normal).eval() * normal.transpose();
    }
    return gradient;
}

// 1 + S where that stretches; exp(S) along the axes that shrink, so that no cell is asked to collapse.
Eigen::Matrix3d stretch_of(const Eigen::Matrix3d& strain)
{
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(strain);
    const Eigen::Vector3d stretches
        = eigen.eigenvalues().unaryExpr([](double value) { return value < 0 ? std::exp(value) : 1 + value; });
    return eigen.eigenvectors() * stretches.asDiagonal() * eigen.eigenvectors().transpose();
}

// Rotation times stretch, less 1 + gradient: of second order whatever the cell. W: the skew part of the gradient, S: the
// symmetric one; the rotation is exp(W).
Eigen::Matrix3d beyond_first_order(const Eigen::Matrix3d& gradient)
{
    const Eigen::Matrix3d skew = 0.5 * (gradient - gradient.transpose()), strain = gradient - skew;
    const Eigen::Matrix3d rotation = rotation_by({ skew(2, 1), skew(0, 2), skew(1, 0) });
    return rotation * stretch_of(strain) - Eigen::Matrix3d::Identity() - gradient;
}

template <std::size_t Corners>
Eigen::Matrix3Xd changes_beyond(const std::vector<Cell<Corners>>& cells, const Shape& y, const Shape& step)
{
    constexpr int edges = int(Corners) - 1;
    Eigen::Matrix3Xd changes(3, edges * Eigen::Index(cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto before = edges_of(y, cells[i]), change = edges_of(step, cells[i]);
        changes.middleCols<edges>(edges * Eigen::Index(i)) = beyond_first_order(gradient_of(before, change)) * before;
    }
    return changes;
}

} // namespace

Shape Warp::operator()(const Shape& y, const Shape& step) const
{
    return fit_(y + step, set_.is_solid() ? changes_beyond(set_.tets, y, step) : changes_beyond(set_.triangles, y, step));
}

} // namespace pliant
