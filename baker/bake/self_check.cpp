#include "bake/self_check.h"

#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "base/mesh/tets.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/average/shape_error.h"
#include "elastic/energy/energy.h"
#include "elastic/parts/tied_energy.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>
#include <fmt/core.h>
#include <optional>
#include <utility>

namespace pliant {

namespace {

// Added to the seed, so that fresh weights are neither training weights nor checks.
constexpr std::uint64_t fresh_seed = 2000003;

// Of a limited time: when the last fresh averages are to be known.
constexpr double fresh_share = 0.95;

constexpr std::size_t answer_count = 8;

std::vector<float> to_floats(const Weights& w)
{
    const Eigen::VectorXf f = w.cast<float>();
    return std::vector<float>(f.data(), f.data() + f.size());
}

Eigen::VectorXf to_vector(const std::vector<float>& q)
{
    return Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size()));
}

// An asset opened by the runtime. Blends are those of a new solver.
class OpenedAsset {
public:
    OpenedAsset(const AssetModel& asset, const TrainingSet& training)
        : asset_(asset)
        , blender_(opened(encode_asset(asset, provisional_record(asset, training))))
    {
    }

    RuntimeBlender& blender() { return blender_; }
    Eigen::VectorXf solve(const Weights& w) { return to_vector(blender_.solve(to_floats(w), false)); }
    Shape blend(const Weights& w)
    {
        return from_input_units(asset_.set, blender_.positions(blender_.solve(to_floats(w), false)));
    }

private:
    static RuntimeBlender opened(const std::vector<std::uint8_t>& bytes)
    {
        try {
            return RuntimeBlender(bytes, "the asset just baked");
        } catch (const Failure& failure) {
            Diagnostic diagnostic = failure.diagnostics().at(0);
            diagnostic.hint = "single precision does not hold its numbers: leave out --preview or the limit of time, or the "
                              "pose that is stretched or pressed most";
            throw Failure(ExitCode::failed, diagnostic);
        }
    }

    // The format wants an answer; nothing here asks for it.
    static AssetRecord provisional_record(const AssetModel& asset, const TrainingSet& training)
    {
        AssetRecord record;
        record.answers = { { training.weights[0], asset.shape.frame.stored(asset.model.mean).cast<float>() } };
        return record;
    }

    const AssetModel& asset_;
    RuntimeBlender blender_;
};

// The runtime's answers at the mean, at edge mid-points and between. They go into the asset as its own test.
std::vector<Answer> collect_answers(OpenedAsset& opened, const TrainingSet& training)
{
    std::vector<Answer> answers;
    for (std::size_t t = 0; t < std::min(training.weights.size(), answer_count); ++t)
        answers.push_back({ training.weights[t], opened.solve(training.weights[t]) });
    return answers;
}

// The largest distance of the runtime from the model in double precision at the weights of the answers, relative L2. The
// solver is left tight.
double compare_with_model(OpenedAsset& opened, const AssetModel& asset, const std::vector<Answer>& answers)
{
    opened.blender().solve_tightly(); // to compare the arithmetic, not the stopping rule
    double largest = 0;
    for (const Answer& answer : answers) {
        const Eigen::VectorXd exact = asset.model.solve(answer.weights).q;
        const Eigen::VectorXd found = asset.shape.frame.coordinates(opened.solve(answer.weights).cast<double>());
        // U is mass-orthonormal and the mass is 1: distances in q are distances of shapes.
        const double size = mass_norm(asset.subspace.shape(exact), asset.set.masses);
        largest = std::max(largest, (found - exact).norm() / size);
    }
    return largest;
}

// Triangles are compared with the smallest that they are in any pose, tetrahedra with the largest: that is the smallest J.
double smallest_cell_ratio(const NormalizedPoses& set, const Shape& blend)
{
    Eigen::VectorXd unit = cell_sizes(set, set.shapes[0]);
    for (const Shape& shape : set.shapes) {
        const Eigen::VectorXd sizes = cell_sizes(set, shape);
        unit = set.is_solid() ? unit.cwiseMax(sizes).eval() : unit.cwiseMin(sizes).eval();
    }
    return cell_sizes(set, blend).cwiseQuotient(unit).minCoeff();
}

// Unreduced averages at fresh weights, and whether another one is next to the blend.
std::vector<CheckPoint> fresh_averages(OpenedAsset& opened, const FitProblem& problem, const BakeOptions& options,
                                       Progress& progress)
{
    const std::vector<Weights> fresh = problem.domain.draw_all(options.seed + fresh_seed, std::size_t(options.fresh_count));
    std::vector<CheckPoint> points = problem.known.find_in_time(fresh, "fresh averages", problem.budget.part(fresh_share));
    std::vector<Shape> blends;
    for (const CheckPoint& point : points) blends.push_back(opened.blend(point.weights));
    SharedProgress shared(&progress);
    shared.describe("check", 0, fmt::format("averages next to {} blends", points.size()));
    for_each_task(points.size(), [&](std::size_t i, std::size_t worker) {
        const AverageFamily& family = problem.family;
        // Where the interpolation was right, the average is on the branch of the mean; else it is followed from there, if
        // there is time.
        if (points[i].error > branch_distance / 2 && !problem.budget.is_spent())
            points[i] = family.point_at(points[i].weights, worker, &shared);
        family.compare(points[i], blends[i], worker, &shared);
    });
    return points;
}

