#include "run/options.h"

#include "blend/error.h"
#include "blend/layer_walk.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <iostream>

namespace pliant::player {
namespace {

constexpr int largest_side = 16384;

constexpr char help_footer[] = R"(
A window
  pliant-player creature.pliant
      Drag the point inside the control polygon. Each corner is a pose; the place of the point gives the weights. The
      shape is the elastic blend. L shows the linear blend instead, B shows both side by side, H lists all keys.
      An asset of layers (`pliant bake --blend layers`) has a slider for each layer instead of the polygon.

Pictures, with or without a display
  pliant-player creature.pliant --screenshot blend.png --weights 0.5,0,0.5 --view=-35,10 --size 1600x1000
  pliant-player creature.pliant --sheet sheet.png
      Weights are numbers >= 0, one per pose in the order of `pliant info`; only their ratios matter. If the asset has
      layers, they are any numbers, one per layer, and add up.
  pliant-player face.pliant --screenshot smile.png --set smile=0.8 --set jaw_open=0.3 --hud

  pliant-player creature.pliant --sequence frame_%04d.png --path weights.csv
      weights.csv has one line of weights per frame, separated by commas, as for `pliant blend --path`.
  pliant-player creature.pliant --screenshot three.png --truth truth.csv truth_%04d.ply --heat
      Linear, elastic and unreduced side by side. Compute the unreduced averages first:
      pliant average POSE... --grid 8 --list truth.csv -o truth_%04d.ply

Measuring
  pliant-player creature.pliant --frames 2000 --json
      Computes blends along the path that the window plays, draws nothing, and prints medians.
  pliant-player creature.pliant --crowd 100 --frames 500 --json
      The same for a hundred characters on one core. With --rebuild gpu, pliant::gl rebuilds their shapes.

Exit code: 0 success, 1 failure, 2 wrong usage, 3 bad input file.)";

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorNumber::usage, ExitCode::usage, what, hint);
}

[[noreturn]] void refuse_weights(const std::string& what, const std::string& hint)
{
    throw Error(ErrorNumber::weights, ExitCode::usage, what, hint);
}

constexpr char weights_hint[] = "give one number >= 0 per pose, separated by commas, not all zero: --weights 0.5,0.5,0";

void parse_weights(const std::string& text, Options& options)
{
    options.weights = parse_numbers(text, ',');
    if (options.weights.empty()) refuse_weights("--weights: '" + text + "' is not a list of weights", weights_hint);
}

void parse_size(const std::string& text, Options& options)
{
    const std::vector<double> sides = parse_numbers(text, 'x');
    bool good = sides.size() == 2;
    for (double side : sides) good = good && side >= 16 && side <= largest_side && side == std::floor(side);
    if (!good)
        refuse("--size: '" + text + "' is not a size", "give width and height in pixels, 16 to 16384: --size 1280x800");
    options.width = static_cast<int>(sides[0]);
    options.height = static_cast<int>(sides[1]);
}

void parse_view(const std::string& text, Options& options)
{
    const std::vector<double> angles = parse_numbers(text, ',');
    if (angles.size() != 2) refuse("--view: '" + text + "' is not a view", "give yaw and pitch in degrees: --view=-35,10");
    options.view = glm::vec2(angles[0], angles[1]);
}

// CLI::Range and CLI::PositiveNumber take nan.
std::string is_number(const std::string& text)
{
    double number = 0;
    return CLI::detail::lexical_cast(text, number) && std::isnan(number) ? "Value " + text + " is not a number" : "";
}

// What is written is a picture by its name, so no asset, path or mesh is lost by a wrong word.
void check_picture(const std::string& option, const std::string& path)
{
    std::string suffix = std::filesystem::path(path).extension().string();
    std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!path.empty() && suffix != ".png")
        refuse(option + ": '" + path + "' does not end in .png", "pictures are PNG files");
}

[[noreturn]] void refuse_together(const std::string& what, const std::string& hint)
{
    throw Error(ErrorNumber::modes_exclude, ExitCode::usage, what, hint);
}

void check_path_and_sequence(const Options& options, bool fps_given)
{
    if (!options.sequence.empty()) {
        numbered_name("--sequence", options.sequence, 0);
        if (options.path.empty() && options.count == 0)
            refuse_together("--sequence needs --path or --count", "--count 120 draws one loop of the idle path");
    } else if (options.count > 0) {
        refuse_together("--count belongs to --sequence", "add --sequence frame_%04d.png");
    }
    if (fps_given && options.path.empty())
        refuse_together("--fps belongs to --path", "it is the number of lines played per second");
    if (!options.path.empty() && options.has_weights())
        refuse_together("--path and --weights exclude each other", "the path has its own weights");
    if (!options.path.empty() && (!options.screenshot.empty() || !options.sheet.empty()))
        refuse_together("--path is not for single pictures", "use --sequence frame_%04d.png");
    if (!options.sequence.empty() && options.has_weights())
        refuse_together("--sequence chooses its own weights", "use --screenshot --weights ... for one blend");
}

