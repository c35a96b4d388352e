#include "cli/verbs.h"

#include "bake/certificate.h"
#include "bake/measure.h"
#include "base/common/print.h"
#include "output/asset/asset_facts.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace pliant {

namespace {

struct MeasureArguments {
    std::string asset, surface;
    std::vector<std::string> poses;
    MeasureOptions measure;
    SolverKind solver = default_solver();
    bool is_json = false;
    Talk talk;
};

nlohmann::ordered_json to_json(const Measurement& s)
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

std::string energy_text(const Measurement& s)
{
    return std::isnan(s.error.energy_excess) ? "-" : fmt::format("{:.2f}", 100 * s.error.energy_excess);
}

void print_table(const std::vector<Measurement>& samples)
{
    print_to(stdout, "{:<8} {:>11} {:>10} {:>10} {:>11} {:>5} {:>6} {:>7}  weights\n", "kind", "relative L2", "farthest %",
             "energy +%", "linear L2", "iter", "eval", "us");
    double mean = 0, worst = 0, farthest = 0, nearest_mean = 0, nearest_worst = 0;
    int unconverged = 0, branched = 0;
    std::vector<double> times;
    for (const Measurement& s : samples) {
        std::string w;
        for (double value : s.weights) w += fmt::format("{}{:.2f}", w.empty() ? "" : ",", value);
        print_to(stdout, "{:<8} {:>11.2e} {:>10.3f} {:>10} {:>11.2e} {:>5} {:>6} {:>7.1f}  {}{}\n", s.kind,
                 s.error.relative_l2, 100 * s.error.largest_distance, energy_text(s), s.linear.relative_l2,
                 s.info.iterations, s.info.evaluations, s.microseconds, w,
                 !s.has_converged     ? "  (unreduced average did not converge)"
                     : s.branch_count ? fmt::format("  (nearest other average: {:.1e})", s.nearest_error)
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
    print_to(stdout,
             "relative L2: mean {:.2e}, largest {:.2e}; farthest vertex {:.3f} % of the diagonal; solve {:.1f} us "
             "(median, cold)\n",
             mean, worst, 100 * farthest, median(times));
    if (branched)
        print_to(stdout,
                 "{} of {} weights have a second average besides the one on the straight path from the mean; relative L2 to "
                 "the average nearest to the blend: mean {:.2e}, largest {:.2e}\n",
                 branched, samples.size(), nearest_mean, nearest_worst);
    if (unconverged)
        print_to(stdout, "{} of {} unreduced averages did not converge: their rows are not reliable\n", unconverged,
                 samples.size());
}

// The surface that the asset draws, if it does; it must be given then, and only then.
std::optional<RenderMesh> load_drawn(const MeasureArguments& a, const std::string& certificate, const PoseSet& poses)
{
    if (has_render_mesh(certificate) == a.surface.empty())
        throw Failure(ExitCode::bad_input,
                      error_at(5106, a.asset, a.surface.empty() ? "was baked with --surface" : "was baked without --surface",
                               a.surface.empty() ? "give the same file here: --surface FILE" : "leave --surface out"));
    if (a.surface.empty()) return {};
    if (a.measure.from_blend)
        throw Failure(ExitCode::usage,
                      error_at(1210, "", "--from-blend needs blends of the whole solid, the asset holds a surface only",
                               "leave --from-blend out"));
    return load_surface_with_warnings("measure", a.surface, poses);
}

ExitCode run_measure(const MeasureArguments& a)
{
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    EnergyOptions options = read_energy_options(blender.certificate(), blender.asset().has_layers, a.asset);
    options.solver = a.solver;
    ConsoleProgress progress("measure", a.talk);
    const PoseSet poses = load_with_warnings("measure", a.poses, options);
    const std::optional<RenderMesh> surface = load_drawn(a, blender.certificate(), poses);
    const std::vector<Measurement> samples
        = measure(blender, a.asset, poses, options, surface ? &*surface : nullptr, a.measure, progress);
    progress.clear_line();
    if (a.is_json) {
        nlohmann::ordered_json json
            = { { "asset", a.asset }, { "dimension", blender.asset().dimension }, { "seed", a.measure.seed } };
        for (const Measurement& s : samples) json["samples"].push_back(to_json(s));
        print_to(stdout, "{}\n", json.dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    } else {
        print_table(samples);
    }
    return ExitCode::done;
}

} // namespace

Verb add_measure(CLI::App& app)
{
    auto a = std::make_shared<MeasureArguments>();
    CLI::App* verb = app.add_subcommand("measure", "Compare an asset's blends with unreduced averages at fresh weights");
    verb->footer("Example:\n  pliant measure hero.pliant rest.ply run.ply jump.ply --samples 30\n"
                 "Relative L2 is mass-weighted, after rigid alignment, relative to the distance from the centroid; the "
                 "farthest vertex is in\n"
                 "percent of the bounding-box diagonal; energy +% is the excess of the elastic energy over that of the "
                 "average; linear L2 is\n"
                 "the error of the linear blend; times are medians of cold solves on this machine.");
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    verb->add_option("poses", a->poses, "The poses that it was baked from, in the same order")
        ->required()
        ->type_name("POSE")
        ->expected(1, -1);
    add_surface(*verb, a->surface);
    verb->add_option("--samples", a->measure.sample_count, "Number of weights")
        ->transform(whole_number_in(1, 100000))
        ->capture_default_str();
    verb->add_option("--seed", a->measure.seed, "Random seed of the weights")
        ->transform(whole_number_in(0, UINT64_MAX))
        ->capture_default_str();
    verb->add_flag(
        "--from-blend", a->measure.from_blend,
        "Compute each unreduced average by Newton's method from the blend, and by continuation from the average of all "
        "poses only where the result is more than 5 % away: several times faster, but misses other branches within 5 %");
    add_json(*verb, a->is_json);
    add_threads(*verb);
    add_talk(*verb, a->talk);
    return [a] { return run_measure(*a); };
}

} // namespace pliant
