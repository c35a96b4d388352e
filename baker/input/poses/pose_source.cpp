#include "input/poses/pose_source.h"

#include "base/common/nearest_word.h"
#include "base/common/shell_word.h"
#include "input/gltf/animation.h"
#include "input/gltf/evaluate.h"
#include "input/gltf/read_render_scene.h"
#include "input/io/read_mesh.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <new>
#include <optional>

namespace pliant {
namespace {

// A glTF file that arguments name, opened once.
struct GltfFile {
    explicit GltfFile(GltfScene&& read)
        : scene(std::move(read))
        , numbers(*scene.document, 64000000, 128)
    {
    }

    // P2333 if all poses together are too large.
    void take(std::size_t pose_count)
    {
        std::uint64_t size = scene.vertex_count();
        for (const GltfInstance& instance : scene.instances)
            for (const GltfPrimitive& primitive : scene.meshes[instance.mesh].primitives) size += primitive.triangles.size();
        numbers.take(scene.document->root(), pose_count * size, 3);
    }

    GltfScene scene;
    GltfAllowance numbers;                    // that all poses read and draw
    std::shared_ptr<const RenderScene> drawn; // made with the first pose
};

// One pose that a glTF file is to give.
struct Plan {
    enum class Kind { rest, target, animation };
    Kind kind = Kind::rest;
    std::string target;
    std::size_t animation = 0;
    double seconds = 0;
    std::string name;   // for people
    std::string choice; // an argument that gives this pose alone
};

[[noreturn]] void usage(Diagnostic diagnostic) { throw Failure(ExitCode::usage, std::move(diagnostic)); }

std::string list_of(const std::vector<std::string>& names)
{
    constexpr std::size_t shown = 40;
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < shown; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : ", ", names[i].empty() ? fmt::format("(number {})", i) : names[i]);
    if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
    return text;
}

// For a name that there is not: the nearest one, or all. Many exporters write animations as "Rig|Walk".
std::string hint_of_choice(const std::string& wanted, const std::vector<std::string>& names)
{
    const auto ends_with_it = [&](const std::string& name) {
        return !wanted.empty() && name.size() > wanted.size()
            && name.compare(name.size() - wanted.size(), std::string::npos, wanted) == 0;
    };
    const auto found = std::find_if(names.begin(), names.end(), ends_with_it);
    const std::string nearest = found == names.end() ? nearest_word(wanted, names) : *found;
    return nearest.empty() ? "it has " + list_of(names) : fmt::format("did you mean '{}'?", nearest);
}

std::vector<std::string> split(const std::string& text, char separator)
{
    std::vector<std::string> parts;
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t end = std::min(text.find(separator, start), text.size());
        parts.push_back(text.substr(start, end - start));
        start = end + 1;
    }
    return parts;
}

Plan target_plan(const std::string& name) { return { Plan::Kind::target, name, 0, 0, name, "target=" + name }; }

Plan rest_plan(const std::string& path)
{
    return { Plan::Kind::rest, "", 0, 0, std::filesystem::path(path).stem().string(), "rest" };
}

std::vector<Plan> plan_targets(const GltfScene& scene, const std::string& wanted)
{
    const std::vector<std::string>& known = scene.target_names;
    const auto is_known
        = [&](const std::string& name) { return std::find(known.begin(), known.end(), name) != known.end(); };
    std::vector<Plan> plans;
    if (is_known(wanted)) return { target_plan(wanted) }; // a name may have a comma in it
    for (const std::string& name : split(wanted, ',')) {
        if (!is_known(name))
            usage(error_at(1212, scene.document->path(), fmt::format("there is no morph target '{}'", name),
                           known.empty() ? "the file has no morph targets" : hint_of_choice(name, known)));
        plans.push_back(target_plan(name));
    }
    return plans;
}

std::size_t find_animation(const GltfDocument& document, const std::string& wanted)
{
    const std::vector<std::string> names = animation_names(document);
    const auto named = std::find(names.begin(), names.end(), wanted);
    if (named != names.end() && !wanted.empty()) return static_cast<std::size_t>(named - names.begin());
    std::size_t number = 0;
    const auto [rest, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (error == std::errc() && rest == wanted.data() + wanted.size() && number < names.size()) return number;
    usage(error_at(1213, document.path(), fmt::format("there is no animation '{}'", wanted),
                   names.empty() ? "the file has no animations" : hint_of_choice(wanted, names)));
}

double parse_seconds(const std::string& path, const std::string& word)
{
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size() || !std::isfinite(value) || value < 0)
        usage(error_at(1211, path, fmt::format("'{}' is not a time in seconds", word),
                       "write #animation=NAME@0,0.3,0.6 with decimal points"));
    return value;
}

