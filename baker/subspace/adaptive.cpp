#include "subspace/adaptive.h"

#include "average/rigid_modes.h"
#include "average/shape_error.h"
#include "energy/parallel.h"
#include "reduce/reduced_solver.h"
#include "reduce/training.h"

#include <algorithm>
#include <fmt/core.h>
#include <limits>

namespace pliant {

namespace {

// Weights that are probed with one basis, at the same time on several threads. Their mean must be below the tolerance twice.
constexpr std::size_t batch_size = 8;

// A blend that is this far from the truth that Newton finds next to it may have left the branch.
constexpr double branch_suspicion = 0.05;
constexpr double unsuspecting
    = 1e30; // for snapshots: while the basis is small all are far, and any average of low energy is a good one

// More snapshots than may be kept: the leading directions of them are better than the first ones that came.
constexpr double surplus = 1.5;

// Of the tolerance: what the subspace may use, so that the stand-in has a share; and what is good enough not to become a snapshot.
constexpr double subspace_share = 0.6, largest_share = 0.8, snapshot_share = 0.3;

std::vector<CheckPoint> solve_checks(AverageFamily& family, SolverPool& pool, const ReducedSolver& reduced,
                                     const std::vector<KnownAverage>& known, const std::vector<Weights>& weights,
                                     double suspicion, SharedProgress& progress)
{
    const ReducedStarts starts(reduced, pool.set(), known);
    std::vector<CheckPoint> points(weights.size());
    for_each_task(weights.size(), [&](std::size_t i, std::size_t worker) {
        progress.update("", 0);
        const Shape blend = reduced.subspace().shape(reduced.solve(weights[i], starts(weights[i])).q);
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

    AdaptiveSubspace build(const std::vector<Weights>& check_weights)
    {
        start();
        refine();
        AdaptiveSubspace out;
        out.checks = find_checks(check_weights);
        out.subspace = options_.dimension ? build_subspace(set_, directions(), options_.dimension) : truncate(out.checks);
        out.snapshots = std::move(snapshots_);
        report_.snapshot_count = int(out.snapshots.size());
        return out;
    }

private:
    Eigen::Index limit() const
    {
        return Eigen::Index(surplus * double(options_.dimension ? options_.dimension : options_.max_dimension));
    }

    void tell(const std::string& detail)
    {
        progress_.describe("subspace", std::min(0.99, double(subspace_.dimension()) / double(limit())), detail);
    }

    // Snapshots and tangents relative to pose 0, side by side.
    Eigen::MatrixXd directions() const
    {
        Eigen::MatrixXd out(set_.dof_count(), Eigen::Index(snapshots_.size()) + tangents_.cols());
        for (std::size_t i = 0; i < snapshots_.size(); ++i) out.col(Eigen::Index(i)) = snapshots_[i].shape - set_.shapes[0];
        out.rightCols(tangents_.cols()) = tangents_;
        return out;
    }

    void add_direction(const Shape& displacement)
    {
        if (append_direction(subspace_, displacement, set_.masses)) reduced_.extend();
    }

    void add_snapshot(const Weights& w, const Shape& shape)
    {
        snapshots_.push_back({ w, shape });
        add_direction(shape - set_.shapes[0]);
    }

    void start()
    {
        const std::size_t m = set_.pose_count();
        tell("tangents at the average of all poses");
        add_snapshot(equal_weights(m), family_.mean().y);
        report_.unconverged_count += !family_.mean().has_converged;
        for (const KnownAverage& known : family_.known()) add_snapshot(known.weights, known.shape);
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

        std::vector<Weights> pairs;
        for (std::size_t i = 0; i < m; ++i)
            for (std::size_t j = i + 1; j < m && m > 2; ++j)
                pairs.push_back(0.5 * (corner_weights(m, i) + corner_weights(m, j)));
        probe(pairs, 0);
    }

    // Adds what is farther from the truth than `enough` as snapshots; returns the mean error.
    double probe(const std::vector<Weights>& weights, double enough)
    {
        tell(fmt::format("d = {}, {} snapshots, {} probes", subspace_.dimension(), snapshots_.size(), report_.probe_count));
        double sum = 0;
        for (CheckPoint& point : solve_checks(family_, pool_, reduced_, snapshots_, weights, unsuspecting, progress_)) {
            ++report_.probe_count;
            report_.unconverged_count += !point.has_converged;
            sum += point.error / double(weights.size());
            if (point.error > enough) add_snapshot(point.weights, point.truth);
        }
        return sum;
    }

    void refine()
    {
        int good_batches = 0;
        // Every batch adds a snapshot unless it is good, so this ends; the bound is for families that never get smooth.
        for (int round = 0; round < 40 && good_batches < 2 && subspace_.dimension() < limit(); ++round) {
            std::vector<Weights> batch;
            for (std::size_t i = 0; i < batch_size; ++i) batch.push_back(mixed_weights(random_, set_.pose_count(), i));
            // A dimension that was asked for is filled whatever the error.
            const double mean = probe(batch, options_.dimension ? 0 : snapshot_share * options_.tolerance);
            good_batches = mean < subspace_share * options_.tolerance && !options_.dimension ? good_batches + 1 : 0;
        }
    }

    // What the largest error of the subspace may be, for the stand-in to have a share.
    double largest_wanted() const
    {
        return largest_share * (options_.tolerance_max > 0 ? options_.tolerance_max : 3 * options_.tolerance);
    }

    // A check that the basis misses by far becomes a snapshot, and another weight is checked in its place: no check that is left has
    // been a snapshot.
    std::vector<CheckPoint> find_checks(std::vector<Weights> weights)
    {
        std::vector<CheckPoint> checks;
        for (int round = 0; round < 4 && !weights.empty(); ++round) {
            tell(fmt::format("averages at {} check weights", weights.size()));
            std::vector<CheckPoint> points
                = solve_checks(family_, pool_, reduced_, snapshots_, weights, branch_suspicion, progress_);
            weights.clear();
            for (CheckPoint& point : points) {
                const bool is_missed = point.error > largest_wanted() && round < 3 && subspace_.dimension() < 2 * limit();
                if (!is_missed) {
                    checks.push_back(std::move(point));
                    continue;
                }
                add_snapshot(point.weights, point.truth);
                weights.push_back(mixed_weights(random_, set_.pose_count(), weights.size()));
            }
        }
        return checks;
    }

    bool is_good(const SubspaceError& error, double largest) const
    {
        return error.mean < subspace_share * options_.tolerance && error.largest < largest;
    }

    // The smallest dimension that leaves the stand-in its share of the tolerance; the error falls with d, so bisection.
    Subspace truncate(const std::vector<CheckPoint>& checks)
    {
        const Eigen::MatrixXd all = directions();
        const Eigen::Index most = std::min(subspace_.dimension(), options_.max_dimension);
        if (checks.empty()) return build_subspace(set_, all, most); // nothing to judge by
        const auto error_at = [&](Eigen::Index d) {
            tell(fmt::format("error at d = {}", d));
            const Subspace subspace = build_subspace(set_, all, d);
            return subspace_error(ReducedSolver(pool_.energy(), subspace, family_.mean_hessian(), family_.mean().energy),
                                  set_, checks);
        };
        // Where the largest error is out of reach the mean decides alone: twice the columns would not be worth a little less.
        double largest = largest_wanted();
        if (!is_good(error_at(most), largest)) largest = std::numeric_limits<double>::max();
        Eigen::Index low = Eigen::Index(set_.pose_count()) - 1, high = most;
        while (low < high) {
            const Eigen::Index middle = (low + high) / 2;
            if (is_good(error_at(middle), largest))
                high = middle;
            else
                low = middle + 1;
        }
        return build_subspace(set_, all, high);
    }

    AverageFamily& family_;
    SolverPool& pool_;
    const ShapeSet& set_;
    const AdaptiveOptions& options_;
    SharedProgress progress_;
    AdaptiveReport& report_;
    Random random_;
    std::vector<KnownAverage> snapshots_;
    Eigen::MatrixXd tangents_;
    Subspace subspace_; // of all snapshots and tangents
    ReducedSolver reduced_;
};

} // namespace

AdaptiveSubspace build_adaptive_subspace(AverageFamily& family, SolverPool& pool, const std::vector<Weights>& check_weights,
                                         const AdaptiveOptions& options, Progress* progress, AdaptiveReport& report)
{
    return Builder(family, pool, options, progress, report).build(check_weights);
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
