#include "elastic/average/family.h"

#include "base/common/parallel.h"
#include "base/mesh/tets.h"
#include "elastic/average/prolongation.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fmt/core.h>

namespace pliant {

namespace {

// In the 1-norm of weights, of layers in the largest of them: any number of layers may grow together. The way from a corner
// to the mean is gone roughly, in long steps: only where it ends counts. Elsewhere steps begin shorter, grow while the
// tangent's guess is good to a quarter of what is allowed, and are halved where it is not good enough.
constexpr double rough_step = 0.85, first_step = 0.5;

// A discontinuity is a move that does not get shorter with the step. Steps are not halved below this.
constexpr double shortest_step = 0.03;

// For the sake of a small correction they are not made shorter than this: where triangles turn, tangents are never good.
constexpr double shortest_sure_step = 0.2;

// Moves faster than this many times the mean's way to a pose, and longer than 5 %, are looked at closer: well above what a
// family that turns a limb evenly needs, and a false alarm costs halved steps only.
constexpr double jump_speed = 6, jump_distance = 0.05;

// Newton creeps where creases snap; only what is farther than this from converged calls for a shorter step.
constexpr double hopeless_decrement = 1e-2;

// Means from different poses are computed roughly, and compared with that in mind: energies, and distances.
constexpr double energy_doubt = 0.02, rough_distance = 0.05;

// The mean of the full mesh is looked for no farther than this from that of the coarse one.
constexpr double refinement_limit = 0.1;

// Newton's method from a sum of poses takes no more iterations than this; where it needs more, the line is followed.
constexpr int sum_iterations = 15;

// The same where no line is followed afterwards: one shape more or less makes no difference.
constexpr int short_sum_iterations = 8;

// A tangent step may change the areas of triangles, the volumes of tetrahedra by this factor.
constexpr double sound_stretch = 1.5;

} // namespace

std::size_t farthest_vertex(const NormalizedPoses& set, const Shape& a, const Shape& b)
{
    Shape moved = b;
    align_to(set, a, moved);
    Eigen::Index farthest = 0;
    const Eigen::Map<const Eigen::Matrix3Xd> from(a.data(), 3, a.size() / 3), to(moved.data(), 3, a.size() / 3);
    (from - to).colwise().squaredNorm().maxCoeff(&farthest);
    return std::size_t(farthest);
}

// A walk through weight space with the average at its end.
struct AverageFamily::Path {
    NewtonSolver& solver;
    Progress* progress;
    Weights w;
    NewtonResult point;
    std::vector<Branch> jumps;
    bool has_factor = false;      // the solver's last factor is that of the point
    std::optional<Shape> tangent; // at the point, for the whole way that is left; until the next point
};

AverageFamily::AverageFamily(SolverPool& pool, NewtonOptions options, Progress* progress,
                             std::optional<std::size_t> start_pose, const CoarseBody* coarse)
    : pool_(pool)
    , placement_(pool.set())
    , options_(options)
    , progress_(progress)
    , start_pose_(start_pose)
    , coarse_(coarse)
{
}

// Along the tangent, by the derivative of the minimizer, as far as it is sound: it has a lower energy all the way and
// stretches little, for what is stretched Newton may undo by folding creases.
Shape AverageFamily::start_of_step(Path& path, const Weights& to, double share) const
{
    const Shape& here = path.point.y;
    if (!path.tangent) {
        // At a point that is only roughly an average the exact Hessian may be indefinite.
        if (!path.has_factor) path.solver.factorize_equilibrium(path.w, here, HessianKind::projected);
        path.tangent = path.solver.rough_weight_derivatives(path.w, here, to - path.w);
    }
    const Weights next = path.w + share * (to - path.w);
    const Eigen::VectorXd sizes = cell_sizes(pool_.set(), here);
    const double energy = energy_value(pool_.energy(), next, here);
    for (double length = 1; length > 0.2; length /= 2) {
        Shape guess = path.solver.moved(here, length * share * *path.tangent);
        const Eigen::VectorXd ratios = cell_sizes(pool_.set(), guess).cwiseQuotient(sizes);
        if (ratios.minCoeff() > 1 / sound_stretch && ratios.maxCoeff() < sound_stretch
            && energy_value(pool_.energy(), next, guess) < energy)
            return guess;
    }
    return here;
}

// Predictor-corrector. Points on the way need few digits.
void AverageFamily::follow(Path& path, const Weights& to, bool is_rough) const
{
    const NormalizedPoses& set = pool_.set();
    NewtonOptions rough = options_, fine = options_;
    fine.step_ratio = 0; // the way from the last point of the path says nothing about the accuracy wanted
    rough.step_ratio = 0.1;
    rough.decrement = std::max(options_.decrement, 1e-4);
    rough.step_decrement = 1e-3;
    rough.residual = std::max(options_.residual, 0.1);
    rough.max_iterations = std::min(options_.max_iterations, 12); // more: the step is too long
    int iterations = 0, step_count = 0;
    const int first_count = path.solver.factorization_count();
    double length = is_rough ? rough_step : first_step;
    for (double left = step_length(to - path.w); left > 1e-12; left = step_length(to - path.w)) {
        // Steps along layers that agree cost no factorisation.
        if (path.solver.factorization_count() - first_count > factorization_limit() || ++step_count > path_limit) {
            path.point.has_converged = false;
            break;
        }
        const double share = 1 / std::max(1.0, std::ceil(left / length - 1e-9));
        const Weights next = share == 1 ? to : Weights(path.w + share * (to - path.w));
        const double step = share * left, change = share * (to - path.w).lpNorm<1>();
        const bool is_last = share == 1;
        const Shape guess = start_of_step(path, to, share);
        NewtonResult reached = path.solver.minimize(next, guess, is_last && !is_rough ? fine : rough, path.progress);
        iterations += reached.iterations;
        const double moved = relative_distance(set, reached.y, path.point.y);
        const double corrected = is_rough ? 0 : relative_distance(set, reached.y, guess);
        const bool is_fast = speed_ > 0 && moved > jump_distance && moved > jump_speed * speed_ * change;
        const bool is_hopeless = !reached.has_converged && reached.decrement > hopeless_decrement;
        if ((is_fast || is_hopeless) && step > 2 * shortest_step) {
            length = step / 2;
            continue;
        }
        if (corrected > correction_limit && step > shortest_sure_step) {
            length = step / 2;
            continue;
        }
        if (is_fast) {
            path.jumps.push_back({ Branch::Kind::jump, next, growing_pose(to - path.w), moved,
                                   farthest_vertex(set, path.point.y, reached.y) });
        }
        if (corrected < correction_limit / 4) length = std::min(2 * length, rough_step);
        path.point = std::move(reached);
        path.w = next;
        path.tangent.reset();
        path.has_factor = true;
    }
    path.point.iterations = iterations;
    placement_.place(path.w, path.point.y);
}

FamilyPoint AverageFamily::reach_mean(std::size_t pose, std::size_t worker, Progress* progress) const
{
    const std::size_t m = pool_.set().pose_count();
    Path path { pool_.at(worker), progress, corner_weights(m, pose), {}, {}, false, {} };
    path.point.y = pool_.set().shapes[pose];
    path.point.has_converged = true;
    follow(path, equal_weights(m), true);
    return { std::move(path.point), {} };
}

// The average of the full mesh next to that of the coarse one. False: there is none.
bool AverageFamily::refine_coarse_mean()
{
    const NormalizedPoses& set = pool_.set();
    SolverPool coarse_pool(*coarse_->energy, coarse_->poses.set, pool_.kind());
    AverageFamily coarse(coarse_pool, options_, progress_, start_pose_, coarse_->coarser.get());
    coarse.mean();
    SharedProgress progress(progress_);
    progress.describe("mean", 0.5, "on the full mesh");
    const Weights w = equal_weights(set.pose_count());
    const Shape guess = prolong(set, coarse_->poses, coarse.start_pose(), w, coarse.mean().y, pool_.kind());
    NewtonResult fine = near(pool_.at(0).settled(w, guess), w, 0, &progress);
    if (!fine.has_converged || !(relative_distance(set, fine.y, guess) <= refinement_limit)) return false;
    start_pose_ = coarse.start_pose();
    mean_ = std::move(fine);
    branches_ = coarse.branches();
    for (Branch& branch : branches_) branch.vertex = coarse_->poses.vertices[branch.vertex];
    return true;
}

int AverageFamily::factorization_limit() const { return has_layers() ? layered_path_limit : path_limit; }

Weights AverageFamily::centre() const
{
    return has_layers() ? weights_of_pose(pool_.energy(), 0) : equal_weights(pool_.set().pose_count());
}

double AverageFamily::step_length(const Weights& change) const
{
    return has_layers() ? change.lpNorm<Eigen::Infinity>() : change.lpNorm<1>();
}

std::size_t AverageFamily::growing_pose(const Weights& change) const
{
    Eigen::Index largest = 0;
    if (has_layers()) {
        change.cwiseAbs().maxCoeff(&largest);
        return std::size_t(largest) + 1;
    }
    change.maxCoeff(&largest);
    return std::size_t(largest);
}

const NewtonResult& AverageFamily::mean()
{
    if (mean_) return *mean_;
    if (has_layers()) {
        mean_ = NewtonResult {};
        mean_->y = pool_.set().shapes[0];
        mean_->has_converged = true;
        start_pose_ = 0;
        sum();
    } else if (!coarse_ || !refine_coarse_mean()) {
        search_mean();
    }
    for (std::size_t k = has_layers() ? 1 : 0; k < pool_.set().pose_count(); ++k)
        speed_ = std::max(speed_,
                          relative_distance(pool_.set(), mean_->y, pool_.set().shapes[k])
                              / (weights_of_pose(pool_.energy(), k) - centre()).lpNorm<1>());
    return *mean_;
}

const PoseSum& AverageFamily::sum()
{
    if (!sum_) sum_.emplace(pool_, mean_->y);
    return *sum_;
}

void AverageFamily::search_mean()
{
    const NormalizedPoses& set = pool_.set();
    const std::size_t m = set.pose_count();
    std::vector<FamilyPoint> means(m);
    std::vector<std::size_t> starts;
    for (std::size_t k = 0; k < m; ++k)
        if (!start_pose_ || k == *start_pose_) starts.push_back(k);
    SharedProgress progress(progress_);
    std::atomic<std::size_t> done { 0 };
    const auto describe
        = [&](const std::string& what) { progress.describe("mean", double(done) / double(starts.size() + 1), what); };
    for_each_task(starts.size(), [&](std::size_t i, std::size_t worker) {
        if (worker == 0) describe(fmt::format("from {} of {} poses", done.load(), starts.size()));
        means[starts[i]] = reach_mean(starts[i], worker, &progress);
        ++done;
    });
    describe("last steps");
    // Rough energies are good to a few per cent: all that may be the lowest are polished.
    const Weights w = equal_weights(m);
    double lowest = means[starts[0]].average.energy;
    for (std::size_t k : starts) lowest = std::min(lowest, means[k].average.energy);
    std::size_t best = m;
    for (std::size_t k : starts) {
        NewtonResult& average = means[k].average;
        if (average.energy - lowest > energy_doubt * std::abs(lowest)) continue;
        if (best < m && relative_distance(set, average.y, means[best].average.y) < branch_distance) continue; // the same one
        NewtonResult fine = pool_.at(0).minimize(w, average.y, options_, &progress);
        placement_.place(w, fine.y);
        average = std::move(fine);
        // Energies closer than Newton's accuracy are those of one average: the first pose stands for it.
        if (best == m || average.energy < means[best].average.energy * (1 - 1e-5)) best = k;
    }
    for (std::size_t k : starts) {
        const Shape& other = means[k].average.y;
        const double distance = relative_distance(set, other, means[best].average.y);
        if (distance > rough_distance)
            branches_.push_back(
                { Branch::Kind::other_mean, w, k, distance, farthest_vertex(set, means[best].average.y, other) });
    }
    start_pose_ = best;
    mean_ = std::move(means[best].average);
}

double AverageFamily::energy_scale(const WeightDomain& domain)
{
    if (!has_layers()) return std::max(mean().energy, least_energy_scale);
    double sum = 0;
    for (std::size_t layer = 0; layer < domain.size(); ++layer) {
        const Weights whole = domain.full(layer) * corner_weights(domain.size(), layer);
        sum += energy_value(pool_.energy(), whole, pool_.set().shapes[0]);
    }
    return std::max(sum / (4 * double(domain.size())), least_energy_scale);
}

std::size_t AverageFamily::start_pose()
{
    mean();
    return *start_pose_;
}

const SparseLower& AverageFamily::mean_hessian()
{
    if (!mean_hessian_) {
        HessianAssembler assembler(pool_.energy());
        assembler.assemble(centre(), mean().y, HessianKind::exact);
        mean_hessian_ = assembler.matrix();
    }
    return *mean_hessian_;
}

FamilyPoint AverageFamily::from(const KnownAverage& known, const Weights& w, std::size_t worker, Progress* progress) const
{
    Path path { pool_.at(worker), progress, known.weights, {}, {}, false, {} };
    path.point.y = known.shape;
    path.point.has_converged = true;
    path.point.energy = energy_value(pool_.energy(), w, known.shape);
    follow(path, w, false);
    return { std::move(path.point), std::move(path.jumps) };
}

FamilyPoint AverageFamily::at(const Weights& w, std::size_t worker, Progress* progress) const
{
    // A hair away from the mean is rounding of the division by the sum of the weights.
    if ((w - centre()).lpNorm<1>() < 1e-12) return { *mean_, {} };
    if (has_layers()) return from_guess(w, sum_->guess(w, sum_->turned(w, worker), nullptr), true, worker, progress);
    return from({ centre(), mean_->y }, w, worker, progress);
}

FamilyPoint AverageFamily::at_or_near_pose(const Weights& w, std::size_t worker, Progress* progress) const
{
    FamilyPoint point = at(w, worker, progress);
    if (point.average.has_converged || has_layers()) return point;
    const NormalizedPoses& set = pool_.set();
    std::optional<NewtonResult> lowest;
    std::size_t from = 0;
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        if (w[Eigen::Index(k)] == 0) continue;
        NewtonResult result = near(set.shapes[k], w, worker, progress);
        if (!result.has_converged || (lowest && result.energy >= lowest->energy)) continue;
        lowest = std::move(result);
        from = k;
    }
    if (!lowest) return point;
    const Shape& left = point.average.y;
    point.jumps.push_back(
        { Branch::Kind::jump, w, from, relative_distance(set, lowest->y, left), farthest_vertex(set, lowest->y, left) });
    point.average = std::move(*lowest);
    return point;
}

