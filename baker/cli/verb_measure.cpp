#include "cli/verbs.h"

#include "average/family.h"
#include "reduce/training.h"
#include "report/certificate.h"
#include "write/runtime_blender.h"

#include <algorithm>
#include <chrono>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace pliant {

namespace {

struct Arguments {
    std::string asset;
    std::vector<std::string> poses;
    int sample_count = 10;
    std::uint64_t seed = 2;
    SolverKind solver = default_solver();
    bool is_json = false, is_quiet = false;
};

struct Sample {
    std::string kind; // uniform, edge, corner
    Weights weights;
    ShapeError error, linear;
    pliant_solve_info info {};
    double microseconds = 0;
    bool has_converged = false; // the unreduced average
};

// Uniform, on an edge, corner-heavy, in turn.
Sample draw(Random& random, std::size_t pose_count, int index)
{
    Sample sample;
    const int kind = index % 3;
    sample.kind = kind == 0 ? "uniform" : kind == 1 ? "edge" : "corner";
    sample.weights = random.weights(pose_count, kind == 2);
    if (kind == 1) {
        const std::size_t i = random.below(pose_count), j = (i + 1 + random.below(pose_count - 1)) % pose_count;
        const double t = 0.1 + 0.8 * random.uniform();
        sample.weights = t * corner_weights(pose_count, i) + (1 - t) * corner_weights(pose_count, j);
    }
    return sample;
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
        throw Failure(ExitCode::bad_input,
                      error_at(5104, path, "was baked from other poses, or in another order",
                               "give the poses in the order of the bake; `pliant info` lists their names"));
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
    return { { "kind", s.kind },
             { "weights", std::vector<double>(s.weights.data(), s.weights.data() + s.weights.size()) },
             { "relative_l2", s.error.relative_l2 },
             { "largest_distance", s.error.largest_distance },
             { "energy_excess", s.error.energy_excess },
             { "linear_relative_l2", s.linear.relative_l2 },
             { "iterations", s.info.iterations },
             { "evaluations", s.info.evaluations },
             { "microseconds", s.microseconds },
             { "truth_converged", s.has_converged } };
}

void print_table(const std::vector<Sample>& samples)
{
    fmt::print("{:<8} {:>11} {:>10} {:>10} {:>11} {:>5} {:>6} {:>7}  weights\n", "kind", "relative L2", "farthest %",
               "energy +%", "linear L2", "iter", "eval", "us");
    double mean = 0, worst = 0, farthest = 0;
    int unconverged = 0;
    std::vector<double> times;
    for (const Sample& s : samples) {
        std::string w;
        for (double value : s.weights) w += fmt::format("{}{:.2f}", w.empty() ? "" : ",", value);
        fmt::print("{:<8} {:>11.2e} {:>10.3f} {:>10.2f} {:>11.2e} {:>5} {:>6} {:>7.1f}  {}{}\n", s.kind, s.error.relative_l2,
                   100 * s.error.largest_distance, 100 * s.error.energy_excess, s.linear.relative_l2, s.info.iterations,
                   s.info.evaluations, s.microseconds, w, s.has_converged ? "" : "  (unreduced average did not converge)");
        mean += s.error.relative_l2 / double(samples.size());
        worst = std::max(worst, s.error.relative_l2);
        farthest = std::max(farthest, s.error.largest_distance);
        unconverged += !s.has_converged;
        times.push_back(s.microseconds);
    }
    fmt::print("relative L2: mean {:.2e}, largest {:.2e}; farthest vertex {:.3f} % of the diagonal; solve {:.1f} us "
               "(median, cold)\n",
               mean, worst, 100 * farthest, median(times));
    if (unconverged)
        fmt::print("{} of {} unreduced averages did not converge: their rows are upper bounds at best\n", unconverged,
                   samples.size());
}

ExitCode run(const Arguments& a)
{
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    EnergyOptions options = read_energy_options(blender.certificate(), a.asset);
    options.solver = a.solver;
    ConsoleProgress progress("measure", a.is_quiet);
    const PoseSet poses = load_with_warnings("measure", a.poses, options);
    const ShapeSet set = normalise(poses, options.keep_placement);
    check_same_poses(blender, set, a.asset);
    const std::unique_ptr<Energy> energy = make_energy(set, options);
    NewtonSolver solver(*energy, set, options.solver);
    AverageFamily family(solver, NewtonOptions(), nullptr);
    Random random(a.seed);
    std::vector<Sample> samples;
    for (int i = 0; i < a.sample_count; ++i) {
        progress.update("unreduced averages", double(i) / a.sample_count, fmt::format("{} of {}", i + 1, a.sample_count));
        Sample s = draw(random, set.pose_count(), i);
        const Eigen::VectorXf wf = s.weights.cast<float>();
        const std::vector<float> w(wf.data(), wf.data() + wf.size());
        time_solve(blender, w, s);
        const Shape blend = from_input_units(set, blender.positions(blender.solve(w, false)));
        const NewtonResult truth = family.at(s.weights);
        s.has_converged = truth.has_converged;
        s.error = shape_error(*energy, set, s.weights, blend, truth.y);
        Shape linear = Shape::Zero(set.dof_count());
        for (std::size_t k = 0; k < set.pose_count(); ++k) linear += s.weights[Eigen::Index(k)] * set.shapes[k];
        s.linear = shape_error(*energy, set, s.weights, linear, truth.y);
        samples.push_back(std::move(s));
    }
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
    verb->add_option("--samples", a->sample_count, "How many weights")->check(CLI::Range(1, 100000))->capture_default_str();
    verb->add_option("--seed", a->seed, "Seed of the weights")->capture_default_str();
    verb->add_flag("--json", a->is_json, "JSON to standard output");
    add_threads(*verb);
    add_quiet(*verb, a->is_quiet);
    return [a] { return run(*a); };
}

} // namespace pliant
