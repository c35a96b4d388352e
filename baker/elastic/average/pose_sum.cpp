#include "elastic/average/pose_sum.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "elastic/average/rigid_modes.h"

namespace pliant {

PoseSum::PoseSum(SolverPool& pool, const Shape& base)
    : pool_(pool)
    , coordinates_(pool.set(), base)
    , rest_(coordinates_.coordinates(pool.set().shapes[0]))
    , changes_(rest_.size(), Eigen::Index(pool.set().pose_count()) - 1)
    , fits_(worker_count())
{
    const NormalizedPoses& set = pool.set();
    if (set.is_free()) modes_ = times_mass(rigid_modes(set.shapes[0], set.masses), set.masses);
    for (Eigen::Index k = 0; k < changes_.cols(); ++k)
        changes_.col(k) = (coordinates_.coordinates(set.shapes[std::size_t(k) + 1]) - rest_).cast<float>();
}

// Newton's method in the six numbers of a rigid motion, from where the shape is closest.
void PoseSum::place(const Weights& v, Shape& shape) const
{
    constexpr int steps = 6;
    const NormalizedPoses& set = pool_.set();
    const Shape target = linear_blend(set, v);
    align_to(set, target, shape);
    for (int step = 0; step < steps && modes_.cols() > 0; ++step) {
        const Eigen::Matrix<double, 6, 1> off = modes_.transpose() * (target - shape);
        if (off.norm() < 1e-14) return;
        Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(shape.size(), 6);
        for (Eigen::Index i = 0; i < shape.size(); i += 3) {
            motions.block<3, 3>(i, 0).setIdentity();
            motions.block<3, 3>(i, 3) = -cross_matrix(shape.segment<3>(i));
        }
        const Eigen::Matrix<double, 6, 6> system = modes_.transpose() * motions;
        const Eigen::Matrix<double, 6, 1> move = system.fullPivLu().solve(off);
        const Eigen::Matrix3d turn = rotation_by(move.tail<3>());
        for (Eigen::Index i = 0; i < shape.size(); i += 3)
            shape.segment<3>(i) = (turn * shape.segment<3>(i) + move.head<3>()).eval();
    }
}

Shape PoseSum::turned(const Weights& w, std::size_t worker) const
{
    const Weights shares = linear_shares(w, pool_.set().pose_count());
    Eigen::VectorXd sum = rest_;
    for (Eigen::Index k = 0; k < changes_.cols(); ++k)
        if (shares[k + 1] != 0) sum += shares[k + 1] * changes_.col(k).cast<double>();
    std::unique_ptr<CellFit>& fit = fits_[worker];
    if (!fit) fit = std::make_unique<CellFit>(pool_.set(), pool_.kind(), sliver_weight);
    Shape shape = coordinates_.shape(sum, *fit);
    if (pool_.energy().blend() == Blend::layers) place(w, shape);
    return shape;
}

// Far outside of what the poses do strains turn cells inside out: no energy is finite there, and the comparison takes the
// linear sum.
Shape PoseSum::guess(const Weights& w, const Shape& turned, const Shape* correction) const
{
    Shape best = linear_blend(pool_.set(), w);
    double energy = energy_value(pool_.energy(), w, best);
    const auto try_shape = [&](const Shape& shape) {
        const double other = energy_value(pool_.energy(), w, shape);
        if (!(other < energy)) return;
        best = shape;
        energy = other;
    };
    try_shape(turned);
    if (correction) try_shape(turned + *correction);
    return best;
}

} // namespace pliant
