#include "bake/measure.h"

#include "bake/certificate.h"
#include "bake/make_energy.h"
#include "base/common/parallel.h"
#include "base/mesh/align.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fmt/core.h>
#include <optional>

namespace pliant {

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

namespace {

// A surface in the place of the solid's own, and its shapes in the poses.
struct Drawn {
    const RenderMesh& surface;
    NormalizedPoses set;
};

// What the asset draws in the place of the mesh of its energy.
NormalizedPoses drawn_set(const PoseSet& poses, const NormalizedPoses& set, const Drawn* drawn)
{
    if (drawn) return drawn->set;
    return poses.render_mesh ? render_mesh_shapes(set, *poses.render_mesh) : set;
}

// A blend as the mesh of the energy has it; of a solid that draws a surface, only that.
Shape blend_of(const PoseSet& poses, const NormalizedPoses& set, const std::vector<float>& positions)
{
    if (poses.is_solid() || poses.source_vertices.empty()) return from_input_units(set, positions);
    std::vector<float> elastic;
    for (const std::uint32_t v : poses.source_vertices)
        elastic.insert(elastic.end(), &positions[3 * std::size_t(v)], &positions[3 * std::size_t(v)] + 3);
    return from_input_units(set, elastic);
}

// The asset must have been baked from these poses: it reproduces them.
void check_same_poses(const RuntimeBlender& blender, const NormalizedPoses& set, const std::string& path)
{
    const pliant_asset& asset = blender.asset();
    bool is_same = asset.pose_count == set.pose_count() && Eigen::Index(asset.vertex_count) * 3 == set.dof_count();
    // Single precision reproduces a pose to 1e-6 at the origin and more coarsely far from it, the compact basis to its own
    // error.
    const double allowed = (1e-4 + 2 * read_position_error(blender.certificate())) * set.diagonal;
    for (std::uint32_t k = 0; is_same && k < asset.pose_count; ++k) {
        const std::vector<float> positions = blender.positions(blender.pose_coordinates(k));
        const Shape off = from_input_units(set, positions) - set.shapes[k];
        double largest = 0;
        for (const float x : positions) largest = std::max(largest, double(std::abs(x)));
        const double limit = allowed + 4 * 0x1p-24 * largest / set.length;
        for (Eigen::Index v = 0; v < off.size(); v += 3) is_same = is_same && off.segment<3>(v).norm() <= limit;
    }
    if (!is_same)
        throw Failure(ExitCode::bad_input,
                      error_at(5104, path, "was baked from other poses or another render mesh, or in another order",
                               "give the poses in the order of the bake (`pliant info` lists their names), and its "
                               "--surface if it had one"));
}

// A cold solve, repeated: the median is what a jump costs.
void time_solve(RuntimeBlender& blender, const std::vector<float>& w, Measurement& sample)
{
    std::vector<double> times;
    for (int i = 0; i < 15; ++i) {
        const auto start = std::chrono::steady_clock::now();
        blender.solve(w, false, &sample.info);
        times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    sample.microseconds = median(times);
}

std::vector<Measurement> draw_samples(const MeasureOptions& options, const WeightDomain& domain)
{
    Random random(options.seed);
    std::vector<Measurement> samples(std::size_t(options.sample_count));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].weights = domain.draw(random, i);
        samples[i].kind = domain.kind_of(samples[i].weights, i);
    }
    return samples;
}

void compare(const AverageFamily& family, std::size_t worker, SharedProgress& progress, bool from_blend, const Shape& blend,
             Measurement& s)
{
    const NormalizedPoses& set = family.pool().set();
    const CheckPoint check = family.check(s.weights, blend, from_blend ? 0.05 : 0, worker, &progress);
    const Shape& average = check.reference;
    s.has_converged = check.has_converged;
    s.branch_count = check.branches.size();
    s.nearest_error = check.nearest_error;
    const Energy& energy = family.pool().energy();
    s.error = shape_error(energy, set, s.weights, blend, average);
    s.linear = shape_error(energy, set, s.weights, linear_blend(set, s.weights), average);
}

// The same where the asset draws a surface: its blends say nothing about energy, nor where to look for the average next to
// them.
void compare_drawn(const AverageFamily& family, std::size_t worker, SharedProgress& progress, const Drawn& drawn,
                   const Shape& blend, Measurement& s)
{
    const FamilyPoint point = family.at(s.weights, worker, &progress);
    const Shape average = apply(drawn.surface.embedding, point.average.y);
    s.has_converged = point.average.has_converged;
    s.branch_count = point.jumps.size();
    s.error = shape_distance(drawn.set, blend, average);
    s.nearest_error = s.error.relative_l2;
    s.linear = shape_distance(drawn.set, linear_blend(drawn.set, s.weights), average);
    s.error.energy_excess = s.linear.energy_excess = std::nan("");
}

// Newton's last step for averages, relative to the size of the character: far below any error of interest.
constexpr double average_floor = 2e-5;

// Blends first: their solves are timed, and nothing else must run then.
std::vector<Shape> time_blends(RuntimeBlender& blender, const PoseSet& poses, const NormalizedPoses& set,
                               std::vector<Measurement>& samples)
{
    std::vector<Shape> blends;
    for (Measurement& s : samples) {
        const Eigen::VectorXf wf = s.weights.cast<float>();
        const std::vector<float> w(wf.data(), wf.data() + wf.size());
        time_solve(blender, w, s);
        blends.push_back(blend_of(poses, set, blender.positions(blender.solve(w, false))));
    }
    return blends;
}

} // namespace

std::vector<Measurement> measure(RuntimeBlender& blender, const std::string& asset_path, const PoseSet& poses,
                                 const EnergyOptions& energy_options, const RenderMesh* surface,
                                 const MeasureOptions& options, Progress& listener)
{
    PlannedProgress progress(listener, { { "ties", 0.1 }, { "mean", 0.3 }, { "unreduced averages", 1 } });
    const NormalizedPoses set = normalize(poses, energy_options.keep_placement);
    std::optional<Drawn> drawn;
    if (surface) drawn.emplace(Drawn { *surface, render_mesh_shapes(set, *surface) });
    check_same_poses(blender, drawn_set(poses, set, drawn ? &*drawn : nullptr), asset_path);
    const ElasticModel model = make_model(set, energy_options, &progress);
    SolverPool pool(*model.energy, set, energy_options.solver);
    NewtonOptions newton;
    newton.step_floor = average_floor * mass_norm(set.shapes[0], set.masses);
    AverageFamily family(pool, newton, &progress, read_start_pose(blender.certificate(), poses.pose_count(), asset_path),
                         model.coarse.get());
    family.mean();
    std::vector<Measurement> samples = draw_samples(options, blender.domain());
    const std::vector<Shape> blends = time_blends(blender, poses, set, samples);
    SharedProgress shared(&progress);
    std::atomic<std::size_t> done { 0 };
    for_each_task(samples.size(), [&](std::size_t i, std::size_t worker) {
        if (worker == 0)
            shared.describe("unreduced averages", double(done) / double(samples.size()),
                            fmt::format("{} of {}", done.load(), samples.size()));
        if (drawn)
            compare_drawn(family, worker, shared, *drawn, blends[i], samples[i]);
        else
            compare(family, worker, shared, options.from_blend, blends[i], samples[i]);
        ++done;
    });
    return samples;
}

} // namespace pliant
