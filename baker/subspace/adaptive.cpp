#include "subspace/adaptive.h"

#include "average/rigid_modes.h"
#include "reduce/training.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>

namespace pliant {

namespace {

// A check weight with the truth that Newton found for it.
struct Check {
    Weights w;
    Shape truth;
    double error;
};

// Fresh checks of which the mean must be below the tolerance, twice in a row.
constexpr std::size_t batch_size = 6;

class Builder {
public:
    Builder(NewtonSolver& solver, const AdaptiveOptions& options, Progress* progress, AdaptiveReport& report)
        : solver_(solver)
        , set_(solver.set())
        , options_(options)
        , progress_(progress)
        , report_(report)
        , random_(options.seed)
    {
        // Tested before the last step, which squares it: what is left is far below what a subspace leaves.
        newton_.decrement = 1e-5;
        newton_.residual = 3e-2;
        // Where the truth snaps, Newton creeps: an almost converged average is as good a snapshot, and the report counts it.
        newton_.max_iterations = 15;
    }

    Subspace build()
    {
        start();
        refine();
        Subspace subspace = options_.dimension ? build_subspace(set_, directions(), options_.dimension) : truncate();
        measure(subspace);
        return subspace;
    }

private:
    Eigen::Index limit() const { return options_.dimension ? options_.dimension : options_.max_dimension; }

    void tell(const std::string& detail)
    {
        const double room = double(limit() - Eigen::Index(set_.pose_count()) + 1);
        if (progress_)
            progress_->update("subspace", std::min(0.99, double(snapshots_.size()) / std::max(1.0, room)), detail);
    }

    // Snapshots relative to pose 0, side by side.
    Eigen::MatrixXd directions() const
    {
        Eigen::MatrixXd out(set_.dof_count(), Eigen::Index(snapshots_.size()));
        for (std::size_t i = 0; i < snapshots_.size(); ++i) out.col(Eigen::Index(i)) = snapshots_[i].truth - set_.shapes[0];
        return out;
    }

    // While the basis grows its columns stay, so that of the reduced Hessian at the mean only the new row is computed.
    void add_snapshot(Check check)
    {
        if (append_direction(subspace_, check.truth - subspace_.origin, set_.masses) && mean_hessian_.rows() > 0)
            extend_metric();
        snapshots_.push_back(std::move(check));
    }

    void extend_metric()
    {
        const Eigen::Index d = subspace_.dimension();
        const Eigen::VectorXd row
            = subspace_.basis.transpose() * (mean_hessian_.selfadjointView<Eigen::Lower>() * subspace_.basis.col(d - 1));
        reduced_hessian_.conservativeResize(d, d);
        reduced_hessian_.row(d - 1) = row.transpose();
        reduced_hessian_.col(d - 1) = row;
        metric_ = metric_from(reduced_hessian_);
    }

    static Eigen::MatrixXd metric_from(const Eigen::MatrixXd& hessian)
    {
        const Eigen::MatrixXd root = inverse_root(hessian, metric_floor);
        return root * root.transpose();
    }

    // The average of all poses, then the reduced problem can be solved near it; then all pairs.
    void start()
    {
        AverageFamily family(solver_, newton_, nullptr);
        tell("average of all poses");
        const NewtonResult mean = family.mean();
        report_.unconverged_count += !mean.has_converged;
        subspace_ = build_subspace(set_, Eigen::MatrixXd(set_.dof_count(), 0), 0); // the differences alone
        add_snapshot({ equal_weights(set_.pose_count()), mean.y, 0 });
        HessianAssembler assembler(solver_.energy());
        assembler.assemble(equal_weights(set_.pose_count()), mean.y, HessianKind::exact);
        mean_hessian_ = assembler.matrix();
        scale_ = std::max(mean.energy, 1e-13); // identical poses have no energy
        reduced_hessian_ = reduced_mean_hessian(subspace_);
        metric_ = metric_from(reduced_hessian_);
        const std::size_t m = set_.pose_count();
        for (std::size_t i = 0; i < m; ++i)
            for (std::size_t j = i + 1; j < m && m > 2; ++j)
                if (subspace_.dimension() < limit())
                    add_snapshot(check(0.5 * (corner_weights(m, i) + corner_weights(m, j))));
    }

    void refine()
    {
        int good_batches = 0;
        // Every batch adds a snapshot unless it is good, so this ends; the bound is for families that never get smooth.
        for (int round = 0; round < 40 && good_batches < 2; ++round) {
            double sum = 0;
            for (std::size_t i = 0; i < batch_size; ++i) {
                Check c = check(draw(int(i)));
                sum += c.error / double(batch_size);
                if (c.error > 0.3 * options_.tolerance && subspace_.dimension() < 2 * limit())
                    add_snapshot(std::move(c));
                else
                    held_out_.push_back(std::move(c));
            }
            good_batches = sum < options_.tolerance ? good_batches + 1 : 0;
            // A few more than can be kept: the best directions of them are better than the first ones that came.
            if (subspace_.dimension() >= limit() + 4) break;
        }
        while (held_out_.size() < 2 * batch_size) held_out_.push_back(check(draw(int(held_out_.size()))));
    }

