#include "bake/options.h"

#include "base/common/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <fmt/ranges.h>

namespace pliant {

namespace {

// Beyond it a layer is another shape than the artist's, and averages do not converge.
constexpr double weight_limit = 1000;

void check_range(const NamedRange& named)
{
    const auto& [low, high, initial] = named.range;
    if (low < high && low <= 0 && high >= 0 && low >= -weight_limit && high <= weight_limit) return;
    const std::string name = named.layer.empty() ? "" : named.layer + "=";
    throw Failure(ExitCode::usage,
                  error_at(1231, "",
                           fmt::format("--range {}{:.6g}:{:.6g} is empty, does not hold 0 or leaves -{}:{}", name, low, high,
                                       weight_limit, weight_limit),
                           "write LO:HI with LO < HI, LO at most 0 and HI at least 0: 0 is the rest shape"));
}

void check_initial(double weight, const std::string& layer)
{
    if (std::abs(weight) <= weight_limit) return;
    throw Failure(ExitCode::bad_input,
                  error_at(1231, "",
                           fmt::format("layer '{}' begins with the weight {:g}, beyond {}", layer, weight, weight_limit),
                           "repair the weights in the file, or bake without its layer"));
}

} // namespace

WeightDomain domain_of(const BakeOptions& options, const PoseSet& poses)
{
    const std::vector<std::string>& pose_names = poses.names;
    if (options.energy.blend != Blend::layers) {
        if (options.ranges.empty()) return WeightDomain::simplex(pose_names.size());
        throw Failure(ExitCode::usage,
                      error_at(1233, "", "--range belongs to --blend layers",
                               "leave it out: weights of averages are not negative and have the sum 1"));
    }
    std::vector<WeightRange> ranges(pose_names.size() - 1);
    for (const NamedRange& named : options.ranges) {
        check_range(named);
        if (named.layer.empty()) std::fill(ranges.begin(), ranges.end(), named.range);
    }
    for (const NamedRange& named : options.ranges) {
        if (named.layer.empty()) continue;
        const auto found = std::find(pose_names.begin() + 1, pose_names.end(), named.layer);
        if (found == pose_names.end())
            throw Failure(
                ExitCode::usage,
                error_at(1232, "", fmt::format("there is no layer '{}' for --range", named.layer),
                         fmt::format("the layers are {}", fmt::join(pose_names.begin() + 1, pose_names.end(), ", "))));
        ranges[std::size_t(found - pose_names.begin()) - 1] = named.range;
    }
    for (std::size_t k = 0; k < ranges.size() && k + 1 < poses.initial_weights.size(); ++k) {
        WeightRange& range = ranges[k];
        range.initial = poses.initial_weights[k + 1];
        check_initial(range.initial, pose_names[k + 1]);
        range.low = std::min(range.low, range.initial);
        range.high = std::max(range.high, range.initial);
    }
    return WeightDomain::box(std::move(ranges));
}

void require_comparisons(const BakeOptions& options, bool has_tolerance)
{
    if (options.check_count + options.fresh_count > 0 || !(has_tolerance || options.tolerance_max > 0)) return;
    throw Failure(ExitCode::usage,
                  error_at(1240, "", "a tolerance is given, but no blend is compared with an average",
                           "give --fresh-samples or --check-samples above 0, or leave the tolerance out"));
}

void make_preview(BakeOptions& options, bool has_tolerance)
{
    constexpr double preview_tolerance = 5e-3;
    if (!options.time_limit) options.time_limit = 0;
    if (!has_tolerance) options.tolerance = preview_tolerance;
}

const char* name_of(Blend blend) { return blend == Blend::layers ? "layers" : "average"; }

const char* name_of(Material material)
{
    switch (material) {
    case Material::arap: return "arap";
    case Material::stvk: return "stvk";
    case Material::mooney_rivlin: return "mooney-rivlin";
    default: return "discrete-shells";
    }
}

const char* name_of(Continuity continuity) { return continuity == Continuity::off ? "off" : "auto"; }

const char* name_of(Membrane membrane)
{
    switch (membrane) {
    case Membrane::stvk: return "stvk";
    case Membrane::edge: return "edge";
    default: return "neo-hookean";
    }
}

const char* name_of(SubspaceKind kind)
{
    return kind == SubspaceKind::krylov ? "krylov" : kind == SubspaceKind::barbic ? "barbic" : "adaptive";
}

const char* name_of(SurrogateKind kind)
{
    switch (kind) {
    case SurrogateKind::quartic: return "quartic";
    case SurrogateKind::cubature: return "cubature";
    case SurrogateKind::ghost: return "ghost";
    default: return "auto";
    }
}

const char* name_of(SolverKind kind) { return kind == SolverKind::eigen ? "eigen" : "cholmod"; }

} // namespace pliant
