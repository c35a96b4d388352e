// The verbs of `pliant`. Each registers its options with the parser and returns what to run when it is chosen.
#pragma once

#include "bake/options.h"
#include "cli/console.h"

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant {

using Verb = std::function<ExitCode()>;

Verb add_bake(CLI::App& app);
Verb add_bake_all(CLI::App& app);
Verb add_check(CLI::App& app);
Verb add_average(CLI::App& app);
Verb add_blend(CLI::App& app);
Verb add_pose(CLI::App& app);
Verb add_measure(CLI::App& app);
Verb add_info(CLI::App& app);
Verb add_validate(CLI::App& app);
Verb add_export(CLI::App& app);
Verb add_report(CLI::App& app);
Verb add_help(CLI::App& app);

// Options that several verbs share.
// As CLI::Range, which takes nan.
CLI::Validator number_in(double least, double most);
// For transform(): accepts decimal digits only. CLI11 reads 010 as 8, and wraps -1 and numbers beyond the type.
CLI::Validator whole_number_in(std::uint64_t least, std::uint64_t most);
CLI::Option* add_pose_arguments(CLI::App& verb, std::vector<std::string>& poses);
void add_energy_options(CLI::App& verb, EnergyOptions& options);
void add_blend_kind(CLI::App& verb, EnergyOptions& options);
void add_threads(CLI::App& verb);
void add_all_vertices(CLI::App& verb, bool& all_vertices);
void add_surface(CLI::App& verb, std::string& path);
void add_talk(CLI::App& verb, Talk& talk);
void add_json(CLI::App& verb, bool& is_json);

// Loads and checks poses; prints warnings under the verb's name, and adds them to `kept` if that is not null.
PoseSet load_with_warnings(const std::string& verb, const std::vector<std::string>& paths, const EnergyOptions& options,
                           std::vector<Diagnostic>* kept = nullptr);

// Loads the surface that is drawn in the place of a solid's boundary; warnings as above.
RenderMesh load_surface_with_warnings(const std::string& verb, const std::string& path, const PoseSet& poses,
                                      std::vector<Diagnostic>* kept = nullptr);

// What `pliant check --json` says: counts, and what a bake would cost. Throws Failure (usage, P1206).
nlohmann::ordered_json describe_poses(const PoseSet& poses, const BakeOptions& options);

// The files that load_with_warnings reads: no output may replace one of them.
std::vector<std::string> input_files(const std::vector<std::string>& poses, const EnergyOptions& options);

// "0.5", and "1,0.5,2", as numbers. Throw Failure (usage, P1201) quoting what is not one.
double parse_weight(std::string word);
std::vector<double> parse_weights(const std::string& text);

// Calls use(weights) for each line of a file, one a frame. Throws Failure (bad_input): P2001, P2601 naming the line that is
// not one, P1222 naming the line for which `use` throws Failure, P1223 if there is none.
void read_weight_path(const std::string& path, const std::function<void(const std::vector<double>&)>& use);

// Nothing is written under a name that promises another format. Throws Failure (usage, P1230) naming the option if `path`
// has a suffix and it is not this one, in any case, or is "-".
void require_suffix(const std::string& option, const std::string& path, const std::string& suffix);

// Where one mesh is written, "frame_%04d.ply" means something else. Throws Failure (usage, P1237) naming the options that
// write many, `owner`.
void require_no_pattern(const std::string& path, const std::string& owner);

// "frame_%04d.ply" with the frame's number in place of its one integer conversion. Throws Failure (usage, P1205).
std::string frame_name(const std::string& pattern, std::size_t frame);

} // namespace pliant
