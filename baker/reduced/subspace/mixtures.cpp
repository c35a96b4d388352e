#include "reduced/subspace/mixtures.h"

#include "base/common/parallel.h"
#include "base/weights/radial_function.h"
#include "elastic/average/rigid_modes.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>

namespace pliant {

namespace {

// Of the displacements of two layers. With less in common their sum is linear.
constexpr double least_overlap = 1e-3;

// In multiples of the median.
constexpr double largest_score = 4;

// A wave is explained if its shapes lay this near to the span of those before it, in tolerances.
constexpr double mean_in_span = 0.35, largest_in_span = 1.5;

constexpr std::size_t least_wave = 12;

// Mixtures of each kind, and shapes that are found at most: so many at least, and so many for each layer.
struct Count {
    double least, each;
    std::size_t of(std::size_t layers) const { return std::size_t(least + each * double(layers)); }
};
constexpr std::size_t corner_count = 24;
constexpr Count pair_count { 16, 1.5 }, sparse_count { 64, 2 }, dense_count { 8, 0.25 }; // of layers
constexpr Count average_count { 64, 8 };                                                 // of averages
constexpr Count shape_count { 64, 3 };

// Before so many shapes are known no wave is explained.
constexpr double least_share = 0.5;

// One of so many mixtures of a wave is the next in the list, whatever its score: these say how well others are explained.
constexpr std::size_t unbiased_one_of = 3;

// How much two layers move the same vertices, 0 to 1 (L x L).
Eigen::MatrixXd overlaps_of(const NormalizedPoses& set)
{
    const Eigen::Index layers = Eigen::Index(set.pose_count()) - 1, vertices = set.dof_count() / 3;
    Eigen::MatrixXd lengths(vertices, layers);
    for (Eigen::Index k = 0; k < layers; ++k) {
        const Shape moved = set.shapes[std::size_t(k) + 1] - set.shapes[0];
        lengths.col(k) = Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, vertices).colwise().norm().transpose();
        lengths.col(k).array() *= set.masses.array().sqrt();
        lengths.col(k) /= std::max(lengths.col(k).norm(), 1e-300);
    }
    return lengths.transpose() * lengths;
}

struct Pair {
    double overlap;
    Eigen::Index a, b;
};

// Those with the most in common first.
std::vector<Pair> overlapping_pairs(const Eigen::MatrixXd& overlaps, std::size_t count)
{
    std::vector<Pair> pairs;
    for (Eigen::Index b = 0; b < overlaps.cols(); ++b)
        for (Eigen::Index a = 0; a < b; ++a)
            if (overlaps(a, b) > least_overlap) pairs.push_back({ overlaps(a, b), a, b });
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) { return x.overlap > y.overlap; });
    pairs.resize(std::min(pairs.size(), count));
    return pairs;
}

// The layer that has most in common with both of a pair.
Eigen::Index third_of(const Pair& pair, const Eigen::MatrixXd& overlaps)
{
    Eigen::VectorXd common = overlaps.col(pair.a).cwiseMin(overlaps.col(pair.b));
    common[pair.a] = common[pair.b] = -1;
    Eigen::Index third = 0;
    common.maxCoeff(&third);
    return third;
}

// Halves, and the ends of the range at which the shape is not one of the poses.
void append_singles(const WeightDomain& domain, std::vector<Weights>& out)
{
    for (std::size_t layer = 0; layer < domain.size(); ++layer) {
        const WeightRange& range = domain.ranges()[layer];
        for (const double v : { 0.5 * domain.full(layer), range.low, range.high })
            if (v != 0 && v != 1) out.push_back(v * corner_weights(domain.size(), layer));
    }
}

// Pairs of layers that move the same vertices, and with each the third that has most in common with both.
void append_overlaps(const NormalizedPoses& set, const WeightDomain& domain, std::vector<Weights>& out)
{
    const Eigen::MatrixXd overlaps = overlaps_of(set);
    const auto full = [&](Eigen::Index layer) {
        return Weights(domain.full(std::size_t(layer)) * corner_weights(domain.size(), std::size_t(layer)));
    };
    for (const Pair& pair : overlapping_pairs(overlaps, pair_count.of(domain.size()))) {
        out.push_back(full(pair.a) + full(pair.b));
        if (domain.size() > 2) out.push_back(out.back() + full(third_of(pair, overlaps)));
    }
}

