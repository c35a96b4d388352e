#include "base/weights/domain.h"

#include <algorithm>

namespace pliant {

namespace {

constexpr std::size_t kinds_of_mixtures = 6;

std::vector<float> to_floats(const Weights& w)
{
    const Eigen::VectorXf floats = w.cast<float>();
    return { floats.data(), floats.data() + floats.size() };
}

} // namespace

Weights WeightDomain::from(const std::vector<double>& values) const
{
    return is_box() ? layer_weights(values, size_) : normalized_weights(values, size_);
}

Weights WeightDomain::centre() const
{
    return is_box() ? Weights(Weights::Zero(Eigen::Index(size_))) : equal_weights(size_);
}

double WeightDomain::full(std::size_t layer) const
{
    const WeightRange& range = ranges_[layer];
    return range.high >= -range.low ? range.high : range.low;
}

Weights WeightDomain::mixture(Random& random, std::size_t count) const
{
    Weights v = centre();
    for (const std::size_t layer : random.distinct(size_, std::min(count, size_))) {
        const WeightRange& range = ranges_[layer];
        v[Eigen::Index(layer)] = range.low + random.uniform() * (range.high - range.low);
    }
    return v;
}

// Corners with one layer or none are poses, or nearly: they would say nothing.
Weights WeightDomain::corner(Random& random) const
{
    Weights v = centre();
    for (std::size_t layer = 0; layer < size_; ++layer)
        v[Eigen::Index(layer)] = random.uniform() < 0.5 ? ranges_[layer].low : ranges_[layer].high;
    return (v.array() != 0).count() > 1 ? v : mixture(random, 2);
}

Weights WeightDomain::draw(Random& random, std::size_t index) const
{
    if (!is_box()) return mixed_weights(random, size_, index);
    switch (index % kinds_of_mixtures) {
    case 0: return mixture(random, 1);
    case 1: return mixture(random, 2);
    case 4: return mixture(random, size_);
    case 5: return corner(random);
    default: return mixture(random, size_ < 3 ? 1 : 3 + random.below(sparse_limit - 2));
    }
}

std::vector<Weights> WeightDomain::draw_all(std::uint64_t seed, std::size_t count) const
{
    Random random(seed);
    std::vector<Weights> out;
    for (std::size_t i = 0; i < count; ++i) out.push_back(draw(random, i));
    return out;
}

bool WeightDomain::is_counted(const Weights& w) const
{
    return !is_box() || std::size_t((w.array() != 0).count()) <= sparse_limit;
}

std::vector<Weights> WeightDomain::draw_counted(std::uint64_t seed, std::size_t count) const
{
    Random random(seed);
    std::vector<Weights> out;
    for (std::size_t i = 0; out.size() < count; ++i) {
        const Weights w = draw(random, i);
        if (is_counted(w)) out.push_back(w);
    }
    return out;
}

const char* WeightDomain::kind_of(const Weights& w, std::size_t index) const
{
    static const char* const of_averages[] = { "uniform", "edge", "corner" };
    if (!is_box()) return of_averages[size_ == 2 ? 0 : index % 3];
    const std::size_t used = std::size_t((w.array() != 0).count());
    bool is_corner = used > 1;
    for (std::size_t layer = 0; layer < size_; ++layer) {
        const double v = w[Eigen::Index(layer)];
        is_corner = is_corner && (v == ranges_[layer].low || v == ranges_[layer].high);
    }
    if (is_corner) return "corner";
    return used < 2 ? "single" : used == 2 ? "pair" : used <= sparse_limit ? "sparse" : "dense";
}

std::vector<std::vector<float>> WeightDomain::covering(std::size_t count, std::uint64_t seed) const
{
    if (!is_box()) return covering_weights(size_, count, seed);
    std::vector<std::vector<float>> all;
    for (std::size_t layer = 0; layer < size_; ++layer) all.push_back(to_floats(full(layer) * corner_weights(size_, layer)));
    all.push_back(to_floats(centre()));
    for (const Weights& w : draw_all(seed, count)) all.push_back(to_floats(w));
    return all;
}

} // namespace pliant
