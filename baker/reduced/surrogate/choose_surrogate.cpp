#include "reduced/surrogate/choose_surrogate.h"

#include <algorithm>
#include <fmt/core.h>
#include <map>

namespace pliant {

namespace {

// Sizes that are tried, in elements per dimension (of eight at least, where they cost nothing).
constexpr std::size_t sizes[] = { 4, 6, 8, 12 };

// When there is nothing to judge by.
constexpr std::size_t size_without_checks = 8;

// A larger set must lower the error to this part to be worth its time in every frame, unless it is what makes it enough.
constexpr double worthwhile = 0.9;

// What is aimed at, of the tolerance: other weights than the checks are worse.
constexpr double aim = 0.75;

// What the surrogate energy adds to the error of its training data makes it about this many times as large.
constexpr double usual_ratio = 1.5;

// So many larger dimensions are tried that are no better.
constexpr std::ptrdiff_t patience = 3;

// Where the tolerance is missed with the best dimension, an error this much larger is as good.
constexpr double reachable = 1.1;

// This share of the checks, the worst ones, decides nothing: a blend in another minimum, which no dimension and no element
// cures, would decide everything. Where a largest error is asked for, all count.
constexpr double outlier_share = 0.05;

// Candidates of the cubature when the time is spent before the first fit.
constexpr std::size_t least_candidate_count = 2000;

// Mean and largest error count alike, each in units of what is wanted of it; parts only where they drift too far.
double score(const BlendError& error, const SurrogateOptions& options)
{
    return error.usual_mean / options.tolerance + error.usual_largest / options.largest()
        + std::max(0.0, error.drift / options.drift - aim);
}

} // namespace

bool is_enough(const BlendError& error, const SurrogateOptions& options)
{
    return error.usual_mean < aim * options.tolerance && error.usual_largest < aim * options.largest()
        && error.drift < aim * options.drift;
}

ChosenModel fit_model(std::shared_ptr<const SurrogateEnergy> surrogate, const Subspace& subspace, const NormalizedPoses& set,
                      const TrainingSet& training, const std::vector<CheckPoint>& checks, bool may_load,
                      const SurrogateOptions& options)
{
    SurrogateReport report;
    report.curvature = measure_curvature(*surrogate, training);
    BlendModel plain = plain_model(surrogate, training, subspace);
    const double outliers = options.tolerance_max > 0 ? 0 : outlier_share;
    report.plain = blend_error(plain, subspace, set, checks, outliers);
    if (!may_load || (checks.empty() && report.curvature.lowest <= 0)) return { std::move(plain), report };
    BlendModel loaded = loaded_model(std::move(surrogate), training, subspace);
    report.loaded = blend_error(loaded, subspace, set, checks, outliers);
    report.has_load = checks.empty() || score(report.loaded, options) < score(report.plain, options);
    return { report.has_load ? std::move(loaded) : std::move(plain), report };
}

namespace {

std::size_t count_for(std::size_t per_dimension, Eigen::Index dimension)
{
    return per_dimension * std::max<std::size_t>(8, std::size_t(dimension));
}

std::shared_ptr<const SurrogateEnergy> fit_elements(CubatureFit& fit, std::size_t count, const Gauge& gauge)
{
    auto surrogate = std::make_shared<SurrogateEnergy>(fit.fit(count));
    for (int round = 0; round < 2 && fit.stiffen(*surrogate) > 0; ++round)
        surrogate = std::make_shared<SurrogateEnergy>(fit.fit(count));
    surrogate->hold(gauge);
    return surrogate;
}

} // namespace

ChosenModel choose_cubature(const ReducedEnergy& reduced, const NormalizedPoses& set, const TrainingSet& training,
                            const std::vector<CheckPoint>& checks, const SurrogateOptions& options, Progress* progress)
{
    const Subspace& subspace = reduced.subspace();
    CubatureOptions cubature;
    if (options.budget.is_spent()) cubature.candidate_count = least_candidate_count;
    cubature.seed = options.seed;
    cubature.solver = options.cubature;
    CubatureFit fit(reduced, training, cubature, progress);
    ChosenModel best;
    for (std::size_t per_dimension : sizes) {
        if (checks.empty() && per_dimension < size_without_checks) continue;
        const std::size_t count
            = options.element_count ? options.element_count : count_for(per_dimension, subspace.dimension());
        std::shared_ptr<const SurrogateEnergy> surrogate = fit_elements(fit, count, reduced.gauge());
        if (progress)
            progress->update("cubature", 0.99,
                             fmt::format("d = {}, {} elements: error of blends", subspace.dimension(), count));
        ChosenModel here = fit_model(std::move(surrogate), subspace, set, training, checks, true, options);
        here.report.residual = fit.residual();
        const bool gets_convex = here.report.curvature.lowest > 0 && best.report.curvature.lowest <= 0;
        const bool gets_enough = is_enough(here.report.error(), options) && !is_enough(best.report.error(), options);
        const bool is_better = !best.model.surrogate || gets_convex || gets_enough
            || score(here.report.error(), options) < worthwhile * score(best.report.error(), options);
        if (is_better) best = std::move(here);
        const bool is_convex = best.report.curvature.lowest > 0;
        if (is_convex && (is_enough(best.report.error(), options) || !is_better)) break;
        if (options.element_count || checks.empty() || options.budget.is_spent()) break;
    }
    return best;
}

namespace {

// The search of choose_dimension(): climbs until a dimension is enough, then narrows the gap below it.
class DimensionSearch {
public:
    DimensionSearch(Eigen::Index least, Eigen::Index most, const SurrogateOptions& options,
                    const std::function<double(Eigen::Index)>& predicted,
                    const std::function<BlendError(Eigen::Index)>& error_at)
        : least_(least)
        , most_(most)
        , wanted_(options)
        , predicted_(predicted)
        , error_at_(error_at)
    {
    }

