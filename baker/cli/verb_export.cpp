#include "cli/verbs.h"

#include "base/common/print.h"
#include "input/io/write_file.h"
#include "output/export/export_asset.h"
#include "pipeline/json_file.h"

#include <algorithm>
#include <filesystem>
#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct ExportArguments {
    std::string asset, output, path;
    bool with_morph = false, with_asset = false, with_compression = false, without_normals = false, is_json = false;
    Talk talk;
    int bone_count = 0;
    double quantisation_error = 0; // of the diagonal
    double frames_per_second = 30;
};

// Of layers one for each, and one for all of them.
double default_seconds(const WeightDomain& domain) { return std::max(6.0, domain.is_box() ? double(domain.size()) + 1 : 0); }

constexpr double default_error = 1e-4; // of --meshopt: far below what is seen, and 16 bits are enough

std::vector<std::vector<float>> path_of(const ExportArguments& a, const WeightDomain& domain)
{
    if (a.path.empty()) return default_path(domain, default_seconds(domain), a.frames_per_second);
    std::vector<std::vector<float>> path;
    read_weight_path(a.path, [&](const std::vector<double>& weights) {
        const Eigen::VectorXf floats = domain.from(weights).cast<float>();
        path.emplace_back(floats.data(), floats.data() + floats.size());
    });
    return path;
}

void print_targets(const ExportArguments& a, const ExportReport& report)
{
    if (a.without_normals)
        print_to(stdout, "  {} morph targets without normals\n", report.target_count);
    else
        print_to(stdout, "  {} morph targets; error of normals: mean {:.2f}, 99.9 % below {:.2f}, largest {:.1f} degrees\n",
                 report.target_count, report.normal_error.mean_degrees, report.normal_error.percentile_degrees,
                 report.normal_error.worst_degrees);
    print_to(stdout,
             "  animation of {} frames at {:g} frames per second\n"
             "  table of weights: {} centres; error at fresh weights: mean {:.2g}, largest {:.2g} of the diagonal\n",
             report.frame_count, a.frames_per_second, report.centre_count, report.table_mean, report.table_largest);
}

void print_summary(const ExportArguments& a, const ExportedFile& file)
{
    const ExportReport& report = file.report;
    print_to(stdout, "{}: {} vertices, {} triangles, {:.2f} MiB\n", printable(a.output), report.vertex_count,
             report.triangle_count, double(file.bytes.size()) / 1048576.0);
    if (report.part_count > 1 || report.image_count > 0)
        print_to(stdout, "  {} {} with the materials of the source, {} {}\n", report.part_count,
                 report.part_count == 1 ? "part" : "parts", report.image_count,
                 report.image_count == 1 ? "image" : "images");
    if (report.target_count) print_targets(a, report);
    if (report.bone_count)
        print_to(stdout,
                 "  {} bones; distance from the blends: RMS {:.3f} %, largest {:.2f} % of the diagonal\n"
                 "  animation of {} frames at {:g} frames per second\n",
                 report.bone_count, 100 * report.skin_rms, 100 * report.skin_largest, report.frame_count,
                 a.frames_per_second);
    if (report.position_error > 0)
        print_to(stdout, "  positions in whole numbers: largest error {:.2g} of the diagonal\n", report.position_error);
    if (a.with_asset) print_to(stdout, "  the asset is embedded (PLIANT_elastic_blend)\n");
}

nlohmann::ordered_json to_json(const ExportArguments& a, const ExportedFile& file)
{
    const ExportReport& r = file.report;
    nlohmann::ordered_json json = { { "output", a.output },         { "file_size", file.bytes.size() },
                                    { "vertices", r.vertex_count }, { "triangles", r.triangle_count },
                                    { "parts", r.part_count },      { "images", r.image_count },
                                    { "has_asset", a.with_asset },  { "position_error", r.position_error } };
    if (r.target_count)
        json["morph_targets"] = { { "count", r.target_count },
                                  { "table_centres", r.centre_count },
                                  { "table_error", { { "mean", r.table_mean }, { "largest", r.table_largest } } } };
    if (r.target_count && !a.without_normals)
        json["morph_targets"]["normal_error_degrees"]
            = { { "mean", r.normal_error.mean_degrees }, { "largest", r.normal_error.worst_degrees } };
    if (r.bone_count)
        json["skin"] = { { "bones", r.bone_count }, { "error", { { "rms", r.skin_rms }, { "largest", r.skin_largest } } } };
    if (r.frame_count) json["animation"] = { { "frames", r.frame_count }, { "frames_per_second", a.frames_per_second } };
    return json;
}

