#include "cli/verbs.h"

#include "base/common/print.h"
#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "output/asset/runtime_blender.h"
#include "pipeline/json_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <memory>
#include <set>

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

// Returns how many vertices the mesh has.
std::size_t write_frame(const RuntimeBlender& blender, const std::vector<float>& q, const Writing& how,
                        const std::string& path)
{
    const std::vector<float> positions = blender.positions(q);
    const Eigen::Index count = Eigen::Index(positions.size() / 3);
    using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const Positions rows = Eigen::Map<const FloatRows>(positions.data(), count, 3).cast<double>();
    write_output(path, encode_ply(rows, how.faces, how.numbers, how.all_vertices));
    return how.all_vertices || !how.numbers.boundary_count ? std::size_t(count) : how.numbers.boundary_count;
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

std::vector<std::string> weight_names(const pliant_asset& asset)
{
    std::vector<std::string> names;
    pliant_weight weight;
    for (std::uint32_t i = 0; pliant_asset_weight(&asset, i, &weight) == PLIANT_OK; ++i) names.push_back(weight.name);
    return names;
}

[[noreturn]] void fail_set(const BlendArguments& a, const std::string& what, const std::string& hint)
{
    throw Failure(ExitCode::usage, error_at(1236, a.asset, "--set " + what, hint));
}

// Which weight the name of a --set means.
std::size_t find_weight(const BlendArguments& a, const std::string& text, const std::vector<std::string>& names)
{
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos) fail_set(a, fmt::format("'{}' has no '='", text), "write NAME=W, as " + text + "=1");
    const std::string name = text.substr(0, equals);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        const std::string nearest = nearest_word(name, names);
        fail_set(a, fmt::format("'{}' names no weight of the asset", text),
                 name.find('=') != std::string::npos ? "give one --set for each name: --set A=1 --set B=0.5"
                     : nearest.empty()               ? fmt::format("the names are {}", fmt::join(names, ", "))
                                                     : fmt::format("did you mean {}={}?", nearest, text.substr(equals + 1)));
    }
    if (std::find(found + 1, names.end(), name) != names.end())
        fail_set(a, fmt::format("'{}' names two weights of the asset", text), "give all weights with --weights");
    return std::size_t(found - names.begin());
}

// --set: layers that are not named keep the weight that the asset starts with, poses take no part.
std::vector<float> weights_by_name(const BlendArguments& a, const RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    const std::vector<std::string> names = weight_names(asset);
    std::vector<float> weights(asset.weight_count);
    for (std::uint32_t i = 0; asset.has_layers && i < asset.weight_count; ++i) {
        pliant_weight weight {};
        pliant_asset_weight(&asset, i, &weight);
        weights[i] = weight.initial;
    }
    std::set<std::size_t> given;
    for (const std::string& text : a.set) {
        const std::size_t i = find_weight(a, text, names);
        if (!given.insert(i).second) fail_set(a, fmt::format("'{}' gives {} a second time", text, names[i]), "give it once");
        weights[i] = to_floats({ parse_weight(text.substr(text.rfind('=') + 1)) })[0];
    }
    return weights;
}

// The work of a frame is for those who ask, -v.
std::string work_text(const pliant_solve_info& info, bool is_verbose)
{
    return is_verbose ? fmt::format(", {} iterations, {} evaluations", info.iterations, info.evaluations) : "";
}

ExitCode blend_once(const BlendArguments& a, RuntimeBlender& blender, const Writing& how)
{
    pliant_solve_info info {};
    const std::vector<float> weights = a.set.empty() ? to_floats(parse_weights(a.weights)) : weights_by_name(a, blender);
    try_outputs({ a.output }, { a.asset });
    require_suffix("--output", a.output, ".ply");
    require_no_pattern(a.output, "--path");
    const std::size_t count = write_frame(blender, blender.solve(weights, false, &info), how, a.output);
    if (a.is_json)
        print_frames(a, nlohmann::ordered_json::array({ to_json(a.output, info) }));
    else if (!a.talk.is_quiet)
        print_to(stdout, "{}: {} vertices{}{}\n", printable(a.output), count, work_text(info, a.talk.is_verbose),
                 info.outside > 0 ? ", outside of the measured ranges" : "");
    return ExitCode::done;
}

ExitCode blend_path(const BlendArguments& a, RuntimeBlender& blender, const Writing& how)
{
    std::vector<std::vector<float>> rows;
    const WeightDomain domain = blender.domain();
    read_weight_path(a.path, [&](const std::vector<double>& weights) {
        rows.push_back(to_floats(weights));
        domain.from({ rows.back().begin(), rows.back().end() }); // throws what the solver would
    });
    std::vector<std::string> outputs;
    for (std::size_t frame = 0; frame < rows.size(); ++frame) outputs.push_back(frame_name(a.output, frame));
    try_outputs(outputs, { a.asset, a.path });
    require_suffix("--output", a.output, ".ply");
    ConsoleProgress progress("blend", a.talk);
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    pliant_solve_info info {};
    std::size_t count = 0, outside_count = 0;
    for (std::size_t frame = 0; frame < rows.size(); ++frame) {
        progress.update("frames", double(frame) / double(rows.size()));
        count = write_frame(blender, blender.solve(rows[frame], true, &info), how, frame_name(a.output, frame));
        outside_count += info.outside > 0;
        frames.push_back(to_json(frame_name(a.output, frame), info));
    }
    progress.clear_line();
    if (a.is_json)
        print_frames(a, frames);
    else if (!a.talk.is_quiet)
        print_to(stdout, "{} frames of {} vertices{}\n", rows.size(), count,
                 outside_count ? fmt::format(", {} of them outside of the measured ranges", outside_count) : "");
    return ExitCode::done;
}

ExitCode run_blend(const BlendArguments& a)
{
    if (int(!a.weights.empty()) + int(!a.path.empty()) + int(!a.set.empty()) != 1)
        throw Failure(ExitCode::usage,
                      error_at(1202, "", "give one of --weights, --set and --path", "see `pliant blend --help`"));
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    const Writing how
        = { blender.faces(), { blender.source_vertices(), blender.asset().boundary_vertex_count }, a.all_vertices };
    return a.path.empty() ? blend_once(a, blender, how) : blend_path(a, blender, how);
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
