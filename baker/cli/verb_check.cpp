#include "cli/verbs.h"

#include "bake/estimate.h"

#include "bake/certificate.h"
#include "bake/make_energy.h"
#include "base/common/print.h"
#include "base/common/shell_word.h"
#include "cli/idle_options.h"
#include "elastic/energy/contradictions.h"
#include "elastic/energy/reinforced_shells.h"
#include "input/gltf/document.h"
#include "input/poses/pose_source.h"
#include "pipeline/batch.h"
#include "pipeline/json_file.h"

#include <algorithm>
#include <filesystem>
#include <fmt/core.h>
#include <memory>
#include <set>

namespace pliant {

namespace {

struct CheckArguments {
    std::vector<std::string> poses;
    BakeOptions bake;
    bool is_json = false;
    Talk talk;
};

// Where a shell bends sharply.
struct Folds {
    std::size_t hinge_count = 0, foldover_count = 0; // with --continuity off
    std::size_t rough_count = 0;                     // vertices, else
};

Folds folds_of(const NormalizedPoses& set, const EnergyOptions& options)
{
    if (material_of(options, set.is_solid()) != Material::discrete_shells) return {};
    if (options.continuity == Continuity::automatic) return { 0, 0, count_rough_vertices(set, options.shell) };
    const DiscreteShells shells(set, options.shell);
    return { shells.hinge_count(), shells.foldover_hinges().size(), 0 };
}

void print_folds(const Folds& folds, std::size_t vertex_count)
{
    if (folds.foldover_count > 0)
        print_to(stdout,
                 "  {} of {} hinges are folded over or fold strongly between poses: their bending energy will be damped\n",
                 folds.foldover_count, folds.hinge_count);
    if (folds.rough_count > 0)
        print_to(stdout, "  {} of {} vertices are rough: they will have ARAP cells\n", folds.rough_count, vertex_count);
}

void print_surface(const PoseSet& poses)
{
    const RenderMesh* const drawn = poses.render_mesh.get();
    print_to(stdout, "{} poses of {} vertices, {} faces, {} triangles: ready to bake\n", poses.pose_count(),
             drawn ? drawn->embedding.count() : poses.vertex_count(), poses.polygons.count(),
             drawn ? drawn->triangles.size() : poses.triangles.size());
    if (drawn)
        print_to(stdout, "  the simulation mesh has {} vertices, {} triangles in {} components\n", poses.vertex_count(),
                 poses.triangles.size(), poses.repairs.component_count);
}

// Pairs that are named; the others are counted.
constexpr std::size_t named_pairs = 10;

std::vector<Contradiction> contradictions_of(const PoseSet& poses, const NormalizedPoses& set)
{
    return poses.blend == Blend::layers ? find_contradictions(set) : std::vector<Contradiction>();
}

void warn_of_contradictions(const std::vector<Contradiction>& pairs, const PoseSet& poses)
{
    for (std::size_t i = 0; i < std::min(pairs.size(), named_pairs); ++i) {
        const Contradiction& pair = pairs[i];
        print_finding("check",
                      warning_at(4412, "",
                                 fmt::format("layers {} and {} contradict each other at full strength: {} edges would fold "
                                             "through, {} faces would be stretched or squeezed more than tenfold, the first "
                                             "at vertex {}",
                                             poses.names[pair.first], poses.names[pair.second], pair.folded_edge_count,
                                             pair.stretched_face_count, poses.file_number(pair.vertex)),
                                 "blend them with weights whose sum is 1 at most, or leave one of them out"));
    }
    if (pairs.size() > named_pairs)
        print_to(stdout, "  {} more pairs of layers contradict each other\n", pairs.size() - named_pairs);
}

void print_names(const PoseSet& poses)
{
    for (std::size_t k = 0; k < poses.pose_count(); ++k)
        print_to(stdout, "  {} {}: {}\n", poses.blend == Blend::layers && k > 0 ? "layer" : "pose", k,
                 printable(poses.names[k]));
}

// The animations of all glTF files that are named without a choice, or of all, each with an argument to copy.
void print_animations(const std::vector<std::string>& arguments, bool is_verbose)
{
    std::set<std::string> files;
    for (const std::string& argument : arguments) {
        const PoseArgument pose = split_pose_argument(argument);
        if (!is_gltf_name(pose.path) || (!pose.choice.empty() && !is_verbose) || !files.insert(pose.path).second) continue;
        for (const AnimationChoice& animation : animation_choices(pose.path))
            print_to(stdout, "  animation {}, {:.3g} s: poses of it as {}\n", printable(animation.name), animation.seconds,
                     printable(shell_word(example_of(pose.path, animation))));
    }
}

// A path that begins with a dash is no option.
std::string path_word(const std::string& path) { return shell_word(path[0] == '-' ? "./" + path : path); }

// The bake of what was checked, with the options that were given.
std::string bake_command(const CheckArguments& a, const CLI::App& verb)
{
    const std::set<std::string> own = { "json", "quiet", "verbose" };
    std::string command = "pliant bake";
    for (const std::string& pose : a.poses) command += " " + path_word(pose);
    for (const CLI::Option* option : verb.get_options()) {
        if (option->count() == 0 || option->get_positional() || own.count(option->get_lnames().at(0)) > 0) continue;
        if (option->get_items_expected_max() == 0 && !option->as<bool>()) continue; // --no-align=false
        command += " --" + option->get_lnames()[0];
        if (option->get_items_expected_max() > 0)
            for (const std::string& value : option->results()) command += " " + shell_word(value);
    }
    const std::filesystem::path first = split_pose_argument(a.poses[0]).path;
    return command + " -o " + path_word(first.stem().string() + ".pliant");
}

ExitCode run_check(CheckArguments a, const CLI::App& verb)
{
    std::vector<Diagnostic> warnings;
    const PoseSet poses = load_with_warnings("check", a.poses, a.bake.energy, &warnings);
    a.bake.energy.blend = poses.blend;
    warn_of_idle_options(verb, a.bake.energy, poses.is_solid(), warnings);
    if (a.is_json) {
        print_to(stdout, "{}\n", json_text(describe_poses(poses, a.bake)));
        return ExitCode::done;
    }
    const NormalizedPoses set = normalize(poses, a.bake.energy.keep_placement);
    if (a.talk.is_quiet) {
        warn_of_contradictions(contradictions_of(poses, set), poses);
        return ExitCode::done;
    }
    const Material material = material_of(a.bake.energy, poses.is_solid());
    if (poses.is_solid())
        print_to(stdout, "{} poses of {} vertices, {} tetrahedra, {} of the vertices on the boundary: ready to bake\n",
                 poses.pose_count(), poses.vertex_count(), poses.tets.size(), poses.boundary_vertex_count);
    else
        print_surface(poses);
    if (poses.blend == Blend::layers)
        print_to(stdout, "  {} is the rest shape, the others are layers on it (--blend average: poses of equal rank)\n",
                 printable(poses.names[0]));
    for (std::size_t k = 1; k < poses.pose_count() && poses.blend == Blend::average; ++k)
        if (turned_degrees(set, k) >= 0.1)
            print_to(stdout, "  {}: rotated by {:.1f} degrees to align it with {}\n", printable(poses.names[k]),
                     turned_degrees(set, k), printable(poses.names[0]));
    print_folds(folds_of(set, a.bake.energy), poses.vertex_count());
    warn_of_contradictions(contradictions_of(poses, set), poses);
    const BakeEstimate e = estimate_bake(poses, a.bake);
    print_to(stdout, "estimate of a bake ({}): d = {}, {}, {} of memory, an asset of {}\n", name_of(material), e.dimension,
             e.seconds < 1 ? "under a second" : duration_text(e.seconds), size_text(e.memory), size_text(e.asset_size));
    if (!poses.is_solid())
        print_to(stdout, "  at most {} factorisations\n", factorization_limit(poses.pose_count(), a.bake));
    if (a.talk.is_verbose) print_names(poses);
    print_animations(a.poses, a.talk.is_verbose);
    print_to(stdout, "to bake: {}\n", bake_command(a, verb));
    return ExitCode::done;
}

} // namespace

nlohmann::ordered_json describe_poses(const PoseSet& poses, const BakeOptions& options)
{
    const NormalizedPoses set = normalize(poses, options.energy.keep_placement);
    const Material material = material_of(options.energy, poses.is_solid());
    const Folds folds = folds_of(set, options.energy);
    const BakeEstimate e = estimate_bake(poses, options);
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (std::size_t k = 0; k < poses.pose_count(); ++k)
        list.push_back({ { "name", poses.names[k] }, { "turned_degrees", turned_degrees(set, k) } });
    const RenderMesh* const drawn = poses.render_mesh.get();
    nlohmann::ordered_json json = { { "poses", list },
                                    { "blend", name_of(poses.blend) },
                                    { "kind", poses.is_solid() ? "solid" : "surface" },
                                    { "material", name_of(material) },
                                    { "vertices", drawn ? drawn->embedding.count() : poses.vertex_count() },
                                    { "triangles", drawn ? drawn->triangles.size() : poses.triangles.size() },
                                    { "tetrahedra", poses.tets.size() },
                                    { "elastic_vertices", poses.vertex_count() },
                                    { "foldover_hinges", folds.foldover_count },
                                    { "rough_vertices", folds.rough_count } };
    nlohmann::ordered_json pairs = nlohmann::ordered_json::array();
    for (const Contradiction& pair : contradictions_of(poses, set))
        pairs.push_back({ { "layers", { poses.names[pair.first], poses.names[pair.second] } },
                          { "folded_edges", pair.folded_edge_count },
                          { "stretched_faces", pair.stretched_face_count },
                          { "vertex", poses.file_number(pair.vertex) } });
    if (poses.blend == Blend::layers) json["contradictions"] = pairs;
    json["estimate"]
        = { { "dimension", e.dimension }, { "seconds", e.seconds }, { "memory", e.memory }, { "asset_size", e.asset_size } };
    return json;
}

Verb add_check(CLI::App& app)
{
    auto a = std::make_shared<CheckArguments>();
    CLI::App* verb = app.add_subcommand("check", "Check poses and estimate the cost of a bake; writes nothing");
    verb->footer("Example:\n  pliant check rest.ply run.ply jump.ply\nReports the problems of all files in one run.");
    add_pose_arguments(*verb, a->poses);
    add_blend_kind(*verb, a->bake.energy);
    add_energy_options(*verb, a->bake.energy);
    verb->add_option("--dim", a->bake.dimension, "Dimension of the reduced space, as for bake")
        ->transform(whole_number_in(1, 256));
    add_json(*verb, a->is_json);
    add_talk(*verb, a->talk);
    return [a, verb] { return run_check(*a, *verb); };
}

} // namespace pliant