    // Uniform, on an edge, corner-heavy.
    Weights draw(int index)
    {
        const std::size_t m = set_.pose_count();
        if (m == 2 || index % 3 == 0) return random_.weights(m, false);
        if (index % 3 == 1) return random_.weights(m, true);
        const std::size_t i = random_.below(m), j = (i + 1 + random_.below(m - 1)) % m;
        const double t = 0.1 + 0.8 * random_.uniform();
        return t * corner_weights(m, i) + (1 - t) * corner_weights(m, j);
    }

    // Coordinates of a known shape in a subspace, and of the nearest one in weights.
    Eigen::VectorXd nearest(const Subspace& subspace, const Weights& w) const
    {
        double best = std::numeric_limits<double>::max();
        Eigen::VectorXd q;
        const auto consider = [&](const Weights& known, const auto& coordinates) {
            const double distance = (known - w).norm();
            if (distance >= best) return;
            best = distance;
            q = coordinates() + subspace.pose_coordinates * (w - known);
        };
        for (const Check& s : snapshots_) consider(s.w, [&] { return project(subspace, s.truth, set_.masses); });
        for (std::size_t k = 0; k < set_.pose_count(); ++k)
            consider(corner_weights(set_.pose_count(), k),
                     [&] { return Eigen::VectorXd(subspace.pose_coordinates.col(Eigen::Index(k))); });
        return q;
    }

    Shape solve_reduced(const Subspace& subspace, const Eigen::MatrixXd& metric, const Weights& w) const
    {
        const ReducedEnergy reduced(solver_.energy(), subspace);
        MinimiseOptions options;
        options.tolerance = 1e-4; // in the energy metric: leaves well below a tolerance of 1e-4 in shape
        options.scale = scale_;
        const Objective objective
            = [&](const Eigen::VectorXd& q, Eigen::VectorXd& gradient) { return reduced.gradient(w, q, gradient); };
        return subspace.shape(minimise(objective, nearest(subspace, w), metric, options).q);
    }

    Eigen::MatrixXd reduced_mean_hessian(const Subspace& subspace) const
    {
        return subspace.basis.transpose() * (mean_hessian_.selfadjointView<Eigen::Lower>() * subspace.basis);
    }

    // Reduced solution at w, and the truth next to it.
    Check check(const Weights& w)
    {
        ++report_.check_count;
        tell(fmt::format("d = {}, check {}", subspace_.dimension(), report_.check_count));
        const Shape blend = solve_reduced(subspace_, metric_, w);
        NewtonResult truth = solver_.minimise(w, blend, newton_);
        report_.unconverged_count += !truth.has_converged;
        fix_gauge(set_, truth.y);
        const double error = relative_distance(set_, blend, truth.y);
        return { w, std::move(truth.y), error };
    }

    // Mean and largest error over the held-out checks, solved anew in `subspace`.
    double measure(const Subspace& subspace)
    {
        const Eigen::MatrixXd metric = metric_from(reduced_mean_hessian(subspace));
        double sum = 0, largest = -1;
        for (const Check& c : held_out_) {
            const double error = relative_distance(set_, solve_reduced(subspace, metric, c.w), c.truth);
            sum += error / double(held_out_.size());
            if (error > largest) largest = error, report_.worst_weights = c.w;
        }
        report_.snapshot_count = int(snapshots_.size());
        report_.mean_error = sum;
        report_.largest_error = largest;
        report_.meets_tolerance = sum < options_.tolerance;
        return sum;
    }

    // The smallest dimension that keeps the tolerance with a third to spare for the stand-in; the error falls with d, so bisection.
    Subspace truncate()
    {
        const Eigen::MatrixXd all = directions();
        Eigen::Index low = Eigen::Index(set_.pose_count()) - 1,
                     high = std::min(subspace_.dimension(), options_.max_dimension);
        while (low < high) {
            tell(fmt::format("truncating: d between {} and {}", low, high));
            const Eigen::Index middle = (low + high) / 2;
            if (measure(build_subspace(set_, all, middle)) < 0.67 * options_.tolerance)
                high = middle;
            else
                low = middle + 1;
        }
        return build_subspace(set_, all, high);
    }

    NewtonSolver& solver_;
    const ShapeSet& set_;
    const AdaptiveOptions& options_;
    Progress* progress_;
    AdaptiveReport& report_;
    NewtonOptions newton_;
    Random random_;
    std::vector<Check> snapshots_, held_out_;
    Subspace subspace_;
    SparseLower mean_hessian_;        // at the average of all poses
    Eigen::MatrixXd reduced_hessian_; // the same in subspace_
    Eigen::MatrixXd metric_;          // its inverse
    double scale_ = 1;
};

} // namespace

Subspace build_adaptive_subspace(NewtonSolver& solver, const AdaptiveOptions& options, Progress* progress,
                                 AdaptiveReport& report)
{
    return Builder(solver, options, progress, report).build();
}

} // namespace pliant