// The part of shapes (columns, relative to pose 0) that the columns of `basis` do not span.
void project_out(const Eigen::MatrixXd& basis, const Eigen::VectorXd& masses, Eigen::MatrixXd& shapes)
{
    const Eigen::MatrixXd along = times_mass(basis, masses).transpose() * shapes;
    shapes -= basis * along;
}

// How far a mixture is from a linear sum: the root of the energy that the sum has there. The score is 0 for mixtures for
// which no tolerance is meant, and for those whose sums have much more energy than most: they seldom have a shape.
Eigen::VectorXd scores_of(const CorrectedFamily& known, const WeightDomain& domain, const std::vector<Weights>& mixtures)
{
    Eigen::VectorXd out(Eigen::Index(mixtures.size()));
    for_each_task(mixtures.size(), [&](std::size_t i, std::size_t) {
        const double energy = energy_value(known.family().pool().energy(), mixtures[i],
                                           linear_blend(known.family().pool().set(), mixtures[i]));
        out[Eigen::Index(i)] = std::isfinite(energy) && domain.is_counted(mixtures[i]) ? std::sqrt(energy) : 0;
    });
    std::vector<double> sorted(out.begin(), out.end());
    const auto middle = sorted.begin() + std::ptrdiff_t(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (double& score : out)
        if (score > largest_score * *middle) score = 0;
    return out;
}

// Shapes of mixtures, found in waves, those first that are likely to be farthest from what is known.
class TrainingShapes {
public:
    TrainingShapes(CorrectedFamily& known, const WeightDomain& domain, const AdaptiveOptions& options)
        : known_(known)
        , set_(known.family().pool().set())
        , unit_(options.tolerance * mass_norm(set_.shapes[0], set_.masses)) // shapes are centred
        , basis_(build_subspace(set_, Eigen::MatrixXd(set_.dof_count(), 0), 0).basis)
        , mixtures_(training_mixtures(set_, domain, options.seed))
        , scores_(scores_of(known, domain, mixtures_))
        , most_(std::min(mixture_count(domain.size()), mixtures_.size()))
        , follows_(!domain.is_box())
    {
        distances_.setConstant(scores_.size(), std::numeric_limits<double>::infinity());
        mark(domain.centre());
        for (const Weights& corner : corner_weights_of(known.family().pool().energy())) mark(corner);
    }

    bool is_done() const { return done_ >= most_ || is_explained_; }

    std::vector<CheckPoint> next_wave()
    {
        const std::size_t size = std::min(most_ - done_, std::max(least_wave, done_ / 2));
        std::vector<Weights> weights;
        for (std::size_t i = 0; i < size; ++i) weights.push_back(i % unbiased_one_of == 0 ? next_in_list() : best_scored());
        std::vector<CheckPoint> wave = known_.find(weights, { "averages", done_, most_ }, follows_);
        done_ += size;
        take(wave);
        known_.learn(wave);
        return wave;
    }

private:
    // The mixture is chosen: its neighbours come later.
    Weights mark(Weights v)
    {
        for (Eigen::Index i = 0; i < distances_.size(); ++i)
            distances_[i] = std::min(distances_[i], (mixtures_[std::size_t(i)] - v).norm());
        return v;
    }

    Weights best_scored()
    {
        Eigen::Index best = 0;
        const double score = scores_.cwiseProduct(distances_).maxCoeff(&best);
        return score > 0 ? mark(mixtures_[std::size_t(best)]) : next_in_list();
    }

    Weights next_in_list()
    {
        while (distances_[next_] < closest_centres && next_ + 1 < distances_.size()) ++next_;
        return mark(mixtures_[std::size_t(next_)]);
    }

    void take(const std::vector<CheckPoint>& wave)
    {
        Eigen::MatrixXd apart(set_.dof_count(), Eigen::Index(wave.size()));
        for (std::size_t i = 0; i < wave.size(); ++i) apart.col(Eigen::Index(i)) = wave[i].reference - set_.shapes[0];
        project_out(basis_, set_.masses, apart);
        double mean = 0, largest = 0, count = 0;
        for (Eigen::Index i = 0; i < apart.cols(); i += Eigen::Index(unbiased_one_of)) {
            if (!wave[std::size_t(i)].has_converged) continue;
            const double distance = mass_norm(apart.col(i), set_.masses) / unit_;
            mean += (distance - mean) / ++count;
            largest = std::max(largest, distance);
        }
        is_explained_ = double(done_) >= least_share * double(most_) && mean <= mean_in_span && largest <= largest_in_span;
        for (Eigen::Index i = 0; i < apart.cols(); ++i)
            if (wave[std::size_t(i)].has_converged) append(apart.col(i));
    }

    void append(Eigen::MatrixXd column)
    {
        for (int pass = 0; pass < 2; ++pass) project_out(basis_, set_.masses, column);
        const double length = mass_norm(column, set_.masses);
        if (length < 1e-3 * unit_) return;
        basis_.conservativeResize(Eigen::NoChange, basis_.cols() + 1);
        basis_.rightCols(1) = column / length;
    }

    CorrectedFamily& known_;
    const NormalizedPoses& set_;
    double unit_;           // a tolerance, in the mass norm
    Eigen::MatrixXd basis_; // of the differences and all shapes found
    std::vector<Weights> mixtures_;
    Eigen::VectorXd scores_, distances_; // of each mixture; from those that were chosen
    std::size_t most_, done_ = 0;
    bool follows_; // averages have a branch that counts; one layered shape more or less makes no difference
    Eigen::Index next_ = 0;
    bool is_explained_ = false;
};

} // namespace