std::vector<Plan> plan_animation(GltfFile& file, const std::string& wanted, DiagnosticList& diagnostics)
{
    const GltfDocument& document = *file.scene.document;
    const std::size_t at = wanted.rfind('@'); // names may have one, times do not
    if (at == std::string::npos)
        usage(error_at(1211, document.path(), fmt::format("#animation={} names no time", wanted),
                       "write #animation=NAME@0,0.3,0.6 with the times of the poses in seconds"));
    const std::string name = wanted.substr(0, at);
    const std::size_t animation = find_animation(document, name);
    const double end = animation_end(document, animation, file.numbers);
    std::vector<Plan> plans;
    for (const std::string& word : split(wanted.substr(at + 1), ',')) {
        const double seconds = parse_seconds(document.path(), word);
        if (seconds > end + time_slack(end))
            diagnostics.add(
                warning_at(2322, document.path(),
                           fmt::format("{} s is after the end of animation {} ({:.6g} s): its end is used", word, name, end),
                           fmt::format("use times from 0 to {:.6g}", end)));
        plans.push_back(
            { Plan::Kind::animation, "", animation, seconds, name + "@" + word, "animation=" + name + "@" + word });
    }
    return plans;
}

std::vector<Plan> plan_poses(GltfFile& file, const PoseArgument& argument, DiagnosticList& diagnostics)
{
    const GltfScene& scene = file.scene;
    const std::string& choice = argument.choice;
    if (choice.empty()) {
        std::vector<Plan> plans = { rest_plan(argument.path) };
        for (const std::string& target : scene.target_names) plans.push_back(target_plan(target));
        return plans;
    }
    if (choice == "rest") return { rest_plan(argument.path) };
    if (choice.compare(0, 7, "target=") == 0) return plan_targets(scene, choice.substr(7));
    if (choice.compare(0, 10, "animation=") == 0) return plan_animation(file, choice.substr(10), diagnostics);
    usage(error_at(1211, argument.path, fmt::format("'#{}' is not understood", choice),
                   "write #rest, #target=NAME,NAME or #animation=NAME@SECONDS,SECONDS"));
}

GltfState state_of(GltfFile& file, const Plan& plan)
{
    const GltfScene& scene = file.scene;
    if (plan.kind == Plan::Kind::animation) return animated_state(scene, plan.animation, plan.seconds, file.numbers);
    std::vector<std::vector<double>> weights; // of each mesh
    for (const GltfMesh& mesh : scene.meshes) {
        weights.emplace_back();
        for (const std::string& name : mesh.target_names)
            weights.back().push_back(plan.kind == Plan::Kind::target && name == plan.target);
    }
    GltfState state = scene.rest;
    for (const GltfInstance& instance : scene.instances) state.weights[instance.node] = weights[instance.mesh];
    return state;
}

// What the file draws a target with: by the first mesh that has it.
double initial_weight_of(const GltfScene& scene, const std::string& target)
{
    std::vector<bool> is_done(scene.meshes.size(), false);
    for (const GltfInstance& instance : scene.instances) {
        if (is_done[instance.mesh]) continue;
        is_done[instance.mesh] = true;
        const std::vector<std::string>& names = scene.meshes[instance.mesh].target_names;
        const auto found = std::find(names.begin(), names.end(), target);
        if (found != names.end()) return scene.rest.weights[instance.node][static_cast<std::size_t>(found - names.begin())];
    }
    return 0;
}

