#include "cli/verbs.h"

#include "bake/certificate.h"
#include "base/common/parallel.h"
#include "input/gltf/document.h"
#include "input/io/source_file.h"
#include "input/poses/load_poses.h"
#include "input/poses/load_render_mesh.h"
#include "input/poses/pose_source.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/core.h>
#include <utility>

namespace pliant {

namespace {

// An option that takes one of the names of an enumeration, shown in --help with its default.
template <class Enum>
void add_choice(CLI::App& verb, const std::string& option, Enum& value, std::vector<Enum> values, const std::string& help)
{
    std::vector<std::string> names;
    for (Enum v : values) names.push_back(name_of(v));
    verb.add_option_function<std::string>(
            option,
            [&value, values](const std::string& name) {
                for (Enum v : values)
                    if (name == name_of(v)) value = v;
            },
            help)
        ->transform(CLI::IsMember(names, CLI::ignore_case))
        ->default_str(name_of(value))
        ->type_name("NAME");
}

// Has no default of its own: surfaces and solids have different ones.
void add_material(CLI::App& verb, EnergyOptions& options)
{
    const std::vector<Material> values
        = { Material::discrete_shells, Material::arap, Material::stvk, Material::mooney_rivlin };
    std::vector<std::string> names;
    for (Material v : values) names.push_back(name_of(v));
    verb.add_option_function<std::string>(
            "--material",
            [&options, values](const std::string& name) {
                for (Material v : values)
                    if (name == name_of(v)) options.material = v;
            },
            "Elastic energy. For surfaces: discrete-shells (thin shell; the default) or arap (as rigid as possible). For "
            "solids: stvk (St. Venant-Kirchhoff; the default) or mooney-rivlin (preserves volume better, never inverts "
            "tetrahedra)")
        ->transform(CLI::IsMember(names, CLI::ignore_case))
        ->type_name("NAME");
    verb.add_option(
            "--poisson", options.poisson,
            "Poisson's ratio of a solid (default: 0.4 for stvk, 0.45 for mooney-rivlin; above 0.45 tetrahedra lock). "
            "The materials of a .veg file take precedence")
        ->check(number_in(poisson_range.least, poisson_range.most));
}

void add_shell_options(CLI::App& verb, EnergyOptions& options)
{
    add_choice(verb, "--membrane", options.shell.membrane, { Membrane::neo_hookean, Membrane::stvk, Membrane::edge },
               "How thin shells resist stretching; neo-hookean cannot collapse a triangle");
    verb.add_option("--thickness", options.shell.thickness,
                    "Thickness of thin shells relative to the square root of the surface area; a thicker shell bends less "
                    "sharply")
        ->capture_default_str()
        ->check(number_in(thickness_range.least, thickness_range.most));
    verb.add_option("--foldover-damping", options.shell.foldover_damping,
                    "Factor on the bending energy of hinges that are folded over in some pose; 1 = off. Applies with "
                    "--continuity off")
        ->capture_default_str()
        ->check(number_in(foldover_damping_range.least, foldover_damping_range.most));
}

// The files that a glTF file refers to are inputs, too. One that cannot be read is reported where it is loaded.
void add_named_files(const std::string& path, std::vector<std::string>& files)
{
    if (!is_gltf_name(path)) return;
    try {
        for (std::string& file : GltfDocument(path).named_files()) files.push_back(std::move(file));
    } catch (const Failure&) {
        return;
    }
}

} // namespace

CLI::Option* add_pose_arguments(CLI::App& verb, std::vector<std::string>& poses)
{
    return verb
        .add_option(
            "poses", poses,
            "Poses, the rest pose first: one mesh with different positions. Surfaces: .obj .ply .off .glb .gltf; solids of "
            "tetrahedra: .msh (Gmsh) .mesh (MEDIT) .veg (Vega) .vtk. A glTF file gives its rest shape and one "
            "pose for each morph target at weight 1. FILE.glb#rest gives the rest shape only, "
            "FILE.glb#target=NAME,NAME only these targets, FILE.glb#animation=NAME@0,0.3,0.6 an animation (by "
            "name, or by number from 0) at these times in seconds; neither of the two holds the rest shape")
        ->required()
        ->type_name("POSE")
        ->expected(1, -1);
}

void add_energy_options(CLI::App& verb, EnergyOptions& options)
{
    add_material(verb, options);
    add_choice(verb, "--continuity", options.continuity, { Continuity::automatic, Continuity::off },
               "Energy of thin shells at folds and sharp creases. auto: as-rigid-as-possible cells, whose averages seldom "
               "jump from fold to fold; off: hinges and membranes as elsewhere");
    add_shell_options(verb, options);
    std::vector<SolverKind> solvers = { SolverKind::eigen };
    if (has_cholmod()) solvers.insert(solvers.begin(), SolverKind::cholmod);
    add_choice(verb, "--solver", options.solver, solvers,
               "Sparse factorisation: cholmod (fast) or eigen (portable, bit-stable)");
    verb.add_flag("--no-align", options.keep_placement,
                  "Keep the poses where they are instead of aligning them rigidly with the first; those of one glTF file "
                  "stay where it puts them unless they turn too far (P4413)");
    verb.add_option(
            "--weld", options.weld_tolerance,
            "Weld surface vertices that are closer than this in all poses, as a fraction of the bounding-box diagonal, so "
            "that seams in a file are not cuts; 0 welds none")
        ->check(number_in(weld_range.least, weld_range.most))
        ->capture_default_str();
    verb.add_option(
            "--fix", options.fixed_path,
            "Text file of fixed vertices: one vertex number per line, counted from 0 in the order of the pose files. "
            "Implies --no-align")
        ->type_name("FILE")
        ->each([&options](const std::string&) { options.keep_placement = true; });
}

CLI::Validator number_in(double least, double most)
{
    const CLI::Range range(least, most);
    const auto check = [=](std::string& text) {
        double number = 0;
        const bool is_nan = CLI::detail::lexical_cast(text, number) && std::isnan(number);
        return is_nan ? fmt::format("Value {} not in range {} to {}", text, least, most) : range(text);
    };
    return CLI::Validator(check, range.get_description(), range.get_name());
}

CLI::Validator whole_number_in(std::uint64_t least, std::uint64_t most)
{
    const CLI::Range range(least, most); // only for its texts
    const auto check = [=](std::string& text) {
        std::uint64_t number = 0;
        const char* const end = text.data() + text.size();
        const auto [rest, error] = std::from_chars(text.data(), end, number);
        if (rest != end || error != std::errc() || number < least || number > most)
            return fmt::format("Value {} not in range {} to {}", text, least, most);
        text = std::to_string(number);
        return std::string();
    };
    return CLI::Validator(check, range.get_description(), range.get_name());
}

void add_blend_kind(CLI::App& verb, EnergyOptions& options)
{
    verb.add_option_function<std::string>(
            "--blend",
            [&options](const std::string& name) { options.blend = name == "layers" ? Blend::layers : Blend::average; },
            "average: a shape between all poses, a weight per pose. layers: the first pose is the rest shape, each other "
            "pose a layer on it with a weight of its own, as of morph targets: 0 without, 1 with the layer; layers add "
            "up, negative weights are the opposite, weights above 1 exaggerate. Default: layers for one glTF file with "
            "morph targets, named without '#'; else average")
        ->transform(CLI::IsMember({ "average", "layers" }, CLI::ignore_case))
        ->type_name("NAME");
}

void add_threads(CLI::App& verb)
{
    verb.add_option_function<unsigned>("--threads", set_thread_count,
                                       "Number of threads (default: all cores); results do not depend on it")
        ->transform(whole_number_in(1, 256));
}

void add_all_vertices(CLI::App& verb, bool& all_vertices)
{
    verb.add_flag("--all", all_vertices,
                  "Write all vertices of a solid, in the order of the pose files, instead of its boundary only");
}

void add_surface(CLI::App& verb, std::string& path)
{
    verb.add_option("--surface", path,
                    "Render mesh of a solid instead of its own boundary; it follows the tetrahedra. An .obj, .ply or .off "
                    "file of any topology, at the place of the first pose and in its units")
        ->type_name("FILE");
}

void add_talk(CLI::App& verb, Talk& talk)
{
    CLI::Option* quiet = verb.add_flag("-q,--quiet", talk.is_quiet, "Print warnings and errors only");
    verb.add_flag("-v,--verbose", talk.is_verbose, "Print more: every stage with the seconds so far, and all that is known")
        ->excludes(quiet);
}

void add_json(CLI::App& verb, bool& is_json)
{
    verb.add_flag("--json", is_json, "Print the results as JSON to standard output; on failure nothing is printed there");
}

namespace {

// Seams of texture coordinates are in every glTF file: welding them is worth a line of `check` and of a report, no warning.
bool is_normal(const Diagnostic& warning)
{
    return warning.number == 2220 && is_gltf_name(split_pose_argument(warning.where).path);
}

void report_warnings(const std::string& verb, const std::vector<Diagnostic>& warnings, std::vector<Diagnostic>* kept)
{
    for (const Diagnostic& warning : warnings)
        if (verb == "check" || !is_normal(warning)) print_finding(verb, warning);
    if (kept) kept->insert(kept->end(), warnings.begin(), warnings.end());
}

} // namespace

PoseSet load_with_warnings(const std::string& verb, const std::vector<std::string>& paths, const EnergyOptions& options,
                           std::vector<Diagnostic>* kept)
{
    LoadOptions load;
    load.blend = options.blend;
    load.align = !options.keep_placement;
    load.fixed_path = options.fixed_path;
    load.fixed_vertices = options.fixed_vertices;
    load.weld_tolerance = options.weld_tolerance;
    std::vector<Diagnostic> warnings;
    PoseSet poses = load_poses(paths, load, &warnings);
    report_warnings(verb, warnings, kept);
    return poses;
}

RenderMesh load_surface_with_warnings(const std::string& verb, const std::string& path, const PoseSet& poses,
                                      std::vector<Diagnostic>* kept)
{
    std::vector<Diagnostic> warnings;
    RenderMesh surface = load_render_mesh(path, poses, &warnings);
    report_warnings(verb, warnings, kept);
    return surface;
}

std::vector<std::string> input_files(const std::vector<std::string>& poses, const EnergyOptions& options)
{
    std::vector<std::string> files;
    for (const std::string& pose : poses) {
        const std::string path = split_pose_argument(pose).path;
        if (std::find(files.begin(), files.end(), path) != files.end()) continue; // another pose of the same file
        files.push_back(path);
        add_named_files(path, files);
    }
    if (!options.fixed_path.empty()) files.push_back(options.fixed_path);
    return files;
}

double parse_weight(std::string word)
{
    word.erase(0, word.find_first_not_of(" \t"));
    word.erase(word.find_last_not_of(" \t\r") + 1);
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size())
        throw Failure(ExitCode::usage,
                      error_at(1201, "", fmt::format("weight {} is not a number", excerpt(word)),
                               word.find('=') == std::string::npos
                                   ? "write weights as 0.5,0.25,0.25 with a decimal point"
                                   : "`pliant blend` takes weights by name, one each: --set " + word));
    return value;
}

