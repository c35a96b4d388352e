#include "cli/verbs.h"

#include "bake/make_energy.h"

#include "bake/warnings.h"
#include "base/common/parallel.h"
#include "base/common/print.h"
#include "cli/idle_options.h"
#include "elastic/average/family.h"
#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "pipeline/json_file.h"

#include <cmath>
#include <fmt/format.h>
#include <memory>

namespace pliant {

namespace {

struct AverageArguments {
    std::vector<std::string> poses;
    std::string weights, path, list, output;
    std::uint32_t grid = 0;
    EnergyOptions energy;
    bool all_vertices = false, is_json = false;
    Talk talk;
};

// An average to compute, and the file for it. frame: its name in messages, empty if there is only one.
struct Wanted {
    Weights weights;
    std::string frame, output;
};

constexpr double grid_limit = 10000; // meshes: days of work, and more than any viewer wants

// Adds all rows of `pose_count` multiples of 1/steps with sum 1 that begin like `row` up to `pose`, the first pose's weight
// falling.
void add_grid_points(Weights& row, Eigen::Index pose, std::uint32_t left, std::uint32_t steps, std::vector<Weights>& points)
{
    if (pose + 1 == row.size()) {
        row[pose] = double(left) / steps;
        points.push_back(row);
        return;
    }
    for (std::uint32_t share = left + 1; share-- > 0;) {
        row[pose] = double(share) / steps;
        add_grid_points(row, pose + 1, left - share, steps, points);
    }
}

Failure too_fine(const std::string& grid, double count)
{
    return Failure(ExitCode::usage,
                   error_at(1221, "",
                            fmt::format("--grid {} has {:.0f} points, the limit is {:.0f}", grid, count, grid_limit),
                            "take a smaller N, or list the weights in a file and give it with --path"));
}

std::vector<Weights> simplex_grid(std::size_t pose_count, std::uint32_t steps)
{
    double count = 1; // (steps + pose_count - 1) over (pose_count - 1)
    for (std::size_t k = 1; k < pose_count; ++k) count = count * double(steps + k) / double(k);
    if (count > grid_limit) throw too_fine(fmt::format("{} of {} poses", steps, pose_count), count);
    std::vector<Weights> points;
    Weights row = Weights::Zero(Eigen::Index(pose_count));
    add_grid_points(row, 0, steps, steps, points);
    return points;
}

// All rows of multiples of 1/steps from 0 to 1, the first layer's weight rising first.
std::vector<Weights> box_grid(std::size_t layer_count, std::uint32_t steps)
{
    const double count = std::pow(steps + 1.0, double(layer_count));
    if (count > grid_limit) throw too_fine(fmt::format("{} of {} layers", steps, layer_count), count);
    std::vector<Weights> points;
    for (std::size_t i = 0; i < std::size_t(count); ++i) {
        Weights row = Weights::Zero(Eigen::Index(layer_count));
        std::size_t rest = i;
        for (double& weight : row) {
            weight = double(rest % (steps + 1)) / steps;
            rest /= steps + 1;
        }
        points.push_back(row);
    }
    return points;
}

std::vector<Weights> grid_points(const AverageArguments& a, std::size_t pose_count)
{
    return a.energy.blend == Blend::layers ? box_grid(pose_count - 1, a.grid) : simplex_grid(pose_count, a.grid);
}

using Names = std::vector<std::string>;

// A wrong number of weights (P1203) is answered with the names of the poses or layers.
Weights checked_weights(const AverageArguments& a, const std::vector<double>& values, const Names& poses)
{
    const bool has_layers = a.energy.blend == Blend::layers;
    try {
        return has_layers ? layer_weights(values, poses.size() - 1) : normalized_weights(values, poses.size());
    } catch (const Failure& failure) {
        Diagnostic diagnostic = failure.diagnostics()[0];
        if (diagnostic.number == 1203)
            diagnostic.hint += fmt::format(": {}", fmt::join(poses.begin() + has_layers, poses.end(), ", "));
        throw Failure(failure.code(), diagnostic);
    }
}

std::vector<Weights> path_points(const AverageArguments& a, const Names& poses)
{
    std::vector<Weights> points;
    read_weight_path(a.path,
                     [&](const std::vector<double>& weights) { points.push_back(checked_weights(a, weights, poses)); });
    return points;
}

std::vector<std::string> all_inputs(const AverageArguments& a)
{
    std::vector<std::string> inputs = input_files(a.poses, a.energy);
    if (!a.path.empty()) inputs.push_back(a.path);
    return inputs;
}

// What can be said before the poses are read.
void check_usage(const AverageArguments& a)
{
    if (int(!a.weights.empty()) + int(!a.path.empty()) + int(a.grid > 0) != 1)
        throw Failure(ExitCode::usage,
                      error_at(1220, "", "give one of --weights, --path and --grid", "see `pliant average --help`"));
    if (!a.list.empty() && a.grid == 0)
        throw Failure(ExitCode::usage,
                      error_at(1224, "", "--list belongs to --grid", "the file of --path lists its weights already"));
    if (!a.weights.empty()) parse_weights(a.weights);
    const std::vector<std::string> inputs = all_inputs(a);
    try_outputs({ a.weights.empty() ? frame_name(a.output, 0) : a.output, a.list }, inputs);
    require_suffix("--output", a.output, ".ply");
    if (!a.weights.empty()) require_no_pattern(a.output, "--path and --grid");
    require_suffix("--list", a.list, ".csv");
}

std::vector<Wanted> wanted_averages(const AverageArguments& a, const Names& poses)
{
    if (!a.weights.empty()) return { { checked_weights(a, parse_weights(a.weights), poses), "", a.output } };
    const std::vector<Weights> points = a.grid > 0 ? grid_points(a, poses.size()) : path_points(a, poses);
    std::vector<Wanted> wanted;
    for (std::size_t i = 0; i < points.size(); ++i)
        wanted.push_back({ points[i], fmt::format("frame {}: ", i), frame_name(a.output, i) });
    return wanted;
}

std::string grid_list(const std::vector<Wanted>& wanted)
{
    std::string text = "# weights of the averages, one line per mesh\n";
    for (const Wanted& one : wanted) {
        for (Eigen::Index k = 0; k < one.weights.size(); ++k) text += fmt::format("{}{}", k > 0 ? "," : "", one.weights[k]);
        text += '\n';
    }
    return text;
}

// Each average comes from the mean, so they may be computed at the same time, and no result depends on the other lines of a
// path.
std::vector<FamilyPoint> compute(const AverageFamily& family, const std::vector<Wanted>& wanted, std::size_t first,
                                 std::size_t count, ConsoleProgress& progress)
{
    if (wanted.size() == 1) return { family.at_or_near_pose(wanted[0].weights, 0, &progress) };
    SharedProgress shared(&progress);
    shared.describe("averages", double(first) / double(wanted.size()),
                    fmt::format("{} of {} written", first, wanted.size()));
    std::vector<FamilyPoint> points(count);
    for_each_task(count, [&](std::size_t i, std::size_t worker) {
        points[i] = family.at_or_near_pose(wanted[first + i].weights, worker, &shared);
    });
    return points;
}

nlohmann::ordered_json to_json(const Wanted& wanted, const FamilyPoint& point)
{
    const NewtonResult& result = point.average;
    return { { "output", wanted.output },
             { "weights", std::vector<double>(wanted.weights.data(), wanted.weights.data() + wanted.weights.size()) },
             { "energy", result.energy },
             { "decrement", result.decrement },
             { "iterations", result.iterations },
             { "jumps", point.jumps.size() } };
}

void print_figures(const AverageArguments& a, const nlohmann::ordered_json& averages, int factorization_count)
{
    if (a.is_json) {
        const nlohmann::ordered_json json = { { "factorizations", factorization_count }, { "averages", averages } };
        print_to(stdout, "{}\n", json_text(json));
    } else if (!a.talk.is_quiet && averages.size() == 1) {
        print_to(stdout, "{}: energy {:.6e}, decrement {:.1e}, {} factorisations\n",
                 printable(averages[0]["output"].get<std::string>()), averages[0]["energy"].get<double>(),
                 averages[0]["decrement"].get<double>(), factorization_count);
    } else if (!a.talk.is_quiet) {
        print_to(stdout, "{} averages, {} factorisations\n", averages.size(), factorization_count);
    }
}

ExitCode run_average(AverageArguments a, const CLI::App& verb)
{
    check_usage(a);
    ConsoleProgress progress("average", a.talk);
    std::vector<Diagnostic> warnings;
    const PoseSet poses = load_with_warnings("average", a.poses, a.energy, &warnings);
    a.energy.blend = poses.blend;
    warn_of_idle_options(verb, a.energy, poses.is_solid(), warnings);
    const std::vector<Wanted> wanted = wanted_averages(a, poses.names); // one glTF file may give many poses
    const std::vector<std::string> inputs = all_inputs(a);
    std::vector<std::string> outputs = { a.list };
    for (const Wanted& one : wanted) outputs.push_back(one.output);
    try_outputs(outputs, inputs);
    const NormalizedPoses set = normalize_poses(poses, a.energy, progress);
    EnergyOptions options = a.energy;
    options.material = material_of(options, poses.is_solid());
    const ElasticModel model = make_model(set, options, &progress);
    SolverPool pool(*model.energy, set, a.energy.solver);
    const NewtonOptions newton = exact_newton(set);
    AverageFamily family(pool, newton, &progress, {}, model.coarse.get());
    family.mean();
    nlohmann::ordered_json averages = nlohmann::ordered_json::array();
    const std::size_t portion = 4 * worker_count(); // in memory together; few, so that files appear as the work goes on
    for (std::size_t first = 0; first < wanted.size(); first += portion) {
        const std::size_t count = std::min(portion, wanted.size() - first);
        const std::vector<FamilyPoint> points = compute(family, wanted, first, count, progress);
        for (std::size_t i = 0; i < count; ++i) {
            const Wanted& one = wanted[first + i];
            const NewtonResult& result = points[i].average;
            if (options.blend == Blend::layers)
                require_layered_shape(result, one.weights, poses.names, one.frame);
            else
                require_convergence(result, newton, one.frame);
            write_output(one.output, encode_ply(to_input_units(set, result.y), poses, a.all_vertices));
            progress.clear_line();
            warn_of_jumps(points[i], poses, *options.material, one.frame, progress);
            averages.push_back(to_json(one, points[i]));
        }
    }
    if (!a.list.empty()) write_output(a.list, grid_list(wanted));
    print_figures(a, averages, pool.factorization_count());
    return ExitCode::done;
}

} // namespace

Verb add_average(CLI::App& app)
{
    auto a = std::make_shared<AverageArguments>();
    CLI::App* verb = app.add_subcommand(
        "average", "Compute unreduced elastic averages, or sums of layers: slow, the reference for blends");
    verb->footer("Examples:\n  pliant average rest.ply run.ply --weights 1,1 -o between.ply\n"
                 "  pliant average rest.ply run.ply --path weights.csv -o truth_%04d.ply\n"
                 "  pliant average rest.ply run.ply --grid 8 --list truth.csv -o truth_%04d.ply\n"
                 "  pliant average face.ply smile.ply blink.ply --blend layers --weights 1.2,1 -o both.ply\n"
                 "`pliant-player --truth` shows meshes of --path and --grid next to its blends.");
    add_pose_arguments(*verb, a->poses);
    verb->add_option("-w,--weights", a->weights,
                     "One weight per pose, separated by commas; with --blend layers one per pose but the first")
        ->type_name("W1,W2,...");
    verb->add_option("--path", a->path, "File with one line of weights per mesh; computes all of them in one run")
        ->type_name("FILE.csv");
    verb->add_option("--grid", a->grid,
                     "Compute the averages at all weights that are multiples of 1/N, corners included; with --blend layers "
                     "each weight from 0 to 1")
        ->type_name("N")
        ->transform(whole_number_in(1, 1000));
    verb->add_option("--list", a->list, "With --grid: also write the weights, one line per mesh")->type_name("FILE.csv");
    verb->add_option("-o,--output", a->output, "Mesh to write; with --path and --grid a pattern such as truth_%04d.ply")
        ->required()
        ->type_name("OUT.ply");
    add_blend_kind(*verb, a->energy);
    add_energy_options(*verb, a->energy);
    add_all_vertices(*verb, a->all_vertices);
    add_threads(*verb);
    add_json(*verb, a->is_json);
    add_talk(*verb, a->talk);
    return [a, verb] { return run_average(*a, *verb); };
}

} // namespace pliant
