#include "elastic/average/layer_sum.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"

namespace pliant {

LayerSum::LayerSum(SolverPool& pool)
    : pool_(pool)
    , coordinates_(pool.set(), pool.set().shapes[0])
    , rest_(coordinates_.coordinates(pool.set().shapes[0]))
    , changes_(rest_.size(), Eigen::Index(pool.set().pose_count()) - 1)
    , fits_(worker_count())
{
    for (Eigen::Index k = 0; k < changes_.cols(); ++k)
        changes_.col(k) = (coordinates_.coordinates(pool.set().shapes[std::size_t(k) + 1]) - rest_).cast<float>();
}

Shape LayerSum::linear(const Weights& v) const
{
    const NormalizedPoses& set = pool_.set();
    Shape sum = set.shapes[0];
    for (Eigen::Index k = 0; k < v.size(); ++k)
        if (v[k] != 0) sum += v[k] * (set.shapes[std::size_t(k) + 1] - set.shapes[0]);
    return sum;
}

void LayerSum::place(const Weights& v, Shape& shape) const { align_to(pool_.set(), linear(v), shape); }

Shape LayerSum::turned(const Weights& v, std::size_t worker) const
{
    Eigen::VectorXd sum = rest_;
    for (Eigen::Index k = 0; k < v.size(); ++k)
        if (v[k] != 0) sum += v[k] * changes_.col(k).cast<double>();
    std::unique_ptr<CellFit>& fit = fits_[worker];
    if (!fit) fit = std::make_unique<CellFit>(pool_.set(), pool_.kind(), sliver_weight);
    Shape shape = coordinates_.shape(sum, *fit);
    place(v, shape);
    return shape;
}

// Far outside of what the poses do strains turn cells inside out: no energy is finite there, and the comparison takes the
// linear sum.
Shape LayerSum::guess(const Weights& v, const Shape& turned, const Shape* correction) const
{
    Shape best = linear(v);
    double energy = energy_value(pool_.energy(), v, best);
    const auto try_shape = [&](const Shape& shape) {
        const double other = energy_value(pool_.energy(), v, shape);
        if (!(other < energy)) return;
        best = shape;
        energy = other;
    };
    try_shape(turned);
    if (correction) try_shape(turned + *correction);
    return best;
}

} // namespace pliant
