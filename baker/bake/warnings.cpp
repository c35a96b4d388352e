#include "bake/warnings.h"

#include "base/mesh/align.h"
#include "base/weights/weights.h"

#include <fmt/core.h>

namespace pliant {
namespace {

// The part that misses the tolerance, if the user has chosen it: "raise --dim or leave it out, ". Only options that were
// given, since without them the baker has tried more already.
std::string choice_at_fault(const BakeReport& r, const BakeOptions& options)
{
    const bool is_subspace = r.fit.subspace_error.mean > 0.5 * options.tolerance;
    if (is_subspace && options.dimension) return "raise --dim or leave it out, ";
    if (!is_subspace && options.element_count && r.fit.kind == SurrogateKind::cubature)
        return "raise --elements or leave it out, ";
    return "";
}

// What helps besides a larger tolerance: against averages that jump, else for the poses.
std::string remedy(const BakeReport& r, const BakeOptions& options)
{
    if (options.time_limit)
        return *options.time_limit > 0 ? "raise --time-limit or leave it out, " : "leave out --preview or --time-limit 0, ";
    const bool is_shell = r.input.material == Material::discrete_shells;
    const bool has_layers = !r.input.ranges.empty();
    const bool has_jumps = std::any_of(r.branches.begin(), r.branches.end(),
                                       [](const Branch& branch) { return branch.kind != Branch::Kind::turn; });
    if (has_jumps && is_shell)
        return has_layers ? "sums of layers jump (P4406): use --material arap, take a smaller --range, "
                          : "averages jump (P4406): use --material arap, ";
    if (has_jumps)
        return has_layers ? "sums of layers jump (P4406): take a smaller --range, leave a layer out, "
                          : "averages jump (P4406): add a pose in between, leave a pose out, ";
    return choice_at_fault(r, options)
        + (has_layers ? "take a smaller --range, leave a layer out, "
                      : "add a pose between those of the worst weights, leave a pose out, ");
}

bool is_of_layers(const Branch& branch, const std::vector<std::string>& pose_names)
{
    return std::size_t(branch.weights.size()) < pose_names.size();
}

std::string describe(const Branch& branch, const std::vector<std::string>& pose_names)
{
    const std::string& pose = pose_names[branch.pose];
    const bool is_jump = branch.kind == Branch::Kind::jump;
    if (is_of_layers(branch, pose_names))
        return fmt::format("{} on the path towards layer {}",
                           is_jump ? "the sum of layers jumps" : "there is a second sum of layers", pose);
    if (branch.kind == Branch::Kind::other_mean)
        return fmt::format("there is a second average of all poses, found from pose {}", pose);
    if (branch.kind == Branch::Kind::turn) return fmt::format("blends turn at once on the path towards pose {}", pose);
    return is_jump ? fmt::format("the average jumps on the path towards pose {}", pose)
                   : fmt::format("there is a second average on the path to pose {}", pose);
}

} // namespace

std::optional<ToleranceMiss> find_miss(const BakeReport& r, const BakeOptions& options, bool has_tolerance)
{
    if (r.check.blends.empty() || r.check.meets_tolerance) return {};
    const bool is_asked = has_tolerance || (options.tolerance_max > 0 && r.check.largest_error > options.tolerance_max);
    if (!is_asked && (options.dimension || options.subspace != SubspaceKind::adaptive)) return {};
    std::string miss = fmt::format("{} miss the tolerance {:.3g}", r.input.ranges.empty() ? "blends" : "mixtures of layers",
                                   options.tolerance);
    if (options.tolerance_max > 0) miss += fmt::format(" (largest {:.3g})", options.tolerance_max);
    miss += fmt::format(": mean error {:.2e} (at best {:.2e} in the subspace) at d = {}", r.check.mean_error,
                        r.fit.subspace_error.mean, r.fit.dimension);
    if (r.fit.kind != SurrogateKind::quartic) miss += fmt::format(" and {} elements", r.fit.element_count);
    miss += fmt::format(", largest {:.2e} at weights {}", r.check.largest_error,
                        blend_text(r.check.worst_weights, r.input.pose_names));
    return ToleranceMiss { is_asked, miss, remedy(r, options) + "or raise --tolerance" };
}

void warn_of(const ToleranceMiss& miss, Progress& progress) { progress.warn(4404, miss.what, miss.hint); }

Failure to_failure(const ToleranceMiss& miss)
{
    return Failure(ExitCode::misses_tolerance,
                   error_at(4405, "", miss.what, miss.hint + "; --best-effort writes the asset anyway"));
}

void require_convergence(const NewtonResult& result, const NewtonOptions& options, const std::string& frame)
{
    if (result.has_converged) return;
    throw Failure(ExitCode::failed,
                  error_at(4303, "",
                           fmt::format("{}the average did not converge: relative decrement {:.1e} (wanted {:.1e}), "
                                       "unbalanced force {:.1e} (wanted {:.1e}) after {} iterations",
                                       frame, result.decrement, options.decrement, result.residual, options.residual,
                                       result.iterations),
                           "add an in-between pose, or try another --thickness"));
}

void require_layered_shape(const NewtonResult& result, const Weights& v, const std::vector<std::string>& pose_names,
                           const std::string& frame)
{
    if (result.has_converged) return;
    std::string what = fmt::format("{}no shape was found at the layer weights {}", frame, blend_text(v, pose_names));
    if (result.iterations > 0)
        what += fmt::format(": relative decrement {:.1e}, unbalanced force {:.1e}", result.decrement, result.residual);
    throw Failure(
        ExitCode::failed,
        error_at(4305, "", what, "take weights nearer to the range from 0 to 1; of a surface also try --material arap"));
}

const char* hint_for_jumps(Material material, bool has_layers)
{
    if (has_layers)
        return material == Material::discrete_shells ? "use --material arap, or take a smaller --range"
                                                     : "take a smaller --range, or leave one of the layers out";
    return material == Material::discrete_shells ? "use --material arap, or add a pose in between"
                                                 : "add a pose in between, so that there is only one way to bend";
}

void warn_of_jumps(const FamilyPoint& point, const PoseSet& poses, Material material, const std::string& frame,
                   Progress& progress)
{
    for (const Branch& jump : point.jumps)
        progress.warn(4406,
                      frame + describe(jump, poses.names)
                          + fmt::format(": distance {:.1f} %, largest at vertex {}, weights {}", 100 * jump.distance,
                                        poses.file_number(jump.vertex), blend_text(jump.weights, poses.names)),
                      hint_for_jumps(material, is_of_layers(jump, poses.names)));
}

namespace {

const char* hint_for_turns(bool is_aligned)
{
    return is_aligned ? "place the poses the way blends should move between them, and keep them there: --no-align"
                      : "bake poses that turn less against each other";
}

void warn_of_inversion(const BakeReport& report, Progress& progress)
{
    if (!report.input.tet_count || report.check.blends.empty() || report.check.cell_ratio > 0) return;
    progress.warn(
        4407, fmt::format("blends contain inverted tetrahedra (smallest volume ratio J = {:.3f})", report.check.cell_ratio),
        report.input.ranges.empty() ? "use --material mooney-rivlin, or add a pose in between"
                                    : "use --material mooney-rivlin, or take a smaller --range");
}

} // namespace

void warn_of_memory(double needed, double available, Progress& progress)
{
    if (needed <= available) return;
    constexpr double gibibyte = 1073741824.0;
    progress.warn(4411,
                  fmt::format("needs about {:.1f} GiB of memory, there are {:.1f}", needed / gibibyte, available / gibibyte),
                  "lower --threads, bake a coarser mesh, or use a machine with more memory");
}

NormalizedPoses normalize_poses(const PoseSet& poses, const EnergyOptions& energy, Progress& progress)
{
    NormalizedPoses set = normalize(poses, energy.keep_placement);
    const bool is_kept = set.frame.size() > 0 || !set.is_free();
    if (is_kept || (!energy.keep_placement && !poses.share_frame)) return set;
    std::size_t farthest = 0;
    for (std::size_t k = 1; k < set.pose_count(); ++k)
        if (turned_degrees(set, k) > turned_degrees(set, farthest)) farthest = k;
    progress.warn(4413,
                  fmt::format("the poses turn too far for blends that turn with them, {} by {:.0f} degrees: all are aligned "
                              "with the first",
                              poses.names[farthest], turned_degrees(set, farthest)),
                  "turn the character where it is drawn, or bake poses that turn less");
    return set;
}

void warn_of_foldover(const InputReport& input, const EnergyOptions& energy, Progress& progress)
{
    if (!input.foldover_count) return;
    progress.warn(4403,
                  fmt::format("{} hinges are folded over or fold strongly between poses; their bending is multiplied by {}",
                              input.foldover_count, energy.shell.foldover_damping),
                  "smooth the creases there, or set --foldover-damping (1 = off)");
}

void warn_of_blends(const BakeReport& report, const PoseSet& poses, Progress& progress)
{
    for (const Branch& branch : report.branches)
        progress.warn(4406,
                      fmt::format("{}: distance {:.1f} %, largest at vertex {}, weights {}", describe(branch, poses.names),
                                  100 * branch.distance, branch.vertex, blend_text(branch.weights, poses.names)),
                      branch.kind == Branch::Kind::turn
                          ? hint_for_turns(report.input.is_aligned)
                          : hint_for_jumps(report.input.material, !report.input.ranges.empty()));
    warn_of_inversion(report, progress);
    if (report.check.ties) warn_about_ties(*report.check.ties, poses.names, progress);
}

void add_warnings(const std::vector<Diagnostic>& warned, const BakeReport& report, std::vector<Diagnostic>& warnings)
{
    for (Diagnostic warning : warned) {
        if (warning.number == 4403) warning = about_vertices(std::move(warning), report.input.foldover_vertices);
        if (report.check.ties && warning.number == 4409)
            warning = about_vertices(std::move(warning), loose_parts(*report.check.ties));
        if (report.check.ties && warning.number == 4410)
            warning = about_vertices(std::move(warning), distant_parts(*report.check.ties));
        warnings.push_back(std::move(warning));
    }
}

} // namespace pliant