MeshFile make_pose(GltfFile& file, const Plan& plan, DiagnosticList& diagnostics)
{
    const GltfScene& scene = file.scene;
    MeshFile mesh;
    mesh.path = scene.document->path() + "#" + plan.choice;
    mesh.name = plan.name;
    if (plan.kind == Plan::Kind::target) mesh.initial_weight = initial_weight_of(scene, plan.target);
    const GltfState state = state_of(file, plan);
    Positions normals;
    mesh.positions = evaluate(scene, state, file.numbers, file.drawn ? nullptr : &normals);
    if (!file.drawn) {
        std::vector<Diagnostic> warnings;
        file.drawn = std::make_shared<const RenderScene>(render_scene(scene, normals, warnings));
        for (Diagnostic& warning : warnings) diagnostics.add(std::move(warning));
    }
    mesh.scene = file.drawn;
    mesh.position_steps = position_steps(scene, state, file.numbers);
    const SourceFile source { mesh.path, "", &diagnostics };
    for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v)
        for (int c = 0; c < 3; ++c)
            if (!check_coordinate(source, 0, static_cast<std::size_t>(v), mesh.positions(v, c))) break;
    for (const Triangle& t : triangles_of(scene)) {
        mesh.faces.indices.insert(mesh.faces.indices.end(), t.begin(), t.end());
        mesh.faces.offsets.push_back(static_cast<std::uint32_t>(mesh.faces.indices.size()));
    }
    return mesh;
}

// What an argument gives: a mesh file as it is, or poses of a glTF file; neither if it could not be opened.
struct Source {
    PoseArgument argument;
    GltfFile* file = nullptr;
    std::vector<Plan> plans;
    bool is_gltf = false;
};

// "run.ply#rest" is not a file that somebody has, but a choice where there is none.
void check_plain(const std::string& path)
{
    const std::string suffix = std::filesystem::path(path).extension().string();
    const std::size_t hash = suffix.find('#');
    std::error_code ignored;
    if (hash == std::string::npos || std::filesystem::exists(path, ignored)) return;
    usage(error_at(1211, path, fmt::format("'{}': only glTF files take a choice behind '#'", suffix.substr(hash)),
                   "leave it out: other files hold one pose"));
}

class Reader {
public:
    explicit Reader(DiagnosticList& diagnostics)
        : diagnostics_(diagnostics)
    {
    }

    Source plan(const std::string& text)
    {
        Source source { split_pose_argument(text), nullptr, {}, false };
        source.is_gltf = is_gltf_name(source.argument.path);
        if (!source.is_gltf) {
            check_plain(source.argument.path);
            return source;
        }
        source.file = open(source.argument.path);
        if (source.file)
            guard(source.argument.path, [&] {
                std::vector<Plan> plans = plan_poses(*source.file, source.argument, diagnostics_);
                source.file->take(plans.size());
                source.plans = std::move(plans);
            });
        return source;
    }

    void read(const Source& source, std::vector<MeshFile>& meshes)
    {
        if (!source.is_gltf) {
            if (std::optional<MeshFile> mesh = read_mesh(source.argument.path, diagnostics_))
                meshes.push_back(std::move(*mesh));
            return;
        }
        for (const Plan& plan : source.plans) {
            const std::size_t errors = diagnostics_.error_count();
            guard(source.argument.path, [&] {
                MeshFile mesh = make_pose(*source.file, plan, diagnostics_);
                if (diagnostics_.error_count() == errors) meshes.push_back(std::move(mesh));
            });
        }
    }

private:
    // Null if the file is no good; it is told about once.
    GltfFile* open(const std::string& path)
    {
        const std::string place = named_place(path).string(); // ./a.glb is a.glb
        const auto known = files_.find(place);
        if (known != files_.end()) return known->second.get();
        std::unique_ptr<GltfFile>& file = files_[place];
        guard(path, [&] {
            std::vector<Diagnostic> warnings;
            file = std::make_unique<GltfFile>(read_scene(std::make_shared<const GltfDocument>(path), warnings));
            for (Diagnostic& warning : warnings) diagnostics_.add(std::move(warning));
        });
        return file.get();
    }

    // Wrong files become diagnostics; a wrong command line stays one.
    template <class Action> void guard(const std::string& path, Action action)
    {
        try {
            action();
        } catch (const Failure& failure) {
            if (failure.code() != ExitCode::bad_input) throw;
            for (const Diagnostic& diagnostic : failure.diagnostics()) diagnostics_.add(diagnostic);
        } catch (const std::bad_alloc&) {
            diagnostics_.add(
                error_at(2008, path, "does not fit into memory", "use a machine with more memory or a coarser mesh"));
        }
    }

    DiagnosticList& diagnostics_;
    std::map<std::string, std::unique_ptr<GltfFile>> files_;
};

