#include "cli/verbs.h"

#include "bake/bake.h"
#include "bake/certificate.h"
#include "bake/warnings.h"
#include "base/common/print.h"
#include "base/common/sha256.h"
#include "base/weights/weights.h"
#include "cli/bake_request.h"
#include "cli/certificate_lines.h"
#include "cli/config_options.h"
#include "cli/idle_options.h"
#include "input/io/write_file.h"
#include "pipeline/batch.h"
#include "pipeline/depfile.h"
#include "pipeline/stamp.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fmt/core.h>
#include <iterator>
#include <memory>
#include <new>
#include <system_error>

namespace pliant {

namespace {

// The errors of layers by kind of mixture, beside those of the linear sum.
void print_layer_errors(const BakeReport& r, double tolerance)
{
    for (const KindErrors& kind : r.check.kinds) print_to(stdout, "  {}\n", kind_line(kind));
    if (r.check.largest_error > 0)
        print_to(stdout, "  worst mixture: {}\n", printable(blend_text(r.check.worst_weights, r.input.pose_names)));
    if (r.check.linear_error <= tolerance)
        print_to(stdout, "  the linear sum keeps the tolerance, too: mean error {:.2e}\n", r.check.linear_error);
}

// Of a mesh with seams the simulation has fewer vertices than the file.
std::string vertices_text(const InputReport& input)
{
    if (!input.drawn_vertex_count) return fmt::format("{} vertices", input.vertex_count);
    return fmt::format("{} vertices ({} simulated)", input.drawn_vertex_count, input.vertex_count);
}

std::string poses_text(const InputReport& input)
{
    const std::size_t layer_count = input.ranges.size();
    return layer_count ? fmt::format("rest shape and {} layer{}", layer_count, layer_count > 1 ? "s" : "")
                       : fmt::format("{} poses", input.pose_count);
}

void print_work(const BakeReport& r)
{
    for (const StageTime& stage : r.stages) print_to(stdout, "  {:<18} {:8.1f} s\n", stage.stage, stage.seconds);
    print_to(stdout, "  {} factorisations, {} snapshots, {} interpolated\n", r.factorization_count, r.snapshot_count,
             r.interpolated_count);
}

void print_checks(const BakeRequest& a, const BakeReport& r)
{
    if (r.check.blends.empty()) return;
    print_to(stdout,
             "  at best {:.2e} (mean) and {:.2e} (largest) in the subspace; farthest vertex {:.2f} % of the diagonal\n",
             r.fit.subspace_error.mean, r.fit.subspace_error.largest, 100 * r.check.largest_distance);
    if (r.input.tet_count) print_to(stdout, "  smallest volume ratio of a tetrahedron: {:.3f}\n", r.check.cell_ratio);
    if (r.check.render_mesh)
        print_to(stdout, "  render mesh: relative L2 {:.2e} (mean), {:.2e} (largest)\n", r.check.render_mesh->mean,
                 r.check.render_mesh->largest);
    if (!r.check.kinds.empty()) print_layer_errors(r, a.bake.tolerance);
}

void print_summary(const BakeRequest& a, const BakedAsset& baked)
{
    const BakeReport& r = baked.report;
    const CertificateFacts facts = read_certificate_facts(r.certificate, r.input.pose_count, !r.input.ranges.empty());
    const std::string energy = r.fit.kind == SurrogateKind::quartic
        ? "exact quartic"
        : fmt::format("{} elements{}", r.fit.element_count, r.fit.surrogate.has_load ? " and a dead load" : "");
    print_to(stdout, "{}: {}\n", printable(a.output), verdict_of(facts));
    print_to(stdout, "  {}, {}, d = {}, {}, {}\n", poses_text(r.input), vertices_text(r.input), r.fit.dimension, energy,
             size_text(double(baked.bytes.size())));
    if (a.bake.render_mesh)
        print_to(stdout, "  drawn: {} vertices of {}\n", a.bake.render_mesh->embedding.count(), printable(a.surface));
    print_to(stdout, "  elastic energy: {}{}\n", name_of(r.input.material),
             r.input.rough_count == 0 ? ""
                                      : fmt::format(", ARAP cells at {} rough vertices, the roughest of them {}",
                                                    r.input.rough_count, r.input.roughest_vertex));
    print_to(stdout, "  basis: {:.2f} bytes per number, largest error {:.1e} of the diagonal\n",
             r.check.basis.bytes_per_number, r.check.basis.largest_difference);
    if (!r.fit.reason.empty()) print_to(stdout, "  cubature instead of the quartic: {}\n", r.fit.reason);
    if (const std::string drift = drift_line(facts); !drift.empty()) print_to(stdout, "  {}\n", drift);
    print_checks(a, r);
    if (a.talk.is_verbose) print_work(r);
}

// A tolerance that was asked for and is missed: nothing is written, unless the best that can be had was asked for, too.
ExitCode check_tolerance(const BakeRequest& a, const BakedAsset& baked, Progress& progress)
{
    std::optional<ToleranceMiss> miss = find_miss(baked.report, a.bake, a.has_tolerance);
    if (!miss) return ExitCode::done;
    if (miss->is_asked && !a.is_best_effort && !a.bake.time_limit) {
        std::error_code error;
        if (std::filesystem::exists(a.output, error))
            miss->what += fmt::format("; the older {} was left as it is", a.output);
        throw to_failure(*miss);
    }
    warn_of(*miss, progress);
    return miss->is_asked ? ExitCode::misses_tolerance : ExitCode::done;
}

void probe_all_outputs(const BakeRequest& a)
{
    std::vector<std::string> inputs = input_files(a.poses, a.bake.energy);
    if (!a.surface.empty()) inputs.push_back(a.surface);
    if (!a.config.empty()) inputs.push_back(a.config);
    try_outputs({ a.output, a.report, a.depfile, a.stamp }, inputs);
    if (!a.depfile.empty()) write_depfile(a.output, inputs); // throws at names that it cannot hold
    require_suffix("--output", a.output, ".pliant");
    require_suffix("--report", a.report, ".json");
    // A user who takes these for flags without a value has named a pose, which they would replace.
    require_suffix("--depfile", a.depfile, ".d");
    require_suffix("--stamp", a.stamp, ".stamp");
}

// So that both may move together. Without a folder in common, or one that can be looked up, the absolute name.
std::string asset_seen_from_report(const BakeRequest& a)
{
    std::error_code error;
    const auto looked_up = [&error](std::filesystem::path path) {
        if (error == std::errc::not_enough_memory) throw std::bad_alloc();
        return path;
    };
    const std::filesystem::path folder = looked_up(std::filesystem::absolute(a.report, error)).parent_path();
    const std::filesystem::path output = looked_up(std::filesystem::absolute(a.output, error));
    const std::filesystem::path asset = looked_up(std::filesystem::proximate(output, folder, error));
    return asset.empty() ? a.output : asset.generic_string();
}

// A file that was written again while the bake ran is to be newer than the asset, as build systems see it. The copy of an
// older file may have an old time.
void date_before(const std::vector<ReadFile>& outdated, const std::string& output)
{
    constexpr std::chrono::seconds coarsest(2); // of file systems (FAT)
    std::error_code error;
    for (const ReadFile& file : outdated) {
        const auto time = std::filesystem::last_write_time(output, error),
                   pose_time = std::filesystem::last_write_time(file.path, error);
        if (!error) std::filesystem::last_write_time(output, std::min(time, pose_time - coarsest), error);
    }
}

// The files among them that were written again.
std::vector<ReadFile> warn_of_outdated(const std::vector<ReadFile>& files, Progress& progress)
{
    std::vector<ReadFile> outdated;
    std::copy_if(files.begin(), files.end(), std::back_inserter(outdated), is_outdated);
    for (const ReadFile& file : outdated)
        progress.warn(4606, fmt::format("{} was written again while the bake ran: the asset is of the old file", file.path),
                      "bake again");
    return outdated;
}

std::string_view bytes_of(const BakedAsset& baked)
{
    return { reinterpret_cast<const char*>(baked.bytes.data()), baked.bytes.size() };
}

// The dependencies come before the asset: who is stopped in between leaves an old asset with the new ones, which does no
// harm.
void write_asset(const BakeRequest& a, const BakedAsset& baked, const std::vector<ReadFile>& files, Progress& progress)
{
    if (!a.depfile.empty()) {
        std::vector<std::string> names;
        for (const ReadFile& file : files)
            if (!file.digest.empty()) names.push_back(file.path); // one that is not there would never be up to date
        write_output(a.depfile, write_depfile(a.output, names));
    }
    write_output(a.output, bytes_of(baked));
    date_before(warn_of_outdated(files, progress), a.output);
}

double seconds_of(const BakeReport& report)
{
    double seconds = 0;
    for (const StageTime& stage : report.stages) seconds += stage.seconds;
    return seconds;
}

// The report comes behind the asset, since it is about this asset, and the stamp last, since it says that both are whole.
void write_records(const BakeRequest& a, const Json& config, const BakedAsset& baked, ExitCode outcome,
                   const std::vector<ReadFile>& files, const std::vector<Diagnostic>& warnings)
{
    if (!a.report.empty()) write_output(a.report, write_report(baked.report, asset_seen_from_report(a), warnings));
    if (!a.stamp.empty())
        write_output(a.stamp,
                     write_stamp({ stamped_options(config, a.output), files, a.output, sha256_hex(bytes_of(baked)),
                                   int(outcome), seconds_of(baked.report) }));
}

ExitCode run_bake(BakeRequest& a, CLI::App& verb)
{
    complete_request(verb, a);
    const Json config = effective_config(verb);
    if (a.is_print_config) {
        print_to(stdout, "{}\n", json_text(config));
        return ExitCode::done;
    }
    probe_all_outputs(a);
    const ReadLog log;
    ConsoleProgress progress("bake", a.talk);
    std::vector<Diagnostic> warnings;
    const PoseSet poses = load_with_warnings("bake", a.poses, a.bake.energy, &warnings);
    a.bake.energy.blend = poses.blend;
    warn_of_idle_options(verb, a.bake.energy, poses.is_solid(), warnings);
    if (!a.surface.empty())
        a.bake.render_mesh
            = std::make_shared<const RenderMesh>(load_surface_with_warnings("bake", a.surface, poses, &warnings));
    if (a.is_dry_run) {
        print_to(stdout, "{}\n", json_text(describe_poses(poses, a.bake)));
        return ExitCode::done;
    }
    const BakedAsset baked = bake(poses, a.bake, progress);
    const ExitCode outcome = check_tolerance(a, baked, progress);
    std::vector<ReadFile> dependencies = a.config_files; // a stamp has their options
    dependencies.insert(dependencies.end(), log.files().begin(), log.files().end());
    write_asset(a, baked, dependencies, progress);
    add_warnings(progress.warnings(), baked.report, warnings);
    write_records(a, config, baked, outcome, log.files(), warnings);
    progress.clear_line();
    if (a.is_json)
        print_to(stdout, "{}\n", write_report(baked.report, a.output, warnings));
    else if (!a.talk.is_quiet)
        print_summary(a, baked);
    return outcome;
}

} // namespace

Verb add_bake(CLI::App& app)
{
    auto a = std::make_shared<BakeRequest>();
    CLI::App* verb = app.add_subcommand("bake", "Bake poses into an asset for the runtime");
    verb->footer("Example:\n  pliant bake rest.ply run.ply jump.ply -o hero.pliant\n"
                 "Bakes three poses of one mesh (same vertices, same faces) into hero.pliant, then compares blends of the "
                 "runtime with\nunreduced averages. Try `pliant check` first: it is fast and writes nothing.");
    add_bake_options(*verb, *a);
    verb->add_option(
            "--config", a->config,
            "Read options, poses and output from a JSON file (schema: bake_config.schema.json). Keys are the options with "
            "'_' for '-', paths are relative to the folder of the file. The command line overrides it")
        ->type_name("FILE.json");
    verb->add_flag(
        "--print-config", a->is_print_config,
        "Print all options with their values as JSON for --config (paths relative to the current folder), and bake "
        "nothing");
    verb->add_flag("--dry-run", a->is_dry_run,
                   "Check the poses, print the estimated cost as JSON like `pliant check --json`, and bake nothing");
    add_json(*verb, a->is_json);
    return [a, verb] { return run_bake(*a, *verb); };
}

} // namespace pliant
