#include "base/weights/hermite_interpolation.h"

#include <cmath>

namespace pliant {

namespace {

// |x|^5 with x = a - b and its derivatives. Rows: value and gradient by a; columns: value and gradient by b.
Eigen::MatrixXd kernel(const Eigen::VectorXd& x)
{
    const Eigen::Index p = x.size();
    const double r = x.norm(), cube = 5 * r * r * r;
    Eigen::MatrixXd block(p + 1, p + 1);
    block(0, 0) = std::pow(r, 5);
    block.row(0).tail(p) = -cube * x.transpose();
    block.col(0).tail(p) = cube * x;
    block.bottomRightCorner(p, p) = -15 * r * x * x.transpose();
    block.bottomRightCorner(p, p).diagonal().array() -= cube;
    return block;
}

// All monomials up to the second degree (columns), and their gradients below.
Eigen::MatrixXd monomials(const Eigen::VectorXd& x)
{
    const Eigen::Index p = x.size();
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(p + 1, (p + 1) * (p + 2) / 2);
    out(0, 0) = 1;
    Eigen::Index column = 1;
    for (Eigen::Index a = 0; a < p; ++a) {
        out(0, column) = x[a];
        out(1 + a, column++) = 1;
        for (Eigen::Index b = a; b < p; ++b) {
            out(0, column) = x[a] * x[b];
            out(1 + a, column) += x[b];
            out(1 + b, column++) += x[a];
        }
    }
    return out;
}

} // namespace

// Helmert's: column c moves weight to pose c + 1 from all before it.
Eigen::MatrixXd weight_directions(std::size_t pose_count)
{
    const Eigen::Index m = Eigen::Index(pose_count);
    Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(m, m - 1);
    for (Eigen::Index c = 0; c + 1 < m; ++c) {
        const double k = double(c) + 1, scale = 1 / std::sqrt(k * (k + 1));
        directions.col(c).head(c + 1).setConstant(-scale);
        directions(c + 1, c) = k * scale;
    }
    return directions;
}

HermiteInterpolation::HermiteInterpolation(const std::vector<Weights>& centres)
    : directions_(weight_directions(std::size_t(centres[0].size())))
    , centres_(directions_.cols(), Eigen::Index(centres.size()))
{
    for (std::size_t i = 0; i < centres.size(); ++i) centres_.col(Eigen::Index(i)) = directions_.transpose() * centres[i];
    const Eigen::Index size = directions_.cols() + 1, data = size * centres_.cols();
    const Eigen::Index tail = monomials(centres_.col(0)).cols();
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(data + tail, data + tail);
    for (Eigen::Index i = 0; i < centres_.cols(); ++i) {
        for (Eigen::Index j = 0; j < centres_.cols(); ++j)
            system.block(i * size, j * size, size, size) = kernel(centres_.col(i) - centres_.col(j));
        system.block(i * size, data, size, tail) = monomials(centres_.col(i));
        system.block(data, i * size, tail, size) = system.block(i * size, data, size, tail).transpose();
    }
    system_.compute(system);
}

Eigen::VectorXd HermiteInterpolation::functionals(const Weights& w) const
{
    const Eigen::VectorXd x = directions_.transpose() * w;
    const Eigen::Index size = directions_.cols() + 1;
    Eigen::VectorXd out(system_.rows());
    for (Eigen::Index i = 0; i < centres_.cols(); ++i)
        out.segment(i * size, size) = kernel(x - centres_.col(i)).row(0).transpose();
    out.tail(out.size() - size * centres_.cols()) = monomials(x).row(0).transpose();
    return out;
}

Eigen::MatrixXd HermiteInterpolation::shares(const Weights& w) const
{
    const Eigen::VectorXd all = system_.solve(functionals(w)); // the system is symmetric
    return Eigen::Map<const Eigen::MatrixXd>(all.data(), directions_.cols() + 1, centres_.cols());
}

} // namespace pliant