void check_truth_heat_and_crowd(const Options& options)
{
    const bool draws_blends = options.sheet.empty() && options.benchmark_frames == 0;
    if (!options.truth_weights.empty()) {
        numbered_name("--truth", options.truth_pattern, 0);
        if (!draws_blends) refuse_together("--truth is not for --sheet and --frames", "use --screenshot or the window");
    }
    if (options.heat && !draws_blends)
        refuse_together("--heat is not for --sheet and --frames", "use --screenshot or the window");
    if (options.crowd == 0) {
        if (options.rebuild != Rebuild::automatic)
            refuse_together("--rebuild belongs to --crowd", "add --crowd 100, or leave it out");
        return;
    }
    if (!options.sheet.empty() || options.has_weights() || !options.truth_weights.empty() || options.both || options.heat) {
        refuse_together("--crowd shows one kind of blend, each character with its own weights",
                        "leave out --sheet, --weights, --truth, --both and --heat");
    }
}

void check_combination(const Options& options, bool fps_given)
{
    const int modes
        = !options.screenshot.empty() + !options.sheet.empty() + !options.sequence.empty() + (options.benchmark_frames > 0);
    if (modes > 1)
        refuse("--screenshot, --sheet, --sequence and --frames exclude each other", "run the player once for each");
    check_picture("--screenshot", options.screenshot);
    check_picture("--sheet", options.sheet);
    check_picture("--sequence", options.sequence);
    if (options.json && options.benchmark_frames == 0) refuse("--json belongs to --frames", "add --frames 1000");
    if (options.linear && options.both)
        refuse("--linear and --both exclude each other", "--both shows linear next to elastic");
    if (!options.sheet.empty() && options.has_weights())
        refuse("--sheet chooses its own weights", "use --screenshot --both --weights ... for one blend");
    check_path_and_sequence(options, fps_given);
    check_truth_heat_and_crowd(options);
}

} // namespace

glm::mat3 Options::to_world() const
{
    if (!up_is_z) return glm::mat3(1.0f);
    return { { 1.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, -1.0f }, { 0.0f, 1.0f, 0.0f } }; // columns: (x, y, z) becomes (x, z, -y)
}

ParsedLine parse_command_line(int argc, char** argv)
{
    Options options;
    std::string weights, size, view, up = "y", rebuild = "auto";
    bool no_hud = false;
    CLI::App app("Plays a .pliant asset: drag a point in a polygon of poses to blend whole shapes elastically.",
                 "pliant-player");
    app.footer(help_footer);
    app.set_version_flag("--version", [] {
        const std::uint32_t v = pliant_version();
        return "pliant-player " + std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "."
            + std::to_string(v % 100);
    });
    app.add_option("ASSET", options.asset, ".pliant file of `pliant bake`, or .glb file of `pliant export --embed`")
        ->required();
    app.add_option("--screenshot", options.screenshot, "draw one picture into this PNG file")->type_name("OUT.png");
    app.add_option("--sheet", options.sheet,
                   "draw a contact sheet of the poses and their blends, linear next to elastic, into this PNG file")
        ->type_name("OUT.png");
    app.add_option("--sequence", options.sequence, "draw pictures along a path; the file name contains %04d or %d")
        ->type_name("OUT_%04d.png");
    app.add_option("--count", options.count,
                   "with --sequence: number of pictures, evenly spaced along the path (default: one per line)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--frames", options.benchmark_frames, "measure the time of this many blends, draw nothing")
        ->type_name("N")
        ->check(CLI::Range(1, 10000000));
    app.add_flag("--json", options.json, "with --frames: print JSON");
    app.add_option("--weights", weights, "initial weights (default: equal, of layers those that the asset starts with)")
        ->type_name("W1,W2,...");
    app.add_option("--set", options.set_weights, "initial weight of one layer by its name; may be repeated")
        ->type_name("NAME=W")
        ->allow_extra_args(false);
    app.add_option("--path", options.path,
                   "play the weights of this file in a loop, one line per frame, interpolated between lines")
        ->type_name("WEIGHTS.csv");
    CLI::Option* fps = app.add_option("--fps", options.fps, "with --path: lines per second in the window (default: 30)")
                           ->type_name("N")
                           ->check(CLI::Range(0.001, 1000.0))
                           ->check(is_number);
    app.add_option("--crowd", options.crowd, "show N characters, each with its own solver, and a graph of the frame times")
        ->type_name("N")
        ->check(CLI::Range(1, 10000));
    app.add_option(
           "--rebuild", rebuild,
           "with --crowd: compute positions and normals on the GPU (pliant::gl) or on the CPU (default: auto, which is gpu "
           "unless the driver renders in software; with --frames cpu)")
        ->type_name("auto|gpu|cpu")
        ->check(CLI::IsMember({ "auto", "gpu", "cpu" }));
    std::vector<std::string> truth;
    app.add_option("--truth", truth,
                   "also show unreduced averages: files of their weights and meshes (see `pliant average --grid`)")
        ->type_name("WEIGHTS.csv MESH_%04d.ply")
        ->type_size(2);
    app.add_flag("--heat", options.heat,
                 "colour the distance from the unreduced average or, without --truth, between linear and elastic");
    app.add_flag("--linear", options.linear, "show the linear blend instead of the elastic blend");
    app.add_flag("--both", options.both, "show linear and elastic side by side");
    app.add_flag("--plain", options.plain, "one colour per kind of blend instead of the asset's materials and textures");
    app.add_flag("--wire", options.wire, "also draw the edges of all triangles");
    app.add_option("--size", size, "size of the window or picture in pixels; with --sheet the size of one cell")
        ->type_name("WxH");
    app.add_option("--view", view, "direction of view in degrees")->type_name("YAW,PITCH");
    app.add_option("--up", up, "axis of the asset that points up (default: y)")
        ->type_name("y|z")
        ->check(CLI::IsMember({ "y", "z" }));
    CLI::Option* hud = app.add_flag("--hud", options.hud, "with --screenshot: also draw the panels");
    app.add_flag("--no-hud", no_hud, "with --screenshot: draw the character only (default)")->excludes(hud);
    app.add_option("--exit-after", options.exit_after, "close the window after this many seconds")
        ->type_name("SECONDS")
        ->check(CLI::PositiveNumber)
        ->check(is_number);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        return { options, app.exit(success) };
    } catch (const CLI::ParseError& error) {
        refuse(error.what(), "pliant-player --help explains all options");
    }
    options.up_is_z = up == "z";
    options.rebuild = rebuild == "gpu" ? Rebuild::gpu : rebuild == "cpu" ? Rebuild::cpu : Rebuild::automatic;
    if (!weights.empty()) parse_weights(weights, options);
    if (!size.empty()) parse_size(size, options);
    if (!view.empty()) parse_view(view, options);
    if (!truth.empty()) {
        options.truth_weights = truth[0];
        options.truth_pattern = truth[1];
    }
    check_combination(options, fps->count() > 0);
    return { options, std::nullopt };
}

