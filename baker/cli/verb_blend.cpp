#include "cli/verbs.h"

#include "base/common/print.h"
#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "output/asset/runtime_blender.h"
#include "pipeline/json_file.h"

#include <fmt/core.h>
#include <map>
#include <memory>

namespace pliant {

namespace {

struct BlendArguments {
    std::string asset, weights, path, output;
    std::vector<std::string> set;
    bool all_vertices = false, is_json = false;
    Talk talk;
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
    return { { "output", output },
             { "iterations", info.iterations },
             { "evaluations", info.evaluations },
             { "outside", info.outside } };
}

void print_frames(const BlendArguments& a, const nlohmann::ordered_json& frames)
{
    const nlohmann::ordered_json json = { { "asset", a.asset }, { "frames", frames } };
    print_to(stdout, "{}\n", json_text(json));
}

std::string names_of(const pliant_asset& asset)
{
    std::string names;
    pliant_weight weight;
    for (std::uint32_t i = 0; pliant_asset_weight(&asset, i, &weight) == PLIANT_OK; ++i)
        names += (names.empty() ? "" : ", ") + std::string(weight.name);
    return names;
}

// --set: layers that are not named keep the weight that the asset starts with, poses take no part.
std::vector<float> weights_by_name(const BlendArguments& a, const RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    std::vector<float> weights(asset.weight_count);
    std::map<std::string, std::uint32_t> places;
    pliant_weight weight;
    for (std::uint32_t i = 0; pliant_asset_weight(&asset, i, &weight) == PLIANT_OK; ++i) {
        places.emplace(weight.name, i); // of equal names the first
        if (asset.has_layers) weights[i] = weight.initial;
    }
    for (const std::string& text : a.set) {
        const std::size_t equals = text.rfind('=');
        const auto found = places.find(text.substr(0, equals));
        if (equals == std::string::npos || found == places.end())
            throw Failure(ExitCode::usage,
                          error_at(1236, a.asset, fmt::format("--set '{}' names no weight of the asset", text),
                                   fmt::format("write NAME=W; the names are {}", names_of(asset))));
        weights[found->second] = to_floats(parse_weights(text.substr(equals + 1)))[0];
    }
    return weights;
}

ExitCode run_blend(const BlendArguments& a)
{
    if (int(!a.weights.empty()) + int(!a.path.empty()) + int(!a.set.empty()) != 1)
        throw Failure(ExitCode::usage,
                      error_at(1202, "", "give one of --weights, --set and --path", "see `pliant blend --help`"));
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    const Writing how
        = { blender.faces(), { blender.source_vertices(), blender.asset().boundary_vertex_count }, a.all_vertices };
    pliant_solve_info info {};
    if (a.path.empty()) {
        const std::vector<float> weights = a.set.empty() ? to_floats(parse_weights(a.weights)) : weights_by_name(a, blender);
        probe_output(a.output, { a.asset });
        require_suffix("--output", a.output, ".ply");
        write_frame(blender, blender.solve(weights, false, &info), how, a.output);
        if (a.is_json)
            print_frames(a, nlohmann::ordered_json::array({ to_json(a.output, info) }));
        else if (!a.talk.is_quiet)
            print_to(stdout, "{}: {} iterations, {} evaluations{}\n", a.output, info.iterations, info.evaluations,
                     info.outside > 0 ? ", outside of the measured ranges" : "");
        return ExitCode::done;
    }
    const auto rows = read_weight_rows(a.path);
    for (std::size_t frame = 0; frame < rows.size(); ++frame) probe_output(frame_name(a.output, frame), { a.asset, a.path });
    require_suffix("--output", a.output, ".ply");
    ConsoleProgress progress("blend", a.talk);
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    for (std::size_t frame = 0; frame < rows.size(); ++frame) {
        progress.update("frames", double(frame) / double(rows.size()));
        write_frame(blender, blender.solve(to_floats(rows[frame]), true, &info), how, frame_name(a.output, frame));
        frames.push_back(to_json(frame_name(a.output, frame), info));
    }
    progress.clear_line();
    if (a.is_json)
        print_frames(a, frames);
    else if (!a.talk.is_quiet)
        print_to(stdout, "{} frames\n", rows.size());
    return ExitCode::done;
}

} // namespace

Verb add_blend(CLI::App& app)
{
    auto a = std::make_shared<BlendArguments>();
    CLI::App* verb = app.add_subcommand("blend", "Compute blends with the runtime and write them as meshes");
    verb->footer("Examples:\n  pliant blend hero.pliant --weights 0.5,0.25,0.25 -o blend.ply\n"
                 "  pliant blend face.pliant --set smile=1 --set blink=1.2 -o face.ply\n"
                 "  pliant blend hero.pliant --path weights.csv -o frame_%04d.ply");
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    verb->add_option(
            "-w,--weights", a->weights,
            "One weight per pose, separated by commas; only their ratios matter. Of layers one weight per layer, as "
            "it is")
        ->type_name("W1,W2,...");
    verb->add_option(
            "--set", a->set,
            "The weight of one pose or layer by its name (`pliant info` lists them); may be repeated. Others are 0, "
            "or what the file's layers start with")
        ->type_name("NAME=W")
        ->expected(1, -1)
        ->allow_extra_args(false);
    verb->add_option("--path", a->path, "File with one line of weights per frame")->type_name("FILE.csv");
    verb->add_option("-o,--output", a->output, "Mesh to write; with --path a pattern such as frame_%04d.ply")
        ->required()
        ->type_name("OUT.ply");
    add_all_vertices(*verb, a->all_vertices);
    add_json(*verb, a->is_json);
    add_talk(*verb, a->talk);
    return [a] { return run_blend(*a); };
}

} // namespace pliant