// Newton's method from there; not converged where it has no finite energy.
NewtonResult AverageFamily::beside_guess(const Weights& w, const Shape& guess, int iterations, std::size_t worker,
                                         Progress* progress) const
{
    NewtonOptions options = options_;
    options.max_iterations = std::min(options_.max_iterations, iterations);
    NewtonResult result;
    result.y = guess;
    if (std::isfinite(energy_value(pool_.energy(), w, guess)))
        result = pool_.at(worker).minimize(w, guess, options, progress);
    placement_.place(w, result.y);
    return result;
}

FamilyPoint AverageFamily::from_guess(const Weights& w, const Shape& guess, bool may_follow, std::size_t worker,
                                      Progress* progress) const
{
    NewtonResult beside = beside_guess(w, guess, may_follow ? sum_iterations : short_sum_iterations, worker, progress);
    if (beside.has_converged && relative_distance(pool_.set(), beside.y, guess) <= correction_limit)
        return { std::move(beside), {} };
    // Beyond some stretch a rest state is no number any more.
    if (!may_follow || !std::isfinite(energy_value(pool_.energy(), w, mean_->y))) return { std::move(beside), {} };
    FamilyPoint point = from({ centre(), mean_->y }, w, worker, progress);
    if (!point.average.has_converged && beside.has_converged) point.average = std::move(beside);
    return point;
}