std::vector<double> parse_weights(const std::string& text)
{
    std::vector<double> values;
    std::size_t start = 0;
    while (start <= text.size()) {
        const std::size_t end = std::min(text.find(',', start), text.size());
        values.push_back(parse_weight(text.substr(start, end - start)));
        start = end + 1;
    }
    return values;
}

namespace {

constexpr const char* path_hint
    = "one line per frame, one weight per pose (or layer), separated by commas; # starts a comment";

void use_line(const std::string& line, const std::string& where, const std::function<void(const std::vector<double>&)>& use)
{
    std::vector<double> weights;
    try {
        weights = parse_weights(line);
    } catch (const Failure& failure) {
        const char* semicolons = line.find(';') == std::string::npos ? "" : "write commas in place of semicolons: ";
        throw Failure(ExitCode::bad_input,
                      error_at(2601, where, failure.diagnostics()[0].what, fmt::format("{}{}", semicolons, path_hint)));
    }
    try {
        use(weights);
    } catch (const Failure& failure) {
        throw Failure(ExitCode::bad_input, error_at(1222, where, failure.diagnostics()[0].what, path_hint));
    }
}

} // namespace

void read_weight_path(const std::string& path, const std::function<void(const std::vector<double>&)>& use)
{
    DiagnosticList diagnostics;
    const auto text = read_bytes(path, diagnostics);
    if (!text) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    const std::size_t start = text->rfind("\xef\xbb\xbf", 0) == 0 ? 3 : 0; // spreadsheets begin with a byte order mark
    bool is_empty = true;
    for (LineReader lines(std::string_view(*text).substr(start)); lines.next();) {
        std::string_view rest = lines.line();
        if (next_word(rest, '#').empty()) continue;
        use_line(std::string(lines.line()), fmt::format("{}:{}", path, lines.number()), use);
        is_empty = false;
    }
    if (is_empty)
        throw Failure(ExitCode::bad_input, error_at(1223, path, "holds no weights", "write one line of weights per frame"));
}

