#include "run/options.h"

#include "blend/error.h"

#include <CLI/CLI.hpp>

#include <cmath>
#include <iostream>

namespace pliant::player {
namespace {

constexpr int largest_side = 16384;

constexpr char help_footer[] = R"(
A window
  pliant-player creature.pliant
      Drag the point inside the control polygon: each corner is a pose, the point mixes them. The shape is the elastic
      average; L shows the linear blend instead, B both side by side. H lists all keys.

Pictures, with or without a display
  pliant-player creature.pliant --screenshot blend.png --weights 0.5,0,0.5 --view=-35,10 --size 1600x1000
  pliant-player creature.pliant --sheet sheet.png
      Weights are numbers >= 0, one for each pose in the order of `pliant info`; only their ratios matter.

  pliant-player creature.pliant --sequence frame_%04d.png --path weights.csv
      weights.csv has a line a frame, the weights separated by commas, as `pliant blend --path` reads it.
  pliant-player creature.pliant --screenshot three.png --truth truth.csv truth_%04d.ply --heat
      Linear, elastic and unreduced, after: pliant average POSE... --grid 8 --list truth.csv -o truth_%04d.ply

Measuring
  pliant-player creature.pliant --frames 2000 --json
      Blends along the path that the window plays, draws nothing, prints medians.
  pliant-player creature.pliant --crowd 100 --frames 500 --json
      The same for a hundred characters at a time, on one core; with --rebuild gpu pliant::gl rebuilds them.

Exit code: 0 done, 1 failed while working, 2 wrong usage, 3 bad asset.)";

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorNumber::usage, ExitCode::usage, what, hint);
}

void parse_weights(const std::string& text, Options& options)
{
    options.weights = parse_numbers(text, ',');
    if (!normalise_weights(options.weights)) {
        throw Error(ErrorNumber::weights, ExitCode::usage, "--weights: '" + text + "' is not a list of weights",
                    "give one number >= 0 for each pose, separated by commas, not all zero: --weights 0.5,0.5,0");
    }
}

void parse_size(const std::string& text, Options& options)
{
    const std::vector<double> sides = parse_numbers(text, 'x');
    bool good = sides.size() == 2;
    for (double side : sides) good = good && side >= 16 && side <= largest_side && side == std::floor(side);
    if (!good) refuse("--size: '" + text + "' is not a size", "give pixels, 16 to 16384 each way: --size 1280x800");
    options.width = static_cast<int>(sides[0]);
    options.height = static_cast<int>(sides[1]);
}

void parse_view(const std::string& text, Options& options)
{
    const std::vector<double> angles = parse_numbers(text, ',');
    if (angles.size() != 2) refuse("--view: '" + text + "' is not a view", "give yaw and pitch in degrees: --view=-35,10");
    options.view = glm::vec2(angles[0], angles[1]);
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
            refuse_together("--sequence needs --path or --count", "--count 120 goes once along the idle path");
    } else if (options.count > 0) {
        refuse_together("--count belongs to --sequence", "add --sequence frame_%04d.png");
    }
    if (fps_given && options.path.empty()) refuse_together("--fps belongs to --path", "it is how many lines play a second");
    if (!options.path.empty() && !options.weights.empty())
        refuse_together("--path and --weights exclude each other", "the path has its own weights");
    if (!options.path.empty() && (!options.screenshot.empty() || !options.sheet.empty()))
        refuse_together("--path is not for single pictures", "use --sequence frame_%04d.png");
    if (!options.sequence.empty() && !options.weights.empty())
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
    if (!options.sheet.empty() || !options.weights.empty() || !options.truth_weights.empty() || options.both
        || options.heat) {
        refuse_together("--crowd shows one kind of blend, each character at weights of its own",
                        "leave out --sheet, --weights, --truth, --both and --heat");
    }
}

