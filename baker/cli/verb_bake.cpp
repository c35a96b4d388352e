#include "cli/verbs.h"

#include "io/write_file.h"
#include "report/certificate.h"

#include <fmt/core.h>
#include <memory>

namespace pliant {

namespace {

struct Arguments {
    std::vector<std::string> poses;
    std::string output, report, surface;
    std::string subspace = "adaptive", stand_in = "auto";
    BakeOptions bake;
    bool has_tolerance = false, is_best_effort = false, is_quiet = false;
};

void print_summary(const Arguments& a, const BakedAsset& baked)
{
    const BakeReport& r = baked.report;
    const std::string energy = r.stand_in_kind == StandInKind::quartic
        ? "exact quartic"
        : fmt::format("{} elements{}", r.element_count, r.stand_in.has_load ? " and a dead load" : "");
    fmt::print("{}: {} poses, {} vertices, d = {}, {}, {:.1f} MiB\n", a.output, r.pose_count, r.vertex_count, r.dimension,
               energy, double(baked.bytes.size()) / 1048576.0);
    fmt::print("basis: {:.2f} bytes a number, off by {:.1e} of the diagonal at most\n", r.basis.bytes_per_number,
               r.basis.largest_difference);
    if (!r.stand_in_reason.empty()) fmt::print("cubature, not the quartic: {}\n", r.stand_in_reason);
    if (r.tet_count && !r.checks.empty()) fmt::print("smallest J of a tetrahedron: {:.3f}\n", r.cell_ratio);
    if (r.drawn)
        fmt::print("drawn: {} vertices of {}{}\n", a.bake.drawn->embedding.count(), a.surface,
                   r.checks.empty() ? ""
                                    : fmt::format(", relative L2 there {:.2e} (mean), {:.2e} (largest)", r.drawn->mean,
                                                  r.drawn->largest));
    if (!r.checks.empty())
        fmt::print(
            "blends at {} weights: relative L2 {:.2e} (mean), {:.2e} (largest), of which the subspace {:.2e} and {:.2e}; "
            "farthest vertex {:.2f} % of the diagonal\n",
            r.checks.size(), r.mean_error, r.largest_error, r.subspace_error.mean, r.subspace_error.largest,
            100 * r.largest_distance);
    for (const StageTime& stage : r.stages) fmt::print("  {:<18} {:8.1f} s\n", stage.stage, stage.seconds);
    fmt::print("  {} factorisations, {} snapshots\n", r.factorization_count, r.adaptive.snapshot_count);
}

// Where to turn when the tolerance is missed: the part that misses it.
std::string remedy(const Arguments& a, const BakeReport& r)
{
    if (r.subspace_error.mean > 0.7 * a.bake.tolerance)
        return r.dimension >= 60
            ? "add a pose between those of the worst weights, leave a pose out, or ask for less with --tolerance"
            : "raise --dim or leave it out, add a pose in between, or ask for less with --tolerance";
    return "raise --elements, add a pose between those of the worst weights, or ask for less with --tolerance";
}

// A tolerance that was asked for is a condition; the default one is an aim, and without checks nothing is known.
ExitCode judge_tolerance(const Arguments& a, const BakedAsset& baked, Progress& progress)
{
    const BakeReport& r = baked.report;
    if (r.checks.empty() || r.meets_tolerance) return ExitCode::done;
    const bool is_asked = a.has_tolerance || a.bake.tolerance_max > 0;
    if (!is_asked && (a.bake.dimension || a.bake.subspace != SubspaceKind::adaptive)) return ExitCode::done;
    const std::string what = fmt::format(
        "blends miss the tolerance {:.3g}{}: mean error {:.2e} (subspace alone {:.2e}) at d = {} and {} elements, largest "
        "{:.2e} "
        "at weights {}",
        a.bake.tolerance, a.bake.tolerance_max > 0 ? fmt::format(" (largest {:.3g})", a.bake.tolerance_max) : "",
        r.mean_error, r.subspace_error.mean, r.dimension, r.element_count, r.largest_error, weights_text(r.worst_weights));
    if (!is_asked || a.is_best_effort) progress.warn(4404, what, remedy(a, r));
    if (!is_asked) return ExitCode::done;
    if (!a.is_best_effort)
        throw Failure(ExitCode::misses_tolerance,
                      error_at(4405, "", what, remedy(a, r) + "; --best-effort writes it all the same"));
    return ExitCode::misses_tolerance;
}

ExitCode run(Arguments& a)
{
    a.bake.subspace = a.subspace == "krylov" ? SubspaceKind::krylov
        : a.subspace == "barbic"             ? SubspaceKind::barbic
                                             : SubspaceKind::adaptive;
    std::vector<std::string> inputs = input_files(a.poses, a.bake.energy);
    if (!a.surface.empty()) inputs.push_back(a.surface);
    probe_output(a.output, inputs);
    if (!a.report.empty()) probe_output(a.report, inputs);
    for (StandInKind kind : { StandInKind::quartic, StandInKind::cubature, StandInKind::ghost })
        if (a.stand_in == name_of(kind)) a.bake.stand_in = kind;
    ConsoleProgress progress("bake", a.is_quiet);
    const PoseSet poses = load_with_warnings("bake", a.poses, a.bake.energy);
    if (!a.surface.empty())
        a.bake.drawn = std::make_shared<const DrawnSurface>(load_surface_with_warnings("bake", a.surface, poses));
    const BakedAsset baked = bake(poses, a.bake, progress);
    const ExitCode verdict = judge_tolerance(a, baked, progress);
    write_output(a.output, { reinterpret_cast<const char*>(baked.bytes.data()), baked.bytes.size() });
    if (!a.report.empty()) write_output(a.report, write_report(baked.report));
    progress.clear_line();
    if (!a.is_quiet) print_summary(a, baked);
    return verdict;
}

} // namespace

Verb add_bake(CLI::App& app)
{
    auto a = std::make_shared<Arguments>();
    CLI::App* verb = app.add_subcommand("bake", "Turn poses into an asset for the runtime");
    verb->footer("Example:\n  pliant bake rest.ply run.ply jump.ply -o hero.pliant\n"
                 "Bakes the three poses of one mesh (same vertices, same faces) into hero.pliant, then checks it with the "
                 "real runtime\n"
                 "against the unreduced average. Try `pliant check` first: it is quick and writes nothing.");
    add_pose_arguments(*verb, a->poses);
    verb->add_option("-o,--output", a->output, "Asset to write")->required()->type_name("OUT.pliant");
    add_energy_options(*verb, a->bake.energy);
    add_surface(*verb, a->surface);
    verb->add_option(
            "--subspace", a->subspace,
            "How the reduced space is built: adaptive (of true averages, with as few dimensions as keep --tolerance), "
            "krylov "
            "(Algorithm 1 of von Tycowicz et al. 2015: quicker to bake, far less accurate) or barbic (Barbic et al. 2009: "
            "tangents and linear modes; for comparison)")
        ->check(CLI::IsMember({ "adaptive", "krylov", "barbic" }))
        ->capture_default_str()
        ->type_name("NAME");
    verb->add_option(
            "--tolerance", a->bake.tolerance,
            "Wanted relative L2 error of blends, mean over check weights, stand-in included; if you give it and it is "
            "missed, nothing is written and the exit code is 4")
        ->each([a](const std::string&) { a->has_tolerance = true; })
        ->check(CLI::Range(1e-8, 1.0))
        ->capture_default_str();
    verb->add_option("--tolerance-max", a->bake.tolerance_max,
                     "Wanted largest error over the check weights (default: reported, not asked)")
        ->check(CLI::Range(1e-8, 1.0));
    verb->add_flag("--best-effort", a->is_best_effort,
                   "Write the asset even if it misses --tolerance (exit code 4 all the same)");
    verb->add_option("--ritz", a->bake.ritz_count, "krylov: Ritz vectors per tangent")
        ->check(CLI::Range(0, 32))
        ->capture_default_str();
    verb->add_option("--dim", a->bake.dimension,
                     "Dimension of the reduced space (default: what the tolerance or --ritz asks for)")
        ->check(CLI::Range(1, 256));
    verb->add_option(
            "--energy", a->stand_in,
            "Stand-in for the energy: quartic (a polynomial, exact, of stvk solids), cubature (few elements, accurate), "
            "ghost (coarse mesh, of surfaces), or auto: quartic where d is at most 32, else cubature")
        ->check(CLI::IsMember({ "auto", "quartic", "cubature", "ghost" }))
        ->capture_default_str()
        ->type_name("NAME");
    verb->add_option("--elements", a->bake.element_count,
                     "Cubature elements (default: as few as keep the tolerance, 4 to 12 per dimension)")
        ->check(CLI::Range(1, 1000000));
    verb->add_option_function<std::string>(
            "--cubature",
            [a](const std::string& name) {
                a->bake.cubature_solver = name == "nn-htp" ? CubatureSolver::nn_htp : CubatureSolver::nnls;
            },
            "How cubature elements are found: nnls (greedy) or nn-htp (hard thresholding pursuit, von Tycowicz et al. 2013)")
        ->check(CLI::IsMember({ "nnls", "nn-htp" }))
        ->default_str("nnls")
        ->type_name("NAME");
    verb->add_option("--ghost-vertices", a->bake.ghost_vertex_count, "Vertices of the ghost")
        ->check(CLI::Range(4, 1000000))
        ->capture_default_str();
    verb->add_option("--check-samples", a->bake.check_count,
                     "Weights at which dimension, elements and dead load are judged by unreduced averages")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    verb->add_option("--fresh-samples", a->bake.fresh_count,
                     "Further weights, by which nothing is chosen, at which the asset is compared with unreduced averages")
        ->check(CLI::Range(0, 1000))
        ->capture_default_str();
    verb->add_option("--position-error", a->bake.position_error,
                     "How far a vertex may be moved by storing the basis in few bits, over the bounding-box diagonal; 0 "
                     "stores single "
                     "precision, which --fix always does")
        ->check(CLI::Range(0.0, 1e-2))
        ->capture_default_str();
    verb->add_option("--seed", a->bake.seed, "Seed of everything random")->capture_default_str();
    verb->add_flag_callback(
        "--no-scene", [a] { a->bake.keep_scene = false; },
        "Do not store what poses from glTF are drawn with: texture coordinates, colours, materials, images");
    verb->add_option("--report", a->report, "Also write a report with errors and times")->type_name("OUT.json");
    add_threads(*verb);
    add_quiet(*verb, a->is_quiet);
    return [a] { return run(*a); };
}

} // namespace pliant