ExitCode run_export(const ExportArguments& a)
{
    const bool with_morph = a.with_morph || (!a.with_asset && !a.bone_count);
    if (with_morph && a.bone_count)
        throw Failure(ExitCode::usage,
                      error_at(1216, "", "--morph and --skin are two ways to move one mesh", "choose one of them"));
    if (!with_morph && !a.bone_count && !a.path.empty())
        throw Failure(ExitCode::usage,
                      error_at(1215, "", "--path is for an animation, and --embed alone writes none",
                               "leave it out, or add --morph or --skin"));
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    std::vector<std::string> inputs = { a.asset };
    if (!a.path.empty()) inputs.push_back(a.path);
    try_outputs({ a.output }, inputs);
    require_suffix("--output", a.output, ".glb");
    ExportOptions options;
    options.with_morph_targets = with_morph;
    options.with_asset = a.with_asset;
    options.bone_count = a.bone_count;
    options.with_compression = a.with_compression;
    options.with_normals = !a.without_normals;
    options.quantisation_error = a.quantisation_error > 0 ? a.quantisation_error : a.with_compression ? default_error : 0;
    options.name = std::filesystem::path(a.asset).stem().string();
    options.source = a.asset;
    options.frames_per_second = a.frames_per_second;
    options.path = path_of(a, blender.domain());
    ConsoleProgress progress("export", a.talk);
    progress.update("fit", 0);
    const ExportedFile file = export_asset(blender, options);
    progress.clear_line();
    for (const Diagnostic& warning : warnings_about(file.report)) print_finding("export", warning);
    write_output(a.output, file.bytes);
    if (a.is_json)
        print_to(stdout, "{}\n", json_text(to_json(a, file)));
    else if (!a.talk.is_quiet)
        print_summary(a, file);
    return ExitCode::done;
}

} // namespace

Verb add_export(CLI::App& app)
{
    auto a = std::make_shared<ExportArguments>();
    CLI::App* verb = app.add_subcommand("export", "Write an asset as a GLB for engines");
    verb->footer(
        "Examples:\n"
        "  pliant export hero.pliant -o hero_blend.glb            morph targets: works in any glTF viewer\n"
        "  pliant export hero.pliant --meshopt -o hero_blend.glb  a fifth of the size, for engines that read it\n"
        "  pliant export hero.pliant --path weights.csv --fps 60 -o hero_blend.glb\n"
        "  pliant export hero.pliant --embed -o hero_blend.glb    with the asset inside, for programs with the runtime\n"
        "  pliant export hero.pliant --skin 24 -o hero_blend.glb  bones: for crowds and engines without morph targets\n"
        "Morph target j is coordinate q_j of the asset; its weights are in [0,1].\n"
        "pliant_morph_weights computes them from the q of pliant_solve.");
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    verb->add_option("-o,--output", a->output, "File to write")->required()->type_name("OUT.glb");
    verb->add_flag(
        "--morph", a->with_morph,
        "Write the reduced space as morph targets, with an animation of their weights (the default without --embed and "
        "--skin)");
    verb->add_flag("--embed", a->with_asset, "Put the asset into the GLB; the C runtime opens it there in place");
    verb->add_option("--skin", a->bone_count,
                     "Write a skin of B bones, fitted to the blends, instead of morph targets, and print its error")
        ->transform(whole_number_in(1, 1024))
        ->type_name("B");
    verb->add_option("--quantize", a->quantisation_error,
                     "Store positions and targets as integers (KHR_mesh_quantization), every vertex of a blend within E of "
                     "the diagonal of the box around all blends (1e-4 is not seen), and normals as bytes")
        ->check(number_in(1e-9, 0.1))
        ->type_name("E");
    verb->add_flag("--meshopt", a->with_compression,
                   "Compress all of it (EXT_meshopt_compression); with --quantize 1e-4, unless another E is given");
    verb->add_flag("--no-normals", a->without_normals,
                   "Write no normals, for programs that compute them; others draw flat faces");
    verb->add_option(
            "--path", a->path,
            "Animation: a file with one line of weights per frame (default: 6 seconds from pose to pose and through "
            "their average; of layers a second for each, up to full strength and back, then for all of them)")
        ->type_name("FILE.csv");
    verb->add_option("--fps", a->frames_per_second, "Frames per second of the animation")
        ->check(number_in(1.0, 1000.0))
        ->capture_default_str();
    add_json(*verb, a->is_json);
    add_talk(*verb, a->talk);
    return [a] { return run_export(*a); };
}

} // namespace pliant
