#include "options.h"

#include "error.h"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <iostream>

namespace pliant::player {

namespace {

constexpr int kLargestSide = 16384;

constexpr char kFooter[] = R"(
A window
  pliant-player creature.pliant
      Drag the point inside the control polygon: each corner is a pose, the point mixes them. The shape is the elastic
      average; L shows the linear blend instead, B both side by side. H lists all keys.

Pictures, with or without a display
  pliant-player creature.pliant --screenshot blend.png --weights 0.5,0,0.5 --view=-35,10 --size 1600x1000
  pliant-player creature.pliant --sheet sheet.png
      Weights are numbers >= 0, one for each pose in the order of `pliant info`; only their ratios matter.

Measuring
  pliant-player creature.pliant --frames 2000 --json
      Blends along the path that the window plays, draws nothing, prints medians.

Exit code: 0 done, 1 failed while working, 2 wrong usage, 3 bad asset.)";

[[noreturn]] void refuse(const std::string& what, const std::string& hint)
{
    throw Error(ErrorNumber::usage, ExitCode::usage, what, hint);
}

// Numbers with a separator between them, locale or not. Empty if the text is anything else.
std::vector<double> parse_numbers(const std::string& text, char separator)
{
    std::vector<double> numbers;
    const char* at = text.data();
    const char* end = at + text.size();
    while (true) {
        double value = 0.0;
        const auto [stop, error] = std::from_chars(at, end, value);
        if (error != std::errc() || !std::isfinite(value)) return {};
        numbers.push_back(value);
        if (stop == end) return numbers;
        if (*stop != separator) return {};
        at = stop + 1;
    }
}

void parse_weights(const std::string& text, Options& options)
{
    options.weights = parse_numbers(text, ',');
    double sum = 0.0;
    bool good = !options.weights.empty();
    for (double weight : options.weights) {
        good = good && weight >= 0.0;
        sum += weight;
    }
    if (!good || !(sum > 0.0)) {
        throw Error(ErrorNumber::weights, ExitCode::usage, "--weights: '" + text + "' is not a list of weights",
                    "give one number >= 0 for each pose, separated by commas, not all zero: --weights 0.5,0.5,0");
    }
}

void parse_size(const std::string& text, Options& options)
{
    const std::vector<double> sides = parse_numbers(text, 'x');
    bool good = sides.size() == 2;
    for (double side : sides) good = good && side >= 16 && side <= kLargestSide && side == std::floor(side);
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

void check_combination(const Options& options)
{
    const int modes = !options.screenshot.empty() + !options.sheet.empty() + (options.benchmark_frames > 0);
    if (modes > 1) refuse("--screenshot, --sheet and --frames exclude each other", "run the player once for each");
    if (options.json && options.benchmark_frames == 0) refuse("--json belongs to --frames", "add --frames 1000");
    if (options.linear && options.both)
        refuse("--linear and --both exclude each other", "--both shows linear beside elastic");
    if (!options.sheet.empty() && !options.weights.empty()) {
        refuse("--sheet chooses its own weights", "use --screenshot --both --weights ... for one blend");
    }
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
    std::string weights, size, view, up = "y";
    bool no_hud = false;
    CLI::App app("Plays a .pliant asset: blends whole shapes elastically, by dragging a point in a polygon of poses.",
                 "pliant-player");
    app.footer(kFooter);
    app.set_version_flag("--version", [] {
        const uint32_t v = pliant_version();
        return "pliant-player " + std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "."
            + std::to_string(v % 100);
    });
    app.add_option("ASSET", options.asset, "the .pliant file, made by `pliant bake`")->required();
    app.add_option("--screenshot", options.screenshot, "draw one picture into this PNG file")->type_name("OUT.png");
    app.add_option("--sheet", options.sheet, "draw a contact sheet: the poses, and blends of them, linear beside elastic")
        ->type_name("OUT.png");
    app.add_option("--frames", options.benchmark_frames, "measure this many blends, draw nothing")
        ->type_name("N")
        ->check(CLI::Range(1, 10000000));
    app.add_flag("--json", options.json, "with --frames: print JSON");
    app.add_option("--weights", weights, "weights to start with (default: equal)")->type_name("W1,W2,...");
    app.add_flag("--linear", options.linear, "the linear blend instead of the elastic one");
    app.add_flag("--both", options.both, "linear and elastic side by side");
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
    if (!weights.empty()) parse_weights(weights, options);
    if (!size.empty()) parse_size(size, options);
    if (!view.empty()) parse_view(view, options);
    check_combination(options);
    return { options, std::nullopt };
}

std::vector<double> weights_for(const Options& options, const AssetFile& file)
{
    const uint32_t pose_count = file.view().pose_count;
    std::vector<double> weights = options.weights;
    if (weights.empty()) weights.assign(pose_count, 1.0);
    if (weights.size() != pose_count) {
        std::string names;
        for (const std::string& name : file.pose_names()) names += (names.empty() ? "" : ", ") + name;
        throw Error(ErrorNumber::weights, ExitCode::usage,
                    "--weights: " + std::to_string(weights.size()) + " weights for " + std::to_string(pose_count) + " poses",
                    "the poses of " + file.path() + " are: " + names);
    }
    double sum = 0.0;
    for (double weight : weights) sum += weight;
    for (double& weight : weights) weight /= sum;
    return weights;
}

} // namespace pliant::player
