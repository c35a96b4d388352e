#include "bake/make_energy.h"
#include "cli/verbs.h"

#include "bake/certificate.h"
#include "base/common/parallel.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"
#include "reduced/surrogate/training.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace pliant {

namespace {

struct Arguments {
    std::string asset, surface;
    std::vector<std::string> poses;
    int sample_count = 10;
    std::uint64_t seed = 2;
    SolverKind solver = default_solver();
    bool from_blend = false, is_json = false, is_quiet = false;
};

// A surface in the place of the solid's own, and its shapes in the poses.
struct Drawn {
    DrawnSurface surface;
    ShapeSet set;
};

struct Sample {
    std::string kind; // uniform, edge, corner
    Weights weights;
    ShapeError error, linear;
    double nearest_error = 0; // relative L2, to the average next to the blend
    pliant_solve_info info {};
    double microseconds = 0;
    bool has_converged = false;   // the unreduced average
    std::size_t branch_count = 0; // jumps on the way, other averages for these weights
};

// What the asset draws in the place of the mesh of its energy.
ShapeSet drawn_set(const PoseSet& poses, const ShapeSet& set, const Drawn* drawn)
{
    if (drawn) return drawn->set;
    return poses.drawn ? drawn_shapes(set, *poses.drawn) : set;
}

// A blend as the mesh of the energy has it; of a solid that draws a surface, only that.
Shape blend_of(const PoseSet& poses, const ShapeSet& set, const std::vector<float>& positions)
{
    if (poses.is_solid() || poses.source_vertices.empty()) return from_input_units(set, positions);
    std::vector<float> elastic;
    for (const std::uint32_t v : poses.source_vertices)
        elastic.insert(elastic.end(), &positions[3 * std::size_t(v)], &positions[3 * std::size_t(v)] + 3);
    return from_input_units(set, elastic);
}

// The asset must have been baked from these poses: it reproduces them.
void check_same_poses(const RuntimeBlender& blender, const ShapeSet& set, const std::string& path)
{
    const pliant_asset& asset = blender.asset();
    bool is_same = asset.pose_count == set.pose_count() && Eigen::Index(asset.vertex_count) * 3 == set.dof_count();
    for (std::uint32_t k = 0; is_same && k < asset.pose_count; ++k) {
        const float* q = pliant_asset_pose_coordinates(&asset, k);
        const Shape shape = from_input_units(set, blender.positions(std::vector<float>(q, q + asset.dimension)));
        is_same = (shape - set.shapes[k]).norm() <= 1e-4 * set.shapes[k].norm(); // float32 reproduces a pose to 1e-6
    }
    if (!is_same)
        throw Failure(
            ExitCode::bad_input,
            error_at(
                5104, path, "was baked from other poses or another surface, or in another order",
                "give the poses in the order of the bake (`pliant info` lists their names), and its surface if it had one"));
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values.empty() ? 0 : values[values.size() / 2];
}

// A cold solve, repeated: the median is what a jump costs.
void time_solve(RuntimeBlender& blender, const std::vector<float>& w, Sample& sample)
{
    std::vector<double> times;
    for (int i = 0; i < 15; ++i) {
        const auto start = std::chrono::steady_clock::now();
        blender.solve(w, false, &sample.info);
        times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    sample.microseconds = median(times);
}

nlohmann::ordered_json to_json(const Sample& s)
{
    nlohmann::ordered_json json
        = { { "kind", s.kind },
            { "weights", std::vector<double>(s.weights.data(), s.weights.data() + s.weights.size()) },
            { "relative_l2", s.error.relative_l2 },
            { "nearest_relative_l2", s.nearest_error },
            { "largest_distance", s.error.largest_distance },
            { "energy_excess", s.error.energy_excess },
            { "linear_relative_l2", s.linear.relative_l2 },
            { "iterations", s.info.iterations },
            { "evaluations", s.info.evaluations },
            { "microseconds", s.microseconds },
            { "truth_converged", s.has_converged },
            { "branches", s.branch_count } };
    if (std::isnan(s.error.energy_excess)) json.erase("energy_excess");
    return json;
}

std::string energy_text(const Sample& s)
{
    return std::isnan(s.error.energy_excess) ? "-" : fmt::format("{:.2f}", 100 * s.error.energy_excess);
}

void print_table(const std::vector<Sample>& samples)
{
    fmt::print("{:<8} {:>11} {:>10} {:>10} {:>11} {:>5} {:>6} {:>7}  weights\n", "kind", "relative L2", "farthest %",
               "energy +%", "linear L2", "iter", "eval", "us");
    double mean = 0, worst = 0, farthest = 0, nearest_mean = 0, nearest_worst = 0;
    int unconverged = 0, branched = 0;
    std::vector<double> times;
    for (const Sample& s : samples) {
        std::string w;
        for (double value : s.weights) w += fmt::format("{}{:.2f}", w.empty() ? "" : ",", value);
        fmt::print("{:<8} {:>11.2e} {:>10.3f} {:>10} {:>11.2e} {:>5} {:>6} {:>7.1f}  {}{}\n", s.kind, s.error.relative_l2,
                   100 * s.error.largest_distance, energy_text(s), s.linear.relative_l2, s.info.iterations,
                   s.info.evaluations, s.microseconds, w,
                   !s.has_converged     ? "  (unreduced average did not converge)"
                       : s.branch_count ? fmt::format("  (another average is here: {:.1e})", s.nearest_error)
                                        : "");
        mean += s.error.relative_l2 / double(samples.size());
        worst = std::max(worst, s.error.relative_l2);
        farthest = std::max(farthest, s.error.largest_distance);
        nearest_mean += s.nearest_error / double(samples.size());
        nearest_worst = std::max(nearest_worst, s.nearest_error);
        unconverged += !s.has_converged;
        branched += s.branch_count > 0;
        times.push_back(s.microseconds);
    }
    fmt::print("relative L2: mean {:.2e}, largest {:.2e}; farthest vertex {:.3f} % of the diagonal; solve {:.1f} us "
               "(median, cold)\n",
               mean, worst, 100 * farthest, median(times));
    if (branched)
        fmt::print(
            "{} of {} weights have another average than the one that the straight line from the mean leads to; relative "
            "L2 to the average next to the blend: mean {:.2e}, largest {:.2e}\n",
            branched, samples.size(), nearest_mean, nearest_worst);
    if (unconverged)
        fmt::print("{} of {} unreduced averages did not converge: their rows are upper bounds at best\n", unconverged,
                   samples.size());
}

std::vector<Sample> draw_samples(const Arguments& a, std::size_t pose_count)
{
    static const char* const kinds[] = { "uniform", "edge", "corner" };
    Random random(a.seed);
    std::vector<Sample> samples(std::size_t(a.sample_count));
    for (std::size_t i = 0; i < samples.size(); ++i) {
        samples[i].kind = pose_count == 2 ? kinds[0] : kinds[i % 3];
        samples[i].weights = mixed_weights(random, pose_count, i);
    }
    return samples;
}

void compare(const AverageFamily& family, std::size_t worker, SharedProgress& progress, bool from_blend, const Shape& blend,
             Sample& s)
{
    const ShapeSet& set = family.pool().set();
    const CheckPoint check = family.check(s.weights, blend, from_blend ? 0.05 : 0, worker, &progress);
    const Shape& truth = check.truth;
    s.has_converged = check.has_converged;
    s.branch_count = check.findings.size();
    s.nearest_error = check.nearest_error;
    const Energy& energy = family.pool().energy();
    s.error = shape_error(energy, set, s.weights, blend, truth);
    Shape linear = Shape::Zero(set.dof_count());
    for (std::size_t k = 0; k < set.pose_count(); ++k) linear += s.weights[Eigen::Index(k)] * set.shapes[k];
    s.linear = shape_error(energy, set, s.weights, linear, truth);
}

// The same where the asset draws a surface: its blends say nothing about energy, nor where to look for the average next to them.
void compare_drawn(const AverageFamily& family, std::size_t worker, SharedProgress& progress, const Drawn& drawn,
                   const Shape& blend, Sample& s)
{
    const FamilyPoint point = family.at(s.weights, worker, &progress);
    const Shape truth = apply(drawn.surface.embedding, point.average.y);
    s.has_converged = point.average.has_converged;
    s.branch_count = point.jumps.size();
    s.error = shape_distance(drawn.set, blend, truth);
    s.nearest_error = s.error.relative_l2;
    Shape linear = Shape::Zero(drawn.set.dof_count());
    for (std::size_t k = 0; k < drawn.set.pose_count(); ++k) linear += s.weights[Eigen::Index(k)] * drawn.set.shapes[k];
    s.linear = shape_distance(drawn.set, linear, truth);
    s.error.energy_excess = s.linear.energy_excess = std::nan("");
}

// The surface that the asset draws, if it does; it must be given then, and only then.
std::unique_ptr<const Drawn> load_drawn(const Arguments& a, const std::string& certificate, const PoseSet& poses,
                                        const ShapeSet& set)
{
    if (has_drawn_surface(certificate) == a.surface.empty())
        throw Failure(
            ExitCode::bad_input,
            error_at(5106, a.asset,
                     a.surface.empty() ? "was baked with a surface of its own (--surface)" : "was baked without --surface",
                     a.surface.empty() ? "give the same file here: --surface FILE" : "leave --surface out"));
    if (a.surface.empty()) return nullptr;
    if (a.from_blend)
        throw Failure(ExitCode::usage,
                      error_at(1210, "", "--from-blend needs blends of the whole solid, the asset holds a surface only",
                               "leave --from-blend out"));
    auto drawn = std::make_unique<Drawn>();
    drawn->surface = load_surface_with_warnings("measure", a.surface, poses);
    drawn->set = drawn_shapes(set, drawn->surface);
    return drawn;
}

// Newton's last step for truths, relative to the size of the character: far below any error of interest.
constexpr double truth_floor = 2e-5;

ExitCode run(const Arguments& a)
{
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    EnergyOptions options = read_energy_options(blender.certificate(), a.asset);
    options.solver = a.solver;
    ConsoleProgress progress("measure", a.is_quiet);
    const PoseSet poses = load_with_warnings("measure", a.poses, options);
    const ShapeSet set = normalise(poses, options.keep_placement);
    const std::unique_ptr<const Drawn> drawn = load_drawn(a, blender.certificate(), poses, set);
    check_same_poses(blender, drawn_set(poses, set, drawn.get()), a.asset);
    const std::unique_ptr<Energy> energy = make_energy(set, options, &progress);
    SolverPool pool(*energy, set, options.solver);
    NewtonOptions newton;
    newton.step_floor = truth_floor * mass_norm(set.shapes[0], set.masses);
    AverageFamily family(pool, newton, &progress, read_start_pose(blender.certificate()));
    family.mean();
    std::vector<Sample> samples = draw_samples(a, set.pose_count());
    std::vector<Shape> blends;
    for (Sample& s : samples) {
        const Eigen::VectorXf wf = s.weights.cast<float>();
        const std::vector<float> w(wf.data(), wf.data() + wf.size());
        time_solve(blender, w, s);
        blends.push_back(blend_of(poses, set, blender.positions(blender.solve(w, false))));
    }
    SharedProgress shared(&progress);
    std::atomic<std::size_t> done { 0 };
    for_each_task(samples.size(), [&](std::size_t i, std::size_t worker) {
        if (worker == 0)
            shared.describe("unreduced averages", double(done) / double(samples.size()),
                            fmt::format("{} of {}", done.load(), samples.size()));
        if (drawn)
            compare_drawn(family, worker, shared, *drawn, blends[i], samples[i]);
        else
            compare(family, worker, shared, a.from_blend, blends[i], samples[i]);
        ++done;
    });
    progress.clear_line();
    if (a.is_json) {
        nlohmann::ordered_json json
            = { { "asset", a.asset }, { "dimension", blender.asset().dimension }, { "seed", a.seed } };
        for (const Sample& s : samples) json["samples"].push_back(to_json(s));
        fmt::print("{}\n", json.dump(1));
    } else {
        print_table(samples);
    }
    return ExitCode::done;
}

} // namespace

Verb add_measure(CLI::App& app)
{
    auto a = std::make_shared<Arguments>();
    CLI::App* verb = app.add_subcommand("measure", "Compare an asset's blends with unreduced averages at fresh weights");
    verb->footer("Example:\n  pliant measure hero.pliant rest.ply run.ply jump.ply --samples 30\n"
                 "Relative L2 is mass-weighted, after rigid alignment, relative to the distance from the centroid; the "
                 "farthest vertex is in\n"
                 "per cent of the bounding-box diagonal; energy +% is the elastic energy above the least possible; linear "
                 "L2 is the error\n"
                 "of the linear blend; times are medians of cold solves on this machine.");
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    verb->add_option("poses", a->poses, "The poses it was baked from, in the same order")
        ->required()
        ->type_name("POSE")
        ->expected(1, -1);
    add_surface(*verb, a->surface);
    verb->add_option("--samples", a->sample_count, "How many weights")->check(CLI::Range(1, 100000))->capture_default_str();
    verb->add_option("--seed", a->seed, "Seed of the weights")->capture_default_str();
    verb->add_flag(
        "--from-blend", a->from_blend,
        "Look for each unreduced average by Newton's method from the blend only, and by continuation from the average of "
        "all poses where that is 5 % away: several times faster, but another branch nearer than that is not seen");
    add_json(*verb, a->is_json);
    add_threads(*verb);
    add_quiet(*verb, a->is_quiet);
    return [a] { return run(*a); };
}

} // namespace pliant
