#include "elastic/average/pose_sum.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"

namespace pliant {

PoseSum::PoseSum(SolverPool& pool, const Shape& base)
    : pool_(pool)
    , placement_(pool.set())
    , coordinates_(pool.set(), base)
    , rest_(coordinates_.coordinates(pool.set().shapes[0]))
    , changes_(rest_.size(), Eigen::Index(pool.set().pose_count()) - 1)
    , fits_(worker_count())
{
    const NormalizedPoses& set = pool.set();
    for (Eigen::Index k = 0; k < changes_.cols(); ++k)
        changes_.col(k) = (coordinates_.coordinates(set.shapes[std::size_t(k) + 1]) - rest_).cast<float>();
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
    if (placement_.is_kept()) placement_.place(w, shape);
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
