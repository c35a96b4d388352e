#include "elastic/average/placement.h"

#include "base/mesh/align.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {
namespace {

// Columns that are orthonormal in the mass inner product and span 1, x, y and z of the frame (n x 4; a flat one has 3).
Eigen::MatrixXd affine_functions(const NormalizedPoses& set)
{
    constexpr double flat = 1e-12; // of squared lengths
    const Eigen::Index n = set.masses.size();
    Eigen::MatrixXd functions(n, 4);
    functions.col(0).setOnes();
    const Eigen::Map<const Positions> frame(set.frame.data(), n, 3);
    const Eigen::RowVector3d centroid = set.masses.transpose() * frame / set.masses.sum();
    functions.rightCols<3>() = frame.rowwise() - centroid; // far from the origin its thickness would be lost
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> gram(functions.transpose() * set.masses.asDiagonal() * functions);
    const Eigen::Vector4d squares = gram.eigenvalues(); // ascending
    const Eigen::Index rank = (squares.array() > flat * squares[3]).count();
    return functions * gram.eigenvectors().rightCols(rank) * squares.tail(rank).cwiseSqrt().cwiseInverse().asDiagonal();
}

// Where a shape is closest to `target` its sum of masses times positions is that of the target, and that of masses times
// target x position is 0 (6 x columns).
Eigen::MatrixXd moments(const Eigen::VectorXd& masses, const Shape& target, const Eigen::MatrixXd& columns)
{
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(6, columns.cols());
    for (Eigen::Index v = 0; v < masses.size(); ++v) {
        out.topRows<3>() += masses[v] * columns.middleRows<3>(3 * v);
        out.bottomRows<3>() += masses[v] * cross_matrix(target.segment<3>(3 * v)) * columns.middleRows<3>(3 * v);
    }
    return out;
}

// Translations and rotations about the origin, to first order.
Eigen::MatrixXd rigid_motions(const Shape& shape)
{
    Eigen::MatrixXd motions(shape.size(), 6);
    for (Eigen::Index i = 0; i < shape.size(); i += 3)
        motions.middleRows<3>(i) << Eigen::Matrix3d::Identity(), -cross_matrix(shape.segment<3>(i));
    return motions;
}

} // namespace

Placement::Placement(const NormalizedPoses& set)
    : set_(set)
{
    if (set.frame.size() > 0) functions_ = affine_functions(set);
}

Eigen::MatrixXd Placement::affine_part(const Eigen::MatrixXd& columns) const
{
    const Eigen::Index n = functions_.rows(), count = functions_.cols();
    const Eigen::MatrixXd weighted = functions_.transpose() * set_.masses.asDiagonal();
    Eigen::MatrixXd part(3 * count, columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c)
        Eigen::Map<Positions>(part.col(c).data(), count, 3)
            = weighted * Eigen::Map<const Positions>(columns.col(c).data(), n, 3);
    return part;
}

Eigen::MatrixXd Placement::flattened(const Eigen::MatrixXd& columns) const
{
    const Eigen::MatrixXd part = affine_part(columns);
    Eigen::MatrixXd out(columns.rows(), columns.cols());
    for (Eigen::Index c = 0; c < columns.cols(); ++c)
        Eigen::Map<Positions>(out.col(c).data(), functions_.rows(), 3)
            = functions_ * Eigen::Map<const Positions>(part.col(c).data(), functions_.cols(), 3);
    return out;
}

void Placement::place(const Weights& w, Shape& shape) const
{
    if (!is_kept()) return align_to(set_, set_.shapes[0], shape);
    apply(best_rigid_motion(flattened(shape), flattened(linear_blend(set_, w)), set_.masses), shape);
}

void Placement::keep(const Weights& w, const Eigen::MatrixXd& directions, const Shape& shape,
                     Eigen::MatrixXd& displacements) const
{
    if (!is_kept()) return keep_aligned(set_, set_.shapes[0], shape, displacements);
    const Shape target = flattened(linear_blend(set_, w)), here = flattened(shape);
    Eigen::MatrixXd target_moves = Eigen::MatrixXd::Zero(shape.size(), directions.cols());
    for (std::size_t k = 0; k < set_.pose_count(); ++k) target_moves += set_.shapes[k] * directions.row(Eigen::Index(k));
    // The sum of masses times target x shape stays 0 while both move.
    const Eigen::MatrixXd wanted
        = moments(set_.masses, here, flattened(target_moves)) - moments(set_.masses, target, flattened(displacements));
    const Eigen::Matrix<double, 6, 6> system = moments(set_.masses, target, rigid_motions(here));
    displacements += rigid_motions(shape) * system.fullPivLu().solve(wanted);
}

} // namespace pliant
