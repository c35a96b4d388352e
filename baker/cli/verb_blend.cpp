#include "cli/verbs.h"

#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "output/asset/runtime_blender.h"
#include "pipeline/json_file.h"

#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct BlendArguments {
    std::string asset, weights, path, output;
    bool all_vertices = false, is_quiet = false, is_json = false;
};

// How shapes of an asset are written.
struct Writing {
    Polygons faces;
    VertexNumbers numbers;
    bool all_vertices;
};

std::vector<float> to_floats(const std::vector<double>& values) { return std::vector<float>(values.begin(), values.end()); }

void write_frame(const RuntimeBlender& blender, const std::vector<float>& q, const Writing& how, const std::string& path)
{
    const std::vector<float> positions = blender.positions(q);
    const Eigen::Index count = Eigen::Index(positions.size() / 3);
    using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Positions rows = Eigen::Map<const FloatRows>(positions.data(), count, 3).cast<double>();
    write_output(path, encode_ply(rows, how.faces, how.numbers, how.all_vertices));
}

nlohmann::ordered_json to_json(const std::string& output, const pliant_solve_info& info)
{
    return { { "output", output }, { "iterations", info.iterations }, { "evaluations", info.evaluations } };
}

void print_frames(const BlendArguments& a, const nlohmann::ordered_json& frames)
{
    const nlohmann::ordered_json json = { { "asset", a.asset }, { "frames", frames } };
    fmt::print("{}\n", json_text(json));
}

ExitCode run_blend(const BlendArguments& a)
{
    if (a.weights.empty() == a.path.empty())
        throw Failure(ExitCode::usage, error_at(1202, "", "give either --weights or --path", "see `pliant blend --help`"));
    const std::vector<double> values = a.path.empty() ? parse_weights(a.weights) : std::vector<double>();
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    const Writing how
        = { blender.faces(), { blender.source_vertices(), blender.asset().boundary_vertex_count }, a.all_vertices };
    pliant_solve_info info {};
    if (a.path.empty()) {
        probe_output(a.output, { a.asset });
        write_frame(blender, blender.solve(to_floats(values), false, &info), how, a.output);
        if (a.is_json)
            print_frames(a, nlohmann::ordered_json::array({ to_json(a.output, info) }));
        else if (!a.is_quiet)
            fmt::print("{}: {} iterations, {} evaluations\n", a.output, info.iterations, info.evaluations);
        return ExitCode::done;
    }
    const auto rows = read_weight_rows(a.path);
    for (std::size_t frame = 0; frame < rows.size(); ++frame) probe_output(frame_name(a.output, frame), { a.asset, a.path });
    ConsoleProgress progress("blend", a.is_quiet);
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    for (std::size_t frame = 0; frame < rows.size(); ++frame) {
        progress.update("frames", double(frame) / double(rows.size()));
        write_frame(blender, blender.solve(to_floats(rows[frame]), true, &info), how, frame_name(a.output, frame));
        frames.push_back(to_json(frame_name(a.output, frame), info));
    }
    progress.clear_line();
    if (a.is_json)
        print_frames(a, frames);
    else if (!a.is_quiet)
        fmt::print("{} frames\n", rows.size());
    return ExitCode::done;
}

} // namespace

Verb add_blend(CLI::App& app)
{
    auto a = std::make_shared<BlendArguments>();
    CLI::App* verb = app.add_subcommand("blend", "Compute blends with the runtime and write them as meshes");
    verb->footer("Examples:\n  pliant blend hero.pliant --weights 0.5,0.25,0.25 -o blend.ply\n"
                 "  pliant blend hero.pliant --path weights.csv -o frame_%04d.ply");
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    verb->add_option("-w,--weights", a->weights, "One weight per pose, separated by commas; only their ratios matter")
        ->type_name("W1,W2,...");
    verb->add_option("--path", a->path, "File with one line of weights per frame")->type_name("FILE.csv");
    verb->add_option("-o,--output", a->output, "Mesh to write; with --path a pattern such as frame_%04d.ply")
        ->required()
        ->type_name("OUT.ply");
    add_all_vertices(*verb, a->all_vertices);
    add_json(*verb, a->is_json);
    add_quiet(*verb, a->is_quiet);
    return [a] { return run_blend(*a); };
}

} // namespace pliant
