#include "elastic/parts/rotations.h"

#include "base/mesh/align.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

Eigen::Matrix3d best_rotation(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to)
{
    const Shape a = Eigen::Map<const Shape>(from.data(), from.size()), b = Eigen::Map<const Shape>(to.data(), to.size());
    return best_rigid_motion(a, b, Eigen::VectorXd::Ones(from.cols())).rotation;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix)
{
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, 1);
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs[2] = -1;
    return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

double largest_rotation(const std::vector<Eigen::Matrix3d>& rotations)
{
    double out = 0;
    for (const Eigen::Matrix3d& a : rotations)
        for (const Eigen::Matrix3d& b : rotations) out = std::max(out, Eigen::AngleAxisd(a.transpose() * b).angle());
    return out;
}

Eigen::Vector3d pivot_point(const std::vector<Eigen::Matrix3d>& rotations, const Eigen::Matrix3Xd& centres, double reach)
{
    constexpr double regularisation = 0.01; // about the squared sine of half of those 10 degrees
    Eigen::Matrix3d mean_rotation = Eigen::Matrix3d::Zero(), matrix = regularisation * Eigen::Matrix3d::Identity();
    for (const Eigen::Matrix3d& rotation : rotations) mean_rotation += rotation / double(rotations.size());
    const Eigen::Vector3d mean_centre = centres.rowwise().mean();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < rotations.size(); ++k) {
        const Eigen::Matrix3d off = rotations[k] - mean_rotation;
        matrix += off.transpose() * off / double(rotations.size());
        right -= off.transpose() * (centres.col(Eigen::Index(k)) - mean_centre) / double(rotations.size());
    }
    const Eigen::Vector3d found = matrix.llt().solve(right);
    return found.norm() > reach ? Eigen::Vector3d(reach / found.norm() * found) : found;
}

} // namespace pliant
