#include "bake/self_check.h"

#include "elastic/parts/tied_energy.h"

#include "base/common/parallel.h"
#include "base/mesh/tets.h"
#include "elastic/average/rigid_modes.h"
#include "output/asset/runtime_blender.h"
#include "pliant_format.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <iterator>

namespace pliant {

namespace {

std::vector<float> to_floats(const Weights& w)
{
    const Eigen::VectorXf f = w.cast<float>();
    return std::vector<float>(f.data(), f.data() + f.size());
}

} // namespace

void collect_answers(AssetModel& asset, const BlendModel& model, const TrainingSet& training, BakeReport& report)
{
    // A first encoding to let the real runtime answer.
    asset.answers = { { training.weights[0], asset.stored->frame.stored(asset.mean).cast<float>() } };
    RuntimeBlender blender(encode_asset(asset), "the asset just baked"),
        tight = RuntimeBlender(encode_asset(asset), "the same");
    asset.answers.clear();
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-5f; // to compare the arithmetic, not the stopping rule
    tight.configure(desc);
    const std::size_t count = std::min<std::size_t>(training.weights.size(), 8);
    for (std::size_t t = 0; t < count; ++t) {
        const std::vector<float> w = to_floats(training.weights[t]), q = blender.solve(w, false),
                                 fine = tight.solve(w, false);
        asset.answers.push_back(
            { training.weights[t], Eigen::Map<const Eigen::VectorXf>(q.data(), Eigen::Index(q.size())) });
        const Eigen::VectorXd exact = model.solve(training.weights[t]).q;
        const Eigen::VectorXd found = asset.stored->frame.coordinates(
            Eigen::Map<const Eigen::VectorXf>(fine.data(), Eigen::Index(fine.size())).cast<double>());
        // U is mass-orthonormal and the mass is 1: distances in q are distances of shapes.
        const double size = mass_norm(asset.subspace->shape(exact), asset.set->masses);
        report.runtime_error = std::max(report.runtime_error, (found - exact).norm() / size);
    }
}

namespace {

// Triangles are compared with the smallest that they are in any pose, tetrahedra with the largest: that is the smallest J.
double smallest_cell_ratio(const ShapeSet& set, const Shape& blend)
{
    Eigen::VectorXd unit = cell_sizes(set, set.shapes[0]);
    for (const Shape& shape : set.shapes) {
        const Eigen::VectorXd sizes = cell_sizes(set, shape);
        unit = set.is_solid() ? unit.cwiseMax(sizes).eval() : unit.cwiseMin(sizes).eval();
    }
    return cell_sizes(set, blend).cwiseQuotient(unit).minCoeff();
}

void judge(const BakeOptions& options, BakeReport& report)
{
    for (const AssetCheck& check : report.checks) {
        report.mean_error += check.error.relative_l2 / double(report.checks.size());
        report.largest_distance = std::max(report.largest_distance, check.error.largest_distance);
        report.cell_ratio = std::min(report.cell_ratio, check.cell_ratio);
        if (check.error.relative_l2 < report.largest_error) continue;
        report.largest_error = check.error.relative_l2;
        report.worst_weights = check.weights;
    }
    report.meets_tolerance = !report.checks.empty() && report.mean_error <= options.tolerance
        && (options.tolerance_max == 0 || report.largest_error <= options.tolerance_max);
}

} // namespace

void check_asset(const std::vector<std::uint8_t>& bytes, AverageFamily& family, SolverPool& pool,
                 std::vector<CheckPoint>& checks, const BakeOptions& options, Progress& progress, BakeReport& report)
{
    const ShapeSet& set = pool.set();
    RuntimeBlender blender(bytes, "the asset just baked");
    const std::vector<Weights> fresh = draw_weights(options.seed + 2000003, set.pose_count(), options.fresh_count);
    const auto blend_at
        = [&](const Weights& w) { return from_input_units(set, blender.positions(blender.solve(to_floats(w), false))); };
    std::vector<Shape> blends;
    for (const Weights& w : fresh) blends.push_back(blend_at(w));
    SharedProgress shared(&progress);
    shared.describe("check", 0, fmt::format("unreduced averages at {} fresh weights", fresh.size()));
    std::vector<CheckPoint> points(fresh.size());
    for_each_task(fresh.size(), [&](std::size_t i, std::size_t worker) {
        points[i] = family.check(fresh[i], blends[i], 0, worker, &shared);
    });
    const std::size_t known_count = checks.size();
    std::move(points.begin(), points.end(), std::back_inserter(checks));
    for (std::size_t i = 0; i < checks.size(); ++i) {
        const CheckPoint& check = checks[i];
        const Shape blend = blend_at(check.weights);
        report.checks.push_back({ check.weights, shape_error(pool.energy(), set, check.weights, blend, check.truth),
                                  smallest_cell_ratio(set, blend), i >= known_count, check.has_converged });
        if (report.ties) add_check(*ties_of(pool.energy()), set, check.weights, check.truth, blend, *report.ties);
        report.findings.insert(report.findings.end(), check.findings.begin(), check.findings.end());
    }
    judge(options, report);
}

Eigen::MatrixXd reachable_coordinates(const Subspace& subspace, const TrainingSet& training)
{
    const Eigen::Index count = Eigen::Index(training.averages.size()), m = subspace.pose_coordinates.cols();
    Eigen::MatrixXd out(subspace.dimension(), count + m);
    for (Eigen::Index i = 0; i < count; ++i) out.col(i) = training.averages[std::size_t(i)];
    out.rightCols(m) = subspace.pose_coordinates;
    return out;
}

BasisReport check_basis(const AssetModel& asset, const Eigen::MatrixXd& reachable)
{
    const RuntimeBlender blender(encode_asset(asset), "the asset just baked");
    const Subspace& subspace = *asset.subspace;
    BasisReport report;
    report.is_compact = !asset.stored->basis.empty();
    std::size_t size = 0;
    pliant_asset_chunk(&blender.asset(), report.is_compact ? PLIANT_CHUNK_COMPACT : PLIANT_CHUNK_BASIS, &size);
    report.bytes_per_number = double(size) / (3.0 * double(blender.asset().vertex_count) * double(subspace.dimension()));
    for (Eigen::Index i = 0; i < reachable.cols(); ++i) {
        const Eigen::VectorXf q = asset.stored->frame.stored(reachable.col(i)).cast<float>();
        const std::vector<float> found = blender.positions(std::vector<float>(q.data(), q.data() + q.size()));
        const Shape shape = subspace.shape(reachable.col(i)),
                    exact = asset.drawn ? Shape(apply(asset.drawn->embedding, shape)) : shape;
        const Shape off = from_input_units(*asset.set, found) - exact;
        for (Eigen::Index v = 0; v < off.size(); v += 3)
            report.largest_difference = std::max(report.largest_difference, off.segment<3>(v).norm() / asset.set->diagonal);
    }
    return report;
}

} // namespace pliant