std::size_t mixture_count(std::size_t weight_count) { return shape_count.of(weight_count); }

std::vector<Weights> training_mixtures(const NormalizedPoses& set, const WeightDomain& domain, std::uint64_t seed)
{
    if (!domain.is_box()) return domain.draw_all(seed, average_count.of(domain.size()));
    Random random(seed);
    std::vector<Weights> out;
    append_singles(domain, out);
    append_overlaps(set, domain, out);
    const std::size_t layers = domain.size();
    for (std::size_t i = 0; i < sparse_count.of(layers); ++i) out.push_back(domain.mixture(random, 1 + i % sparse_limit));
    for (std::size_t i = 0; i < dense_count.of(layers); ++i) out.push_back(domain.mixture(random, layers));
    for (std::size_t i = 0; i < corner_count; ++i) out.push_back(domain.corner(random));
    std::vector<Weights> shuffled;
    for (const std::size_t i : random.distinct(out.size(), out.size())) shuffled.push_back(out[i]);
    return shuffled;
}

FoundSubspace build_mixture_subspace(CorrectedFamily& known, const WeightDomain& domain,
                                     const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                     Progress* progress)
{
    const NormalizedPoses& set = known.family().pool().set();
    FoundSubspace out;
    out.averages.push_back({ domain.centre(), known.mean() });
    TrainingShapes training(known, domain, options);
    while (!training.is_done() && (out.averages.size() == 1 || !options.snapshot_time.is_spent())) {
        std::vector<CheckPoint> wave = training.next_wave();
        const auto lost = std::remove_if(wave.begin(), wave.end(), [](const CheckPoint& p) { return !p.has_converged; });
        out.unconverged_count += int(wave.end() - lost);
        wave.erase(lost, wave.end());
        append_averages(out, std::move(wave));
    }
    out.checks = known.find_in_time(check_weights, "averages to check", options.check_time);
    if (progress) progress->update("subspace", 0.9, fmt::format("leading directions of {} snapshots", out.averages.size()));
    out.subspace = build_snapshot_subspace(set, out.averages, options);
    return out;
}

} // namespace pliant
