#include "subspace/adaptive.h"

#include "average/rigid_modes.h"
#include "average/shape_error.h"
#include "energy/parallel.h"
#include "reduce/reduced_solver.h"
#include "reduce/training.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Of reduced solutions that Newton's method goes on from.
constexpr double reduced_tolerance = 1e-3;

// Weights that are gone through with one basis, at the same time on several threads.
constexpr std::size_t batch_size = 8;

// A blend that is this far from the truth that Newton finds next to it may have left the branch.
constexpr double branch_suspicion = 0.05;
constexpr double unsuspecting
    = 1e30; // for snapshots: while the basis is small all are far, and any average of low energy is a good one

// Of the tolerance: what is good enough not to become a column, and what is so bad at a check that it becomes one.
constexpr double snapshot_share = 0.3, missed_share = 2.4;

std::vector<CheckPoint> solve_checks(AverageFamily& family, SolverPool& pool, const ReducedSolver& reduced,
                                     const std::vector<KnownAverage>& known, const std::vector<Weights>& weights,
                                     double suspicion, SharedProgress& progress)
{
    const ReducedStarts starts(reduced, pool.set(), known);
    std::vector<CheckPoint> points(weights.size());
    for_each_task(weights.size(), [&](std::size_t i, std::size_t worker) {
        progress.update("", 0);
        const Shape blend = reduced.subspace().shape(reduced.solve(weights[i], starts(weights[i]), reduced_tolerance).q);
        points[i] = family.check(weights[i], blend, suspicion, worker, &progress);
    });
    return points;
}

class Builder {
public:
    Builder(AverageFamily& family, SolverPool& pool, const AdaptiveOptions& options, Progress* progress,
            AdaptiveReport& report)
        : family_(family)
        , pool_(pool)
        , set_(pool.set())
        , options_(options)
        , progress_(progress)
        , report_(report)
        , random_(options.seed)
        , subspace_(build_subspace(set_, Eigen::MatrixXd(set_.dof_count(), 0), 0)) // the differences alone
        , reduced_(pool.energy(), subspace_, family.mean_hessian(), family.mean().energy)
    {
    }

    AdaptiveSubspace build(const std::vector<Weights>& training, const std::vector<Weights>& check_weights)
    {
        start();
        go_through({ training.begin() + 1, training.end() });
        fill();
        AdaptiveSubspace out;
        out.checks = find_checks(check_weights);
        out.subspace = build_subspace(set_, directions(), options_.dimension ? options_.dimension : options_.max_dimension);
        report_.snapshot_count = int(averages_.size() + passed_.size());
        out.averages = std::move(averages_);
        return out;
    }

private:
    // Of the basis that finds snapshots.
    Eigen::Index limit() const { return options_.dimension ? options_.dimension : options_.max_dimension; }

    void tell(const std::string& detail) { progress_.describe("subspace", 0.9, detail); }

    // Snapshots and tangents relative to pose 0, side by side.
    Eigen::MatrixXd directions() const
    {
        Eigen::MatrixXd out(set_.dof_count(), Eigen::Index(averages_.size() + passed_.size()) + tangents_.cols());
        Eigen::Index column = 0;
        for (const auto* list : { &averages_, &passed_ })
            for (const KnownAverage& known : *list) out.col(column++) = known.shape - set_.shapes[0];
        out.rightCols(tangents_.cols()) = tangents_;
        return out;
    }

    void add_direction(const Shape& displacement)
    {
        if (append_direction(subspace_, displacement, set_.masses)) reduced_.extend();
    }

    void start()
    {
        const std::size_t m = set_.pose_count();
        tell("tangents at the average of all poses");
        averages_.push_back({ equal_weights(m), family_.mean().y });
        report_.unconverged_count += !family_.mean().has_converged;
        passed_ = family_.known();
        for (const auto* list : { &averages_, &passed_ })
            for (const KnownAverage& known : *list) add_direction(known.shape - set_.shapes[0]);
        // Tangents at the mean, K a' = -sum_k nu_k grad W_k: one factorisation for all of them.
        Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(set_.dof_count(), Eigen::Index(m));
        for (std::size_t k = 0; k < m; ++k) {
            Shape load = Shape::Zero(set_.dof_count());
            add_gradient(pool_.energy(), corner_weights(m, k), family_.mean().y, load);
            loads.col(Eigen::Index(k)) = load;
        }
        pool_.at(0).factorize_equilibrium(equal_weights(m), family_.mean().y);
        tangents_ = -pool_.at(0).solve_equilibrium(loads.leftCols(loads.cols() - 1)); // the loads sum to zero
        for (Eigen::Index k = 0; k < tangents_.cols(); ++k) add_direction(tangents_.col(k));
    }

