#include "reduce/choose_stand_in.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Sizes that are tried, in elements per dimension (of eight at least, where they cost nothing).
constexpr std::size_t sizes[] = { 4, 6, 8, 12 };

// When there is nothing to judge by.
constexpr std::size_t size_without_checks = 8;

// While the tolerance is missed a larger set must lower the error by this much to be worth its time in every frame.
constexpr double worthwhile = 0.97;

// What is aimed at, of the tolerance: other weights than the checks are a little worse.
constexpr double aim = 0.9;

const BlendError& error_of(const StandInReport& report) { return report.has_load ? report.loaded : report.plain; }

} // namespace

BlendModel fit_model(std::shared_ptr<const StandIn> stand_in, const Subspace& subspace, const ShapeSet& set,
                     const TrainingSet& training, const std::vector<CheckPoint>& checks, bool may_load,
                     StandInReport& report)
{
    report = {};
    report.curvature = measure_curvature(*stand_in, training);
    BlendModel plain = plain_model(stand_in, training, subspace);
    report.plain = blend_error(plain, subspace, set, checks);
    if (!may_load || report.curvature.lowest <= 0) return plain;
    BlendModel loaded = loaded_model(std::move(stand_in), training, subspace);
    report.loaded = blend_error(loaded, subspace, set, checks);
    report.has_load
        = !checks.empty() && report.loaded.mean < report.plain.mean && report.loaded.largest <= report.plain.largest;
    return report.has_load ? loaded : plain;
}

BlendModel choose_cubature(const ReducedEnergy& reduced, const ShapeSet& set, const TrainingSet& training,
                           const std::vector<CheckPoint>& checks, const StandInOptions& options, Progress* progress,
                           StandInReport& report)
{
    const Subspace& subspace = reduced.subspace();
    const double largest = options.tolerance_max > 0 ? options.tolerance_max : 3 * options.tolerance;
    CubatureOptions cubature;
    cubature.seed = options.seed;
    CubatureFit fit(reduced, training, cubature, progress);
    BlendModel best;
    for (std::size_t per_dimension : sizes) {
        if (checks.empty() && per_dimension < size_without_checks) continue;
        const std::size_t count = options.element_count
            ? options.element_count
            : per_dimension * std::max<std::size_t>(8, std::size_t(subspace.dimension()));
        auto stand_in = std::make_shared<const StandIn>(fit.fit(count));
        for (int round = 0; round < 2 && fit.stiffen(*stand_in) > 0; ++round)
            stand_in = std::make_shared<const StandIn>(fit.fit(count));
        if (progress) progress->update("cubature", 0.99, fmt::format("{} elements: error of blends", count));
        StandInReport here;
        BlendModel model = fit_model(std::move(stand_in), subspace, set, training, checks, true, here);
        here.residual = fit.residual();
        const bool is_first = !best.stand_in;
        const bool is_better = is_first || (here.curvature.lowest > 0 && report.curvature.lowest <= 0)
            || error_of(here).mean < worthwhile * error_of(report).mean;
        if (is_better) {
            best = std::move(model);
            report = here;
        }
        const bool is_enough = report.curvature.lowest > 0 && error_of(report).mean < aim * options.tolerance
            && error_of(report).largest < aim * largest;
        if (is_enough || options.element_count || checks.empty()) break;
    }
    return best;
}

} // namespace pliant