void require_suffix(const std::string& option, const std::string& path, const std::string& suffix)
{
    if (path == "-")
        throw Failure(ExitCode::usage,
                      error_at(1230, "", fmt::format("{}: '-' is no file: standard output is for figures", option),
                               "outputs are files, as they appear whole or not at all: name one that ends in " + suffix));
    std::filesystem::path name = path;
    const std::string found = name.extension().string();
    if (found.empty() || CLI::detail::to_lower(found) == suffix) return;
    throw Failure(
        ExitCode::usage,
        error_at(1230, "", fmt::format("{}: '{}' does not end in {}", option, path, suffix),
                 fmt::format("the file is written in that format: name it {}", name.replace_extension(suffix).string())));
}

namespace {

// The "%04d" of a pattern.
struct Conversion {
    std::size_t start = std::string::npos, end = std::string::npos; // npos: there is none, or more than one
};

Conversion find_conversion(const std::string& pattern)
{
    const std::size_t percent = pattern.find('%');
    if (percent == std::string::npos) return {};
    const std::size_t end = pattern.find_first_not_of("0123456789", percent + 1);
    if (end == std::string::npos || pattern[end] != 'd' || pattern.find('%', end) != std::string::npos) return {};
    return { percent, end };
}

} // namespace

void require_no_pattern(const std::string& path, const std::string& owner)
{
    if (find_conversion(path).end == std::string::npos) return;
    throw Failure(ExitCode::usage,
                  error_at(1237, "", fmt::format("'{}' is a pattern, but one mesh is written", path),
                           "a pattern belongs to " + owner + ": name one file"));
}

// Not printf: the pattern comes from outside.
std::string frame_name(const std::string& pattern, std::size_t frame)
{
    const auto [percent, end] = find_conversion(pattern);
    if (end == std::string::npos)
        throw Failure(ExitCode::usage,
                      error_at(1205, "", fmt::format("'{}' has no place for the frame number", pattern),
                               "write it as frame_%04d.ply, with one %d or %04d"));
    const std::string digits = pattern.substr(percent + 1, end - percent - 1);
    const std::size_t width = digits.empty() ? 0 : std::min<std::size_t>(std::stoul("0" + digits.substr(0, 4)), 20);
    std::string number = std::to_string(frame);
    if (number.size() < width) number.insert(0, width - number.size(), digits[0] == '0' ? '0' : ' ');
    return pattern.substr(0, percent) + number + pattern.substr(end + 1);
}

} // namespace pliant