void check_combination(const Options& options, bool fps_given)
{
    const int modes
        = !options.screenshot.empty() + !options.sheet.empty() + !options.sequence.empty() + (options.benchmark_frames > 0);
    if (modes > 1)
        refuse("--screenshot, --sheet, --sequence and --frames exclude each other", "run the player once for each");
    if (options.json && options.benchmark_frames == 0) refuse("--json belongs to --frames", "add --frames 1000");
    if (options.linear && options.both)
        refuse("--linear and --both exclude each other", "--both shows linear beside elastic");
    if (!options.sheet.empty() && !options.weights.empty())
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
    CLI::App app("Plays a .pliant asset: blends whole shapes elastically, by dragging a point in a polygon of poses.",
                 "pliant-player");
    app.footer(help_footer);
    app.set_version_flag("--version", [] {
        const std::uint32_t v = pliant_version();
        return "pliant-player " + std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "."
            + std::to_string(v % 100);
    });
    app.add_option("ASSET", options.asset,
                   "the .pliant file, made by `pliant bake`, or a .glb with one inside (`pliant export --embed`)")
        ->required();
    app.add_option("--screenshot", options.screenshot, "draw one picture into this PNG file")->type_name("OUT.png");
    app.add_option("--sheet", options.sheet, "draw a contact sheet: the poses, and blends of them, linear beside elastic")
        ->type_name("OUT.png");
    app.add_option("--sequence", options.sequence,
                   "draw one picture after the other along a path; the name holds %04d or %d")
        ->type_name("OUT_%04d.png");
    app.add_option("--count", options.count,
                   "with --sequence: how many pictures, evenly along the loop (default: one per line)")
        ->type_name("N")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--frames", options.benchmark_frames, "measure this many blends, draw nothing")
        ->type_name("N")
        ->check(CLI::Range(1, 10000000));
    app.add_flag("--json", options.json, "with --frames: print JSON");
    app.add_option("--weights", weights, "weights to start with (default: equal)")->type_name("W1,W2,...");
    app.add_option("--path", options.path, "play these weights in a loop, a line a frame, in between they are mixed")
        ->type_name("WEIGHTS.csv");
    CLI::Option* fps = app.add_option("--fps", options.fps, "with --path: lines a second in the window (default: 30)")
                           ->type_name("N")
                           ->check(CLI::Range(0.001, 1000.0));
    app.add_option("--crowd", options.crowd, "many characters, each with its own solver, and a graph of the frames' times")
        ->type_name("N")
        ->check(CLI::Range(1, 10000));
    app.add_option("--rebuild", rebuild,
                   "with --crowd: who makes positions and normals, pliant::gl or the processor (default: auto, which is gpu "
                   "unless the driver draws on the processor; with --frames cpu)")
        ->type_name("auto|gpu|cpu")
        ->check(CLI::IsMember({ "auto", "gpu", "cpu" }));
    std::vector<std::string> truth;
    app.add_option("--truth", truth, "unreduced averages (`pliant average --grid`): their weights and their meshes")
        ->type_name("WEIGHTS.csv MESH_%04d.ply")
        ->type_size(2);
    app.add_flag("--heat", options.heat, "colours: distance to the unreduced average, or between linear and elastic");
    app.add_flag("--linear", options.linear, "the linear blend instead of the elastic one");
    app.add_flag("--both", options.both, "linear and elastic side by side");
    app.add_flag("--plain", options.plain,
                 "every kind of blend in its own colour, without the asset's materials and textures");
    app.add_option("--size", size, "size of window or picture, with --sheet of one cell")->type_name("WxH");
    app.add_option("--view", view, "where to look from, degrees")->type_name("YAW,PITCH");
    app.add_option("--up", up, "which axis of the asset points up (default: y)")
        ->type_name("y|z")
        ->check(CLI::IsMember({ "y", "z" }));
    CLI::Option* hud = app.add_flag("--hud", options.hud, "with --screenshot: draw the panels too");
    app.add_flag("--no-hud", no_hud, "with --screenshot: the character alone (default)")->excludes(hud);
    app.add_option("--exit-after", options.exit_after, "close the window after this many seconds")
        ->type_name("SECONDS")
        ->check(CLI::PositiveNumber);
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
    if (options.path.empty()) return std::nullopt;
    return WeightPath(options.path, file.view().pose_count);
}

std::vector<double> weights_for(const Options& options, const AssetFile& file)
{
    const std::uint32_t pose_count = file.view().pose_count;
    std::vector<double> weights = options.weights;
    if (weights.empty()) weights.assign(pose_count, 1.0);
    if (weights.size() != pose_count) {
        std::string names;
        for (const std::string& name : file.pose_names()) names += (names.empty() ? "" : ", ") + name;
        throw Error(ErrorNumber::weights, ExitCode::usage,
                    "--weights: " + std::to_string(weights.size()) + " weights for " + std::to_string(pose_count) + " poses",
                    "the poses of " + file.path() + " are: " + names);
    }
    normalise_weights(weights);
    return weights;
}

} // namespace pliant::player