CheckPoint AverageFamily::point_at(const Weights& w, std::size_t worker, Progress* progress) const
{
    FamilyPoint point = at(w, worker, progress);
    return { w, std::move(point.average.y), 0, 0, point.average.has_converged, std::move(point.jumps) };
}

NewtonResult AverageFamily::near(const Shape& shape, const Weights& w, std::size_t worker, Progress* progress,
                                 bool has_near_factor) const
{
    NewtonOptions options = options_;
    options.has_near_factor = has_near_factor;
    NewtonResult result = pool_.at(worker).minimize(w, shape, options, progress);
    placement_.place(w, result.y);
    return result;
}

void AverageFamily::compare(CheckPoint& point, const Shape& blend, std::size_t worker, Progress* progress,
                            std::optional<NewtonResult> beside) const
{
    const NormalizedPoses& set = pool_.set();
    point.error = point.nearest_error = relative_error(set, blend, point.reference);
    if (point.error < branch_distance / 2 && point.has_converged) return;
    if (!beside) beside = near(pool_.at(worker).settled(point.weights, blend), point.weights, worker, progress);
    point.nearest_error = relative_error(set, blend, beside->y);
    const double distance = relative_distance(set, beside->y, point.reference);
    if (distance > branch_distance) {
        point.branches.push_back({ Branch::Kind::other_path, point.weights, growing_pose(point.weights), distance,
                                   farthest_vertex(set, point.reference, beside->y) });
    }
    if (!point.has_converged && beside->has_converged) {
        point.reference = std::move(beside->y);
        point.has_converged = true;
    }
    point.error = relative_error(set, blend, point.reference);
}

CheckPoint AverageFamily::check(const Weights& w, const Shape& blend, double suspicion, std::size_t worker,
                                Progress* progress) const
{
    std::optional<NewtonResult> beside;
    if (suspicion > 0) {
        beside = near(pool_.at(worker).settled(w, blend), w, worker, progress);
        const double error = relative_error(pool_.set(), blend, beside->y);
        if (error <= suspicion && beside->has_converged) return { w, std::move(beside->y), error, error, true, {} };
    }
    CheckPoint point = point_at(w, worker, progress);
    compare(point, blend, worker, progress, std::move(beside));
    return point;
}

} // namespace pliant