std::vector<AnimationChoice> choices_of(const GltfDocument& document)
{
    std::vector<AnimationChoice> choices;
    GltfAllowance allowance(document);
    for (const std::string& name : animation_names(document))
        choices.push_back(
            { name.empty() ? std::to_string(choices.size()) : name, animation_end(document, choices.size(), allowance) });
    return choices;
}

std::string hint_of_lone(const Source& source)
{
    const std::string hint = "name all poses of the character, the rest pose first";
    if (!source.file) return hint;
    if (source.argument.choice.rfind("target=", 0) == 0)
        return fmt::format("add the rest shape: {} {}", shell_word(source.argument.path + "#rest"),
                           shell_word(source.argument.path + "#" + source.argument.choice));
    const std::vector<AnimationChoice> choices = choices_of(*source.file->scene.document);
    if (choices.empty()) return hint + "; the file has neither morph targets nor animations";
    std::vector<std::string> names;
    for (const AnimationChoice& choice : choices) names.push_back(choice.name);
    return fmt::format("take poses of an animation: {}; it has {}", shell_word(example_of(source.argument.path, choices[0])),
                       list_of(names));
}

// What is wrong with the only file is said first: it is read for that.
void check_lone_pose(const std::vector<Source>& sources, Reader& reader, const DiagnosticList& diagnostics)
{
    std::vector<MeshFile> meshes;
    if (!sources.empty()) reader.read(sources[0], meshes);
    if (diagnostics.has_errors()) return;
    throw Failure(
        ExitCode::bad_input,
        error_at(3001, sources.empty() ? "" : sources[0].argument.path,
                 fmt::format("{} pose given, two or more are needed", sources.size()),
                 sources.empty() ? "name all poses of the character, the rest pose first" : hint_of_lone(sources[0])));
}

void check_pose_limit(const std::vector<Source>& sources, std::size_t count, std::size_t limit)
{
    if (count <= limit) return;
    std::string hint = "choose the poses that differ most";
    for (const Source& source : sources)
        if (source.plans.size() > 2 && source.argument.choice.empty()) {
            hint = fmt::format("choose morph targets, as in {} {}; it has {}", shell_word(source.argument.path + "#rest"),
                               shell_word(fmt::format("{}#target={},{}", source.argument.path, source.plans[1].target,
                                                      source.plans[2].target)),
                               list_of(source.file->scene.target_names));
            break;
        }
    throw Failure(ExitCode::bad_input,
                  error_at(3002, "", fmt::format("{} poses given, the limit is {}", count, limit), hint));
}

} // namespace

std::vector<AnimationChoice> animation_choices(const std::string& path) { return choices_of(GltfDocument(path)); }

std::string example_of(const std::string& path, const AnimationChoice& animation)
{
    const double end = animation.seconds;
    return fmt::format("{}#animation={}@0,{:.3g},{:.3g}", path, animation.name, end / 3, 2 * end / 3);
}

PoseArgument split_pose_argument(const std::string& argument)
{
    for (std::size_t hash = argument.find('#'); hash != std::string::npos; hash = argument.find('#', hash + 1))
        if (is_gltf_name(std::string_view(argument).substr(0, hash)))
            return { argument.substr(0, hash), argument.substr(hash + 1) };
    return { argument, "" };
}

PoseSources read_pose_sources(const std::vector<std::string>& arguments, std::optional<Blend> blend,
                              DiagnosticList& diagnostics)
{
    Reader reader(diagnostics);
    std::vector<Source> sources;
    PoseSources out;
    for (const std::string& argument : arguments) {
        sources.push_back(reader.plan(argument));
        out.count += sources.back().is_gltf && sources.back().file ? sources.back().plans.size() : 1;
    }
    const bool has_targets = sources.size() == 1 && sources[0].plans.size() > 1 && sources[0].argument.choice.empty();
    out.blend = blend.value_or(has_targets ? Blend::layers : Blend::average);
    if (out.count < 2) check_lone_pose(sources, reader, diagnostics);
    if (diagnostics.has_errors() && out.count < 2) return out;
    out.share_frame = std::all_of(sources.begin(), sources.end(),
                                  [&](const Source& source) { return source.file && source.file == sources[0].file; });
    check_pose_limit(sources, out.count, pose_limit(out.blend));
    for (const Source& source : sources) {
        reader.read(source, out.meshes);
        if (&source == &sources.front()) out.has_first = !out.meshes.empty();
    }
    return out;
}

} // namespace pliant