// In the order in which the kinds appear.
std::vector<KindErrors> errors_by_kind(const std::vector<BlendCheck>& blends)
{
    std::vector<KindErrors> kinds;
    for (const BlendCheck& check : blends) {
        auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const KindErrors& k) { return k.kind == check.kind; });
        if (kind == kinds.end()) {
            kind = kinds.insert(kind, KindErrors());
            kind->kind = check.kind;
        }
        if (!check.has_converged) {
            ++kind->lost_count;
            continue;
        }
        const double count = double(++kind->count), error = check.error.relative_l2;
        kind->mean += (error - kind->mean) / count;
        kind->linear_mean += (check.linear_error - kind->linear_mean) / count;
        kind->largest = std::max(kind->largest, error);
        kind->linear_largest = std::max(kind->linear_largest, check.linear_error);
    }
    return kinds;
}

// Whether the tolerance is judged by this blend. An average that did not converge is near enough to be compared with; layers
// for which no shape was found have none.
bool is_judged(const BlendCheck& check, const WeightDomain& domain)
{
    return domain.is_counted(check.weights) && (check.has_converged || !domain.is_box());
}

CheckReport summarize(std::vector<BlendCheck> blends, const WeightDomain& domain, const BakeOptions& options)
{
    CheckReport report;
    report.blends = std::move(blends);
    double count = 0;
    for (const BlendCheck& check : report.blends) {
        if (!is_judged(check, domain)) continue;
        report.mean_error += check.error.relative_l2;
        report.linear_error += check.linear_error;
        ++count;
        report.largest_distance = std::max(report.largest_distance, check.error.largest_distance);
        report.cell_ratio = std::min(report.cell_ratio, check.cell_ratio);
        if (check.error.relative_l2 < report.largest_error) continue;
        report.largest_error = check.error.relative_l2;
        report.worst_weights = check.weights;
    }
    report.mean_error /= std::max(count, 1.0);
    report.linear_error /= std::max(count, 1.0);
    report.meets_tolerance
        = count > 0 && report.mean_error <= options.tolerance
        && (options.tolerance_max == 0 || report.largest_error <= options.tolerance_max)
        && std::none_of(report.blends.begin(), report.blends.end(), [&](const BlendCheck& check) {
               return is_judged(check, domain) && check.is_near_jump && check.error.relative_l2 > options.tolerance;
           });
    if (domain.is_box()) report.kinds = errors_by_kind(report.blends);
    return report;
}

// Blends next to the averages at `points`, the last `fresh_count` of which nothing was chosen by.
CheckReport compare_with_averages(OpenedAsset& opened, const FitProblem& problem, const std::vector<CheckPoint>& points,
                                  std::size_t fresh_count, const BakeOptions& options)
{
    const SolverPool& pool = problem.family.pool();
    const NormalizedPoses& set = pool.set();
    const TieSet* ties = ties_of(pool.energy());
    std::optional<TieReport> tie_report;
    if (ties) tie_report = start_tie_report(*ties, set, problem.domain);
    std::vector<BlendCheck> blends;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const CheckPoint& point = points[i];
        const Shape blend = opened.blend(point.weights);
        blends.push_back({ point.weights, shape_error(pool.energy(), set, point.weights, blend, point.reference),
                           smallest_cell_ratio(set, blend), i + fresh_count >= points.size(), point.has_converged,
                           !point.branches.empty() });
        if (problem.domain.is_box()) {
            blends.back().kind = problem.domain.kind_of(point.weights, i);
            blends.back().linear_error = relative_error(set, linear_blend(set, point.weights), point.reference);
        }
        if (ties) add_check(*ties, set, point.weights, point.reference, blend, *tie_report);
    }
    CheckReport report = summarize(std::move(blends), problem.domain, options);
    report.ties = std::move(tie_report);
    return report;
}

// A pose that blends do not reach misses the tolerance, however good the mean is: that of the largest error, too.
void judge_poses(OpenedAsset& opened, const FitProblem& problem, const BakeOptions& options, CheckReport& report)
{
    const WeightDomain& domain = problem.domain;
    const double allowed
        = options.tolerance_max > 0 ? std::min(options.tolerance, options.tolerance_max) : options.tolerance;
    for (std::size_t k = 0; k < problem.set.pose_count(); ++k) {
        if (domain.is_box() && k > 0 && domain.ranges()[k - 1].high < 1) continue; // no blend goes there
        const Weights weights = weights_of_pose(problem.energy, k);
        const double error = relative_error(problem.set, opened.blend(weights), problem.set.shapes[k]);
        if (error <= allowed) continue;
        report.meets_tolerance = false;
        if (error <= report.largest_error) continue;
        report.largest_error = error;
        report.worst_weights = weights;
    }
}

