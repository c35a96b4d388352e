#include "bake/find_subspace.h"

#include "bake/estimate.h"
#include "base/weights/sampling.h"
#include "elastic/average/rigid_modes.h"
#include "pliant_format.h"
#include "reduced/subspace/barbic.h"
#include "reduced/subspace/krylov.h"
#include "reduced/subspace/mixtures.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

constexpr Eigen::Index dimension_limit = PLIANT_FORMAT_MAX_DIMENSION;

const double default_tolerance = BakeOptions().tolerance;

// Averages are wanted to this part of the tolerance.
constexpr double average_share = 0.05;

// Of a limited time: when the last snapshots and the last checks are to be known.
constexpr double snapshot_share = 0.4, check_share = 0.5;

// Added to the seed, so that checks are no training weights.
constexpr std::uint64_t check_seed = 1000003;

} // namespace

// For snapshots and checks: what counts is the distance between shapes, to a few per cent of the error that is looked for.
// The decrement is tested before the last step, which squares it. Where the average snaps, Newton creeps: an almost
// converged average is as good a snapshot, and the report counts it.
NewtonOptions average_options(const BakeOptions& options, const NormalizedPoses& set)
{
    NewtonOptions newton;
    // Below the default tolerance the energy has to say more, too: it goes with the square of what is off.
    newton.decrement = 1e-5 * std::clamp(std::pow(options.tolerance / default_tolerance, 2), 1e-8, 1.0);
    newton.residual = 3e-2;
    newton.step_ratio = 0.05;
    newton.step_floor = average_share * options.tolerance * mass_norm(set.shapes[0], set.masses); // shapes are centred
    newton.max_iterations = iteration_limit;
    return newton;
}

namespace {

Subspace build_fixed_subspace(SolverPool& pool, const BakeOptions& options, Progress& progress)
{
    if (options.subspace == SubspaceKind::krylov)
        return build_krylov_subspace(pool.at(0), { options.ritz_count, options.dimension, dimension_limit }, &progress);
    return build_barbic_subspace(pool.at(0), { BarbicOptions().mode_count, options.dimension, dimension_limit }, &progress);
}

AdaptiveOptions adaptive_options(const BakeOptions& options, const TimeBudget& budget)
{
    AdaptiveOptions adaptive;
    adaptive.dimension = options.dimension;
    adaptive.tolerance = options.tolerance;
    adaptive.seed = options.seed;
    adaptive.snapshot_time = budget.part(snapshot_share);
    adaptive.check_time = budget.part(check_share);
    return adaptive;
}

FoundSubspace find_subspace_of_mixtures(CorrectedFamily& known, const WeightDomain& domain,
                                        const std::vector<Weights>& check_weights, const BakeOptions& options,
                                        const TimeBudget& budget, Progress& progress)
{
    AdaptiveOptions adaptive = adaptive_options(options, budget);
    adaptive.max_dimension += Eigen::Index(domain.size());
    return build_mixture_subspace(known, domain, check_weights, adaptive, &progress);
}

FoundSubspace find_subspace_of_averages(InterpolatedFamily& known, const std::vector<Weights>& check_weights,
                                        const BakeOptions& options, const TimeBudget& budget, Progress& progress)
{
    SolverPool& pool = known.family().pool();
    const std::size_t m = pool.set().pose_count();
    if (options.subspace != SubspaceKind::adaptive) {
        FoundSubspace out;
        out.subspace = build_fixed_subspace(pool, options, progress);
        out.checks = known.find_in_time(check_weights, "averages to check", budget.part(check_share));
        return out;
    }
    return build_adaptive_subspace(known, training_weights(m, training_count(m), options.seed), check_weights,
                                   adaptive_options(options, budget), &progress);
}

} // namespace

FoundFamily find_subspace(AverageFamily& family, const WeightDomain& domain, const BakeOptions& options,
                          const TimeBudget& budget, Progress& progress)
{
    const std::vector<Weights> check_weights
        = domain.draw_counted(options.seed + check_seed, std::size_t(options.check_count));
    if (domain.is_wide()) {
        auto known = std::make_unique<CorrectedFamily>(family, &progress);
        FoundSubspace found = find_subspace_of_mixtures(*known, domain, check_weights, options, budget, progress);
        return { std::move(found), std::move(known) };
    }
    auto known = std::make_unique<InterpolatedFamily>(family, &progress);
    FoundSubspace found = find_subspace_of_averages(*known, check_weights, options, budget, progress);
    return { std::move(found), std::move(known) };
}

} // namespace pliant