    Eigen::Index run()
    {
        if (!climb() && !is_out_of_time()) settle_for_reachable();
        while (high_ - low_ > low_ / 16 && !is_out_of_time()) {
            const Eigen::Index third = (high_ - low_) / 3;
            measure(std::clamp(promising(), low_ + third, high_ - 1 - third));
        }
        return measured_.count(high_) ? high_ : best_measured();
    }

private:
    bool is_out_of_time() const { return wanted_.budget.is_spent(); }

    // False if no dimension is enough, or none of those that there was time for.
    bool climb()
    {
        Eigen::Index next = promising();
        for (Eigen::Index step = std::max<Eigen::Index>(1, next / 16); !measure(next); step *= 2) {
            if (next == most_ || stagnates() || is_out_of_time()) return false;
            next = std::min(most_, std::max(promising(), next + step));
        }
        return true;
    }

    // What is out of reach is brought as near as the best dimension does, but not by more of them than that takes.
    void settle_for_reachable()
    {
        const BlendError& best = measured_.at(best_measured());
        wanted_.tolerance = std::max(wanted_.tolerance, reachable * best.usual_mean / aim);
        wanted_.tolerance_max = std::max(wanted_.largest(), reachable * best.usual_largest / aim);
        wanted_.drift = std::max(wanted_.drift, reachable * best.drift / aim);
        low_ = least_;
        narrow();
    }

    // On the way up: none of the last dimensions was better than the best one before, whose subspace is good enough.
    bool stagnates() const
    {
        if (std::ptrdiff_t(measured_.size()) <= patience) return false;
        const Eigen::Index best = best_measured();
        return best <= std::next(measured_.rbegin(), patience)->first && predicted_(best) < aim * wanted_.tolerance / 2;
    }

    bool measure(Eigen::Index d)
    {
        const BlendError& error = measured_[d] = error_at_(d);
        ratio_ = std::max(error.usual_mean, error.usual_largest * wanted_.tolerance / wanted_.largest()) / predicted_(d);
        narrow();
        return is_enough(error, wanted_);
    }

    void narrow()
    {
        for (const auto& [d, error] : measured_)
            if (is_enough(error, wanted_))
                high_ = std::min(high_, d);
            else
                low_ = std::max(low_, std::min(d + 1, most_));
    }

    Eigen::Index best_measured() const
    {
        const auto is_better
            = [&](const auto& a, const auto& b) { return score(a.second, wanted_) < score(b.second, wanted_); };
        return std::min_element(measured_.begin(), measured_.end(), is_better)->first;
    }

    Eigen::Index promising() const
    {
        Eigen::Index d = low_;
        while (d < high_ && ratio_ * predicted_(d) >= aim * wanted_.tolerance) ++d;
        return d;
    }

    Eigen::Index least_, most_, low_ = least_, high_ = most_; // the answer is in low..high
    SurrogateOptions wanted_;
    const std::function<double(Eigen::Index)>& predicted_;
    const std::function<BlendError(Eigen::Index)>& error_at_;
    std::map<Eigen::Index, BlendError> measured_;
    double ratio_ = usual_ratio; // of measured to predicted errors
};

} // namespace

Eigen::Index choose_dimension(Eigen::Index least, Eigen::Index most, const SurrogateOptions& options,
                              const std::function<double(Eigen::Index)>& predicted,
                              const std::function<BlendError(Eigen::Index)>& error_at)
{
    return DimensionSearch(least, most, options, predicted, error_at).run();
}

} // namespace pliant