std::vector<Branch> found_branches(const std::vector<CheckPoint>& points)
{
    std::vector<Branch> branches;
    for (const CheckPoint& point : points) branches.insert(branches.end(), point.branches.begin(), point.branches.end());
    return branches;
}

// Where blends turn at once between the mean and a pose: the place closest to pose 0 may flip. Layers lie at places of their
// own.
void find_turns(OpenedAsset& opened, const FitProblem& problem, std::vector<Branch>& branches)
{
    constexpr int step_count = 16;
    constexpr double turned = 60; // degrees in a step
    const NormalizedPoses& set = problem.family.pool().set();
    if (problem.domain.is_box() || !set.is_free()) return;
    const Weights mean = equal_weights(set.pose_count());
    const Shape first = opened.blend(mean);
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        Shape here = first;
        for (int step = 1; step <= step_count; ++step) {
            const Weights w = mean + double(step) / step_count * (corner_weights(set.pose_count(), k) - mean);
            Shape next = opened.blend(w);
            if (degrees_of(best_rigid_motion(here, next, set.masses)) > turned) {
                Eigen::Index farthest = 0;
                Eigen::Matrix3Xd((next - here).reshaped(3, set.masses.size())).colwise().squaredNorm().maxCoeff(&farthest);
                branches.push_back(
                    { Branch::Kind::turn, w, k, relative_move(set, here, next), static_cast<std::size_t>(farthest) });
            }
            here = std::move(next);
        }
    }
}

// Positions that the runtime rebuilds at these coordinates against the subspace in double precision.
BasisReport check_basis(const RuntimeBlender& blender, const AssetModel& asset, const Eigen::MatrixXd& reachable)
{
    const NormalizedPoses& set = asset.set;
    BasisReport report;
    report.is_compact = !asset.shape.basis.empty();
    const double numbers = 3.0 * double(blender.asset().vertex_count) * double(asset.subspace.dimension());
    report.bytes_per_number = double(basis_size(blender.asset())) / numbers;
    for (Eigen::Index i = 0; i < reachable.cols(); ++i) {
        const Shape shape = asset.subspace.shape(reachable.col(i));
        const Shape exact = asset.mesh.embedding ? Shape(apply(*asset.mesh.embedding, shape)) : shape;
        const std::vector<float> found = blender.positions(to_floats(asset.shape.frame.stored(reachable.col(i))));
        const Shape off = from_input_units(set, found) - exact;
        for (Eigen::Index v = 0; v < off.size(); v += 3)
            report.largest_difference = std::max(report.largest_difference, off.segment<3>(v).norm() / set.diagonal);
    }
    return report;
}

// What is written beside the asset, but for its certificate.
AssetRecord make_record(OpenedAsset& opened, const TrainingSet& training)
{
    AssetRecord record;
    record.morph_ranges = find_morph_ranges(opened.blender());
    record.answers = collect_answers(opened, training);
    return record;
}

} // namespace

CheckedAsset self_check(const CheckProblem& p, const BakeOptions& options, Progress& progress)
{
    const NormalizedPoses& set = p.fit.set;
    const TrainingSet& training = p.fitted.training;
    const Eigen::MatrixXd reachable = reachable_coordinates(p.fitted);
    const auto assemble_with = [&](StoredMesh mesh) {
        return assemble(set, p.fit.domain, p.fitted, std::move(mesh), p.poses, reachable, options);
    };
    const AssetModel simulated = assemble_with(simulation_mesh(p.poses, set, options));
    OpenedAsset opened(simulated, training);
    const std::vector<CheckPoint> fresh = fresh_averages(opened, p.fit, options, progress);
    std::vector<CheckPoint> points = p.fit.found.checks;
    points.insert(points.end(), fresh.begin(), fresh.end());
    CheckReport report = compare_with_averages(opened, p.fit, points, fresh.size(), options);
    judge_poses(opened, p.fit, options, report);
    std::vector<Branch> branches = found_branches(points);
    find_turns(opened, p.fit, branches);
    const auto complete = [&](OpenedAsset& last, AssetModel asset) -> CheckedAsset {
        report.basis = check_basis(last.blender(), asset, reachable);
        AssetRecord record = make_record(last, training);
        report.runtime_error = std::max(report.runtime_error, compare_with_model(last, asset, record.answers));
        return { std::move(asset), std::move(record), std::move(report), branches };
    };
    const std::shared_ptr<const RenderMesh> drawn = render_mesh_of(p.poses, options);
    if (!drawn) return complete(opened, simulated);
    report.runtime_error = compare_with_model(opened, simulated, collect_answers(opened, training));
    // Its coordinates may be others: what single precision does as well stays in it.
    const AssetModel rendered = assemble_with(stored_render_mesh(*drawn, p.poses, options));
    OpenedAsset opened_rendered(rendered, training);
    // Welded vertices are rows of the simulation mesh, so what was found at these holds there, too.
    if (options.render_mesh)
        report.render_mesh = check_render_mesh(opened_rendered.blender(), set, *options.render_mesh, points);
    return complete(opened_rendered, rendered);
}

} // namespace pliant