    // Averages at all these weights; those that the basis does not hold well enough widen it.
    void go_through(const std::vector<Weights>& weights)
    {
        const double enough = snapshot_share * options_.tolerance;
        for (std::size_t done = 0; done < weights.size(); done += batch_size) {
            progress_.describe(
                "subspace", 0.9 * double(done) / double(weights.size()),
                fmt::format("d = {}, averages at {} of {} weights", subspace_.dimension(), done, weights.size()));
            const std::vector<Weights> batch(weights.begin() + std::ptrdiff_t(done),
                                             weights.begin() + std::ptrdiff_t(std::min(done + batch_size, weights.size())));
            std::vector<KnownAverage> known = averages_;
            known.insert(known.end(), passed_.begin(), passed_.end());
            for (CheckPoint& point : solve_checks(family_, pool_, reduced_, known, batch, unsuspecting, progress_)) {
                report_.unconverged_count += !point.has_converged;
                add_average(point, point.error > enough && subspace_.dimension() < limit());
            }
        }
    }

    void add_average(CheckPoint& point, bool is_direction)
    {
        if (is_direction) add_direction(point.truth - set_.shapes[0]);
        averages_.push_back({ point.weights, std::move(point.truth) });
    }

    // As many snapshots as the dimension that was asked for needs, whatever the error.
    void fill()
    {
        while (Eigen::Index(averages_.size()) < options_.dimension) {
            std::vector<Weights> batch;
            for (std::size_t i = 0; i < batch_size; ++i) batch.push_back(mixed_weights(random_, set_.pose_count(), i));
            go_through(batch);
        }
    }

    // A check that the basis misses by far becomes a snapshot, and another weight is checked in its place: no check that is left has
    // been a snapshot.
    std::vector<CheckPoint> find_checks(std::vector<Weights> weights)
    {
        const double missed = missed_share * (options_.tolerance_max > 0 ? options_.tolerance_max / 3 : options_.tolerance);
        std::vector<CheckPoint> checks;
        for (int round = 0; round < 4 && !weights.empty(); ++round) {
            tell(fmt::format("averages at {} check weights", weights.size()));
            std::vector<CheckPoint> points
                = solve_checks(family_, pool_, reduced_, averages_, weights, branch_suspicion, progress_);
            weights.clear();
            for (CheckPoint& point : points) {
                if (point.error <= missed || round == 3) {
                    checks.push_back(std::move(point));
                    continue;
                }
                add_average(point, subspace_.dimension() < 2 * limit());
                weights.push_back(mixed_weights(random_, set_.pose_count(), weights.size()));
            }
        }
        return checks;
    }

    AverageFamily& family_;
    SolverPool& pool_;
    const ShapeSet& set_;
    const AdaptiveOptions& options_;
    SharedProgress progress_;
    AdaptiveReport& report_;
    Random random_;
    std::vector<KnownAverage> averages_, passed_; // at weights of ours; on ways of the family, to few digits
    Eigen::MatrixXd tangents_;
    Subspace subspace_; // of all snapshots and tangents
    ReducedSolver reduced_;
};

} // namespace

AdaptiveSubspace build_adaptive_subspace(AverageFamily& family, SolverPool& pool, const std::vector<Weights>& training,
                                         const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                         Progress* progress, AdaptiveReport& report)
{
    return Builder(family, pool, options, progress, report).build(training, check_weights);
}

std::vector<CheckPoint> solve_checks(AverageFamily& family, SolverPool& pool, const Subspace& subspace,
                                     const std::vector<Weights>& check_weights, Progress* progress)
{
    SharedProgress shared(progress);
    shared.describe("checks", 0, fmt::format("averages at {} check weights", check_weights.size()));
    const ReducedSolver reduced(pool.energy(), subspace, family.mean_hessian(), family.mean().energy);
    return solve_checks(family, pool, reduced, { { equal_weights(pool.set().pose_count()), family.mean().y } },
                        check_weights, branch_suspicion, shared);
}

} // namespace pliant
