#include "cli/bake_request.h"

#include "bake/certificate.h"
#include "cli/config_options.h"
#include "cli/verbs.h"

#include <filesystem>
#include <fmt/core.h>
#include <stdexcept>

namespace pliant {

namespace {

void add_blend_options(CLI::App& verb, BakeRequest& r)
{
    add_blend_kind(verb, r.bake.energy);
    verb.add_option("--range", r.ranges,
                    "Layers: the range in which weights are proven, of all layers or of one, as 0:1.3 or smile=-0.5:1 "
                    "(default: 0:1). Outside of it the runtime blends as well, without a certificate")
        ->type_name("RANGE")
        ->expected(1, -1)
        ->allow_extra_args(false);
}

} // namespace

void add_bake_options(CLI::App& verb, BakeRequest& r)
{
    add_pose_arguments(verb, r.poses)->required(false);
    verb.add_option("-o,--output", r.output, "Asset to write")->type_name("OUT.pliant");
    add_blend_options(verb, r);
    add_energy_options(verb, r.bake.energy);
    add_surface(verb, r.surface);
    verb.add_option(
            "--subspace", r.subspace,
            "How to build the reduced space: adaptive (from unreduced averages, with the fewest dimensions that meet "
            "--tolerance), krylov (Algorithm 1 of von Tycowicz et al. 2015: faster to bake, far less accurate) or barbic "
            "(Barbic et al. 2009: tangents, modes and derivatives of the first pose; for comparison)")
        ->transform(CLI::IsMember({ "adaptive", "krylov", "barbic" }, CLI::ignore_case))
        ->capture_default_str()
        ->type_name("NAME");
    verb.add_option(
            "--tolerance", r.bake.tolerance,
            "Allowed relative L2 error of blends, mean over the check weights, including the error of the "
            "surrogate energy. A bake that misses the one you set writes no asset and has exit code 4, unless "
            "--best-effort or a limit of time is given; without the option it is an aim, and missing it is a warning")
        ->each([&r](const std::string&) { r.has_tolerance = true; })
        ->check(number_in(1e-8, 1.0))
        ->capture_default_str();
    verb.add_option("--tolerance-max", r.bake.tolerance_max,
                    "Allowed largest error over the check weights and at the poses (default: no limit); a miss ends as that "
                    "of --tolerance")
        ->check(number_in(1e-8, 1.0));
    verb.add_flag("--best-effort", r.is_best_effort,
                  "Write the asset even if it misses the tolerance that you set; the exit code is 4 then, too");
    verb.add_option("--ritz", r.bake.ritz_count, "krylov: Ritz vectors per tangent")
        ->transform(whole_number_in(0, 32))
        ->capture_default_str();
    verb.add_option("--dim", r.bake.dimension, "Dimension of the reduced space (default: chosen by the tolerance or --ritz)")
        ->transform(whole_number_in(1, 256));
    verb.add_option(
            "--energy", r.surrogate,
            "Surrogate energy: quartic (an exact polynomial; stvk solids only), cubature (few elements, accurate), ghost (a "
            "coarse mesh; surfaces only), or auto (for stvk solids quartic if d is at most 32; otherwise cubature)")
        ->transform(CLI::IsMember({ "auto", "quartic", "cubature", "ghost" }, CLI::ignore_case))
        ->capture_default_str()
        ->type_name("NAME");
    verb.add_option("--elements", r.bake.element_count,
                    "Number of cubature elements (default: the fewest that meet the tolerance, 4 to 12 per dimension)")
        ->transform(whole_number_in(1, 1000000));
    verb.add_option_function<std::string>(
            "--cubature",
            [&r](const std::string& name) {
                r.bake.cubature_solver = name == "nn-htp" ? CubatureSolver::nn_htp : CubatureSolver::nnls;
            },
            "How to find cubature elements: nnls (greedy) or nn-htp (hard thresholding pursuit, von Tycowicz et al. 2013)")
        ->transform(CLI::IsMember({ "nnls", "nn-htp" }, CLI::ignore_case))
        ->default_str("nnls")
        ->type_name("NAME");
    verb.add_option("--ghost-vertices", r.bake.ghost_vertex_count, "Number of vertices of the ghost")
        ->transform(whole_number_in(4, 1000000))
        ->capture_default_str();
    verb.add_option(
            "--check-samples", r.bake.check_count,
            "Number of weights at which dimension, elements and dead load are chosen by comparison with unreduced averages")
        ->transform(whole_number_in(0, 1000))
        ->capture_default_str();
    verb.add_option("--fresh-samples", r.bake.fresh_count,
                    "Number of further weights at which the finished asset is compared with unreduced averages; they affect "
                    "no choice")
        ->transform(whole_number_in(0, 1000))
        ->capture_default_str();
    verb.add_option_function<double>(
            "--position-error", [&r](double error) { r.bake.position_error = error; },
            "Allowed displacement of a vertex by the compact storage of the basis, as a fraction of the bounding-box "
            "diagonal; 0 stores single precision")
        ->check(number_in(0.0, 1e-2))
        ->default_str("5e-5 or a twentieth of --tolerance")
        ->type_name("FLOAT");
    verb.add_option_function<double>(
            "--time-limit", [&r](double seconds) { r.bake.time_limit = seconds; },
            "Stop refining after so many seconds and write the best asset so far, as with --best-effort. The shortest bake "
            "is "
            "that of --preview. The asset depends on the speed of the machine, except with 0")
        ->check(number_in(0.0, 1e6))
        ->type_name("FLOAT");
    verb.add_flag("--preview", r.is_preview,
                  "Bake a rough asset quickly, to try weights and poses: --time-limit 0 and a tolerance of 5e-3 as its aim, "
                  "each unless you set it");
    verb.add_option("--seed", r.bake.seed, "Random seed")->transform(whole_number_in(0, UINT64_MAX))->capture_default_str();
    verb.add_flag_callback(
        "--no-scene", [&r] { r.bake.keep_scene = false; },
        "Do not store texture coordinates, colours, materials and images of poses from glTF files");
    verb.add_option("--report", r.report, "Also write a report with errors, times and warnings")->type_name("OUT.json");
    verb.add_option(
            "--depfile", r.depfile,
            "Also write a dependency file for Make and Ninja with the names of all files that were read: the poses and the "
            "files that they refer to, --fix, --surface, --config")
        ->type_name("OUT.d");
    verb.add_option(
            "--stamp", r.stamp,
            "Also write, as the last file, a stamp of the bake: hashes of all inputs and of the asset, options, version. "
            "`pliant bake-all` keeps a stamp next to each asset")
        ->type_name("OUT.stamp");
    add_threads(verb);
    add_talk(verb, r.talk);
}

namespace {

// "0:1.3" or "smile=0:1.3"; names may hold a '='.
NamedRange parse_range(const std::string& text)
{
    const std::size_t equals = text.rfind('='), start = equals == std::string::npos ? 0 : equals + 1,
                      colon = text.find(':', start);
    try {
        if (colon == std::string::npos) throw std::invalid_argument(text);
        NamedRange out;
        if (start > 0) out.layer = text.substr(0, equals);
        out.range.low = parse_weight(text.substr(start, colon - start));
        out.range.high = parse_weight(text.substr(colon + 1));
        return out;
    } catch (const std::exception&) {
        throw Failure(ExitCode::usage,
                      error_at(1235, "", fmt::format("--range '{}' is no range", text),
                               "write it as 0:1.3, or for one layer as smile=-0.5:1"));
    }
}

Json read_config(BakeRequest& r)
{
    const ReadLog log;
    Json json = read_json_file(r.config);
    r.config_files = log.files();
    return json;
}

} // namespace

void complete_request(CLI::App& verb, BakeRequest& r)
{
    if (!r.config.empty()) {
        const std::string folder = std::filesystem::path(r.config).parent_path().string();
        apply_config(verb, checked_config(verb, read_config(r), r.config, folder), r.config);
    }
    if (r.poses.empty())
        throw Failure(
            ExitCode::usage,
            error_at(1301, "", "there are no poses", "name them, or give --config FILE.json with \"poses\": [...]"));
    if (r.output.empty())
        throw Failure(
            ExitCode::usage,
            error_at(1302, "", "there is no output", "give -o OUT.pliant, or --config FILE.json with \"output\": \"...\""));
    require_comparisons(r.bake, r.has_tolerance);
    r.bake.subspace = r.subspace == "krylov" ? SubspaceKind::krylov
        : r.subspace == "barbic"             ? SubspaceKind::barbic
                                             : SubspaceKind::adaptive;
    for (const std::string& text : r.ranges) r.bake.ranges.push_back(parse_range(text));
    if (r.is_preview) make_preview(r.bake, r.has_tolerance);
    for (SurrogateKind kind : { SurrogateKind::quartic, SurrogateKind::cubature, SurrogateKind::ghost })
        if (r.surrogate == name_of(kind)) r.bake.surrogate = kind;
}

} // namespace pliant
