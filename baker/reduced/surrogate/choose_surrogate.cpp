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

// A larger set must lower the error by this much to be worth its time in every frame.
constexpr double worthwhile = 0.97;

// What is aimed at, of the tolerance: other weights than the checks are worse.
constexpr double aim = 0.75;

// Where the tolerance is missed with the most dimensions, an error this much larger is as good.
constexpr double reachable = 1.1;

// Blends follow the reference averages: where those drift, nothing that is fitted to them can be asked to drift less.
double wanted_drift(const BlendError& error, const SurrogateOptions& options)
{
    return std::max(aim * options.drift, reachable * error.drift_of_references);
}

// Mean and largest error count alike, each in units of what is wanted of it; parts only where they drift too far.
double score(const BlendError& error, const SurrogateOptions& options)
{
    return error.mean / options.tolerance + error.largest / options.largest()
        + std::max(0.0, error.drift - wanted_drift(error, options)) / options.drift;
}

} // namespace

bool is_enough(const BlendError& error, const SurrogateOptions& options)
{
    return error.mean < aim * options.tolerance && error.largest < aim * options.largest()
        && error.drift <= wanted_drift(error, options);
}

ChosenModel fit_model(std::shared_ptr<const SurrogateEnergy> surrogate, const Subspace& subspace, const NormalizedPoses& set,
                      const TrainingSet& training, const std::vector<CheckPoint>& checks, bool may_load,
                      const SurrogateOptions& options)
{
    SurrogateReport report;
    report.curvature = measure_curvature(*surrogate, training);
    BlendModel plain = plain_model(surrogate, training, subspace);
    report.plain = blend_error(plain, subspace, set, checks);
    if (!may_load || (checks.empty() && report.curvature.lowest <= 0)) return { std::move(plain), report };
    BlendModel loaded = loaded_model(std::move(surrogate), training, subspace);
    report.loaded = blend_error(loaded, subspace, set, checks);
    report.has_load = checks.empty() || score(report.loaded, options) < score(report.plain, options);
    return { report.has_load ? std::move(loaded) : std::move(plain), report };
}

namespace {

std::size_t count_for(std::size_t per_dimension, Eigen::Index dimension)
{
    return per_dimension * std::max<std::size_t>(8, std::size_t(dimension));
}

std::shared_ptr<const SurrogateEnergy> fit_elements(CubatureFit& fit, std::size_t count)
{
    auto surrogate = std::make_shared<const SurrogateEnergy>(fit.fit(count));
    for (int round = 0; round < 2 && fit.stiffen(*surrogate) > 0; ++round)
        surrogate = std::make_shared<const SurrogateEnergy>(fit.fit(count));
    return surrogate;
}

} // namespace

ChosenModel choose_cubature(const ReducedEnergy& reduced, const NormalizedPoses& set, const TrainingSet& training,
                            const std::vector<CheckPoint>& checks, const SurrogateOptions& options, Progress* progress)
{
    const Subspace& subspace = reduced.subspace();
    CubatureOptions cubature;
    cubature.seed = options.seed;
    cubature.solver = options.cubature;
    CubatureFit fit(reduced, training, cubature, progress);
    ChosenModel best;
    for (std::size_t per_dimension : sizes) {
        if (checks.empty() && per_dimension < size_without_checks) continue;
        const std::size_t count
            = options.element_count ? options.element_count : count_for(per_dimension, subspace.dimension());
        std::shared_ptr<const SurrogateEnergy> surrogate = fit_elements(fit, count);
        if (progress) progress->update("cubature", 0.99, fmt::format("{} elements: error of blends", count));
        ChosenModel here = fit_model(std::move(surrogate), subspace, set, training, checks, true, options);
        here.report.residual = fit.residual();
        const bool gets_convex = here.report.curvature.lowest > 0 && best.report.curvature.lowest <= 0;
        const bool is_better = !best.model.surrogate || gets_convex
            || score(here.report.error(), options) < worthwhile * score(best.report.error(), options);
        if (is_better) best = std::move(here);
        const bool is_convex = best.report.curvature.lowest > 0;
        if (is_convex && (is_enough(best.report.error(), options) || !is_better)) break;
        if (options.element_count || checks.empty()) break;
    }
    return best;
}

Eigen::Index choose_dimension(Eigen::Index least, Eigen::Index first, Eigen::Index most, const SurrogateOptions& options,
                              const std::function<BlendError(Eigen::Index)>& error_at)
{
    std::map<Eigen::Index, BlendError> measured;
    Eigen::Index last = 0;
    const auto error = [&](Eigen::Index d) {
        if (measured.count(d) == 0) measured[last = d] = error_at(d);
        return measured[d];
    };
    Eigen::Index high = first;
    for (Eigen::Index step = std::max<Eigen::Index>(1, first / 8); high < most && !is_enough(error(high), options);
         step *= 2)
        high = std::min(most, high + step);
    SurrogateOptions wanted = options;
    if (high == most) {
        // What is out of reach is brought as near as the most dimensions do, but not by more of them than that takes.
        const BlendError best = error(most);
        wanted.tolerance = std::max(options.tolerance, reachable * best.mean / aim);
        wanted.tolerance_max = std::max(options.largest(), reachable * best.largest / aim);
        wanted.drift = std::max(options.drift, reachable * best.drift / aim);
    }
    Eigen::Index low = least;
    for (const auto& [d, here] : measured)
        if (!is_enough(here, wanted)) low = std::min(most, d + 1);
    while (low < high) {
        const Eigen::Index middle = (low + high) / 2;
        if (is_enough(error(middle), wanted))
            high = middle;
        else
            low = middle + 1;
    }
    if (last != high) error_at(high);
    return high;
}

} // namespace pliant