std::optional<WeightPath> path_for(const Options& options, const AssetFile& file)
{
    if (!options.path.empty()) return WeightPath(options.path, file.view().weight_count, file.has_layers());
    if (file.has_layers()) return layer_walk(file.weights());
    return std::nullopt;
}

namespace {

std::string names_of(const AssetFile& file)
{
    std::string names;
    for (std::size_t k = file.has_layers() ? 1 : 0; k < file.pose_names().size(); ++k)
        names += (names.empty() ? "" : ", ") + file.pose_names()[k];
    return std::string("the ") + (file.has_layers() ? "layers" : "poses") + " of " + file.path() + " are: " + names;
}

void set_weight(const std::string& text, const AssetFile& file, std::vector<double>& weights)
{
    const std::size_t equals = text.rfind('=');
    const std::vector<double> value
        = equals == std::string::npos ? std::vector<double>() : parse_numbers(text.substr(equals + 1), ',');
    if (value.size() != 1) refuse_weights("--set: '" + text + "' is not a name and a weight", "write it as --set smile=0.8");
    const std::string name = text.substr(0, equals);
    for (std::size_t k = 0; k < weights.size(); ++k) {
        if (file.weights()[k].name != name) continue;
        weights[k] = value[0];
        return;
    }
    refuse_weights("--set: there is no layer '" + name + "'", names_of(file));
}

std::vector<double> weights_of_layers(const Options& options, const AssetFile& file)
{
    std::vector<double> weights = options.weights;
    if (weights.empty())
        for (const WeightRange& layer : file.weights()) weights.push_back(layer.initial);
    if (weights.size() == file.view().weight_count)
        for (const std::string& text : options.set_weights) set_weight(text, file, weights);
    if (!are_finite(weights))
        refuse_weights("--weights: a weight is not finite in single precision", "give smaller numbers");
    return weights;
}

std::vector<double> weights_of_average(const Options& options, const AssetFile& file)
{
    if (!options.set_weights.empty()) refuse_weights("--set: " + file.path() + " has no layers", "give --weights");
    std::vector<double> weights = options.weights;
    if (weights.empty()) weights.assign(file.view().weight_count, 1.0);
    if (!normalise_weights(weights)) refuse_weights("--weights: they are not all >= 0 with a positive sum", weights_hint);
    return weights;
}

} // namespace

std::vector<double> weights_for(const Options& options, const AssetFile& file)
{
    std::vector<double> weights = file.has_layers() ? weights_of_layers(options, file) : weights_of_average(options, file);
    if (weights.size() != file.view().weight_count) {
        refuse_weights("--weights: " + count_of_weights(weights.size(), file.view().weight_count, file.has_layers()),
                       names_of(file));
    }
    return weights;
}

} // namespace pliant::player
