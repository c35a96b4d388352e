#include "elastic/parts/tie_report.h"

#include "elastic/energy/energy.h"

#include <algorithm>
#include <fmt/core.h>
#include <iterator>

namespace pliant {

namespace {

// Beyond this distance from its parent, in units of the diagonal, a part does not touch it, and the poses do not say what
// holds it.
constexpr double far_away = 0.1;

// A turn that is off by less is not seen (radians).
constexpr double visible_turn = turn_drift_limit;

constexpr double degrees = 57.29577951308232;

void add(const TieDrift& drift, const Eigen::VectorXd& weights, WorstDrift& worst)
{
    if (drift.largest > worst.drift.largest) worst = { drift, weights };
}

void add_turn(const Joint& joint, std::size_t part, const Weights& v, WorstTurn& worst)
{
    const JointTurn turn = turn_of_layers(joint, v);
    if (turn.miss > worst.turn.miss) worst = { turn, part, v };
}

// The ends of the ranges of the layers that turn the joint, one at a time and two at a time.
void add_turns(const Joint& joint, std::size_t part, const std::vector<WeightRange>& ranges, WorstTurn& worst)
{
    const Eigen::Index count = Eigen::Index(ranges.size());
    std::vector<Weights> ends;
    for (Eigen::Index k = 0; k < count; ++k) {
        if (turn_of_layers(joint, Weights::Unit(count, k)).angle < visible_turn) continue;
        for (const double end : { ranges[std::size_t(k)].low, ranges[std::size_t(k)].high })
            ends.push_back(end * Weights::Unit(count, k));
    }
    for (std::size_t i = 0; i < ends.size(); ++i) {
        add_turn(joint, part, ends[i], worst);
        for (std::size_t j = i % 2 ? i + 1 : i + 2; j < ends.size(); ++j) add_turn(joint, part, ends[i] + ends[j], worst);
    }
}

std::vector<PartSummary> describe_parts(const TieSet& ties, const NormalizedPoses& set)
{
    std::vector<PartSummary> out;
    for (std::size_t p = 0; p < ties.parts.count(); ++p) {
        const std::size_t parent = ties.tree.parents[p] == no_part ? p : ties.tree.parents[p];
        out.push_back({ ties.parts.vertices[p][0], ties.parts.vertices[parent][0], ties.parts.vertices[p].size(), 0,
                        ties.distances[p] / set.diagonal });
    }
    for (std::size_t i = 0; i + ties.seam_count < ties.ties.size(); ++i) ++out[ties.ties[i].part].tie_count;
    return out;
}

} // namespace

TieReport start_tie_report(const TieSet& ties, const NormalizedPoses& set, const WeightDomain& domain)
{
    TieReport report;
    report.part_count = ties.parts.count();
    report.tie_count = ties.ties.size();
    report.seam_count = ties.seam_count;
    for (const Joint& joint : ties.joints) {
        report.joint_count += joint.is_used;
        if (joint.is_used && domain.is_box()) add_turns(joint, joint.terms[0].part, domain.ranges(), report.turn);
    }
    report.parts = describe_parts(ties, set);
    return report;
}

void add_check(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& reference,
               const Shape& blend, TieReport& report)
{
    add(measure_drift(ties, set, weights, reference), weights, report.reference);
    add(measure_drift(ties, set, weights, blend), weights, report.blends);
    add(measure_turn_drift(ties, weights, blend), weights, report.turning);
}

void use_file_numbers(const std::vector<std::uint32_t>& numbers, TieReport& report)
{
    if (numbers.empty()) return;
    for (PartSummary& part : report.parts)
        part.vertex = numbers[part.vertex], part.parent_vertex = numbers[part.parent_vertex];
    for (WorstDrift* worst : { &report.reference, &report.blends, &report.turning })
        worst->drift.vertex = numbers[worst->drift.vertex];
}

namespace {

bool is_root(const PartSummary& part) { return part.vertex == part.parent_vertex; }
bool is_loose(const PartSummary& part) { return !is_root(part) && part.tie_count == 0; }
bool is_distant(const PartSummary& part) { return !is_root(part) && part.distance > far_away; }

std::vector<PartSummary> parts_that(const TieReport& report, bool (*is_selected)(const PartSummary&))
{
    std::vector<PartSummary> out;
    std::copy_if(report.parts.begin(), report.parts.end(), std::back_inserter(out), is_selected);
    return out;
}

std::vector<std::uint32_t> vertices_of(const std::vector<PartSummary>& parts)
{
    std::vector<std::uint32_t> out;
    for (const PartSummary& part : parts) out.push_back(part.vertex);
    return out;
}

std::string text_of(const PartSummary& part)
{
    return fmt::format("that of vertex {} ({} vertices)", part.vertex, part.vertex_count);
}

void warn_about_loose(const std::vector<PartSummary>& parts, Progress& progress)
{
    if (parts.empty()) return;
    progress.warn(4409,
                  fmt::format("{} parts are attached to nothing: their neighbours have no three vertices that could hold "
                              "them; the first is {}",
                              parts.size(), text_of(parts[0])),
                  "join them to other parts, or remove them from all poses");
}

void warn_about_distant(const std::vector<PartSummary>& parts, Progress& progress)
{
    if (parts.empty()) return;
    const PartSummary& farthest = *std::max_element(
        parts.begin(), parts.end(), [](const PartSummary& a, const PartSummary& b) { return a.distance < b.distance; });
    progress.warn(
        4410,
        fmt::format("{} parts are far from all others, the farthest is {}: {:.0f} % of the diagonal from the part of vertex "
                    "{}, which it follows",
                    parts.size(), text_of(farthest), 100 * farthest.distance, farthest.parent_vertex),
        "bake separate objects one by one");
}

void warn_about_drift(const TieReport& report, const std::vector<std::string>& pose_names, Progress& progress)
{
    const bool is_far = report.blends.drift.largest > drift_limit;
    if (!is_far && !(report.turning.drift.largest > turn_drift_limit)) return;
    const WorstDrift& worst = is_far ? report.blends : report.turning;
    progress.warn(
        4408,
        fmt::format("the part of vertex {} drifts by {:.2f} % of {} from its attachment, most at vertex {}, "
                    "weights {}",
                    report.parts[worst.drift.part].vertex, 100 * worst.drift.largest,
                    is_far ? "the diagonal" : "its own radius", worst.drift.vertex, blend_text(worst.weights, pose_names)),
        "add a pose in between, leave out --dim or lower --tolerance; --weld 1e-4 (or 1e-3) joins borders that compression "
        "has moved apart");
}

void warn_about_turn(const TieReport& report, const std::vector<std::string>& pose_names, Progress& progress)
{
    const WorstTurn& worst = report.turn;
    if (!(worst.turn.miss > visible_turn)) return;
    progress.warn(
        4414,
        fmt::format("the part of vertex {} turns by {:.0f} degrees at weights {}, where its layers add up to {:.0f}",
                    report.parts[worst.part].vertex, degrees * worst.turn.angle, blend_text(worst.weights, pose_names),
                    degrees * worst.turn.sum),
        "a part of its own turns by less below weight 0, above 1 and where layers add up: draw turns to both sides "
        "as layers of their own, and far turns whole");
}

} // namespace

std::vector<std::uint32_t> loose_parts(const TieReport& report) { return vertices_of(parts_that(report, is_loose)); }
std::vector<std::uint32_t> distant_parts(const TieReport& report) { return vertices_of(parts_that(report, is_distant)); }

void warn_about_ties(const TieReport& report, const std::vector<std::string>& pose_names, Progress& progress)
{
    warn_about_loose(parts_that(report, is_loose), progress);
    warn_about_distant(parts_that(report, is_distant), progress);
    warn_about_drift(report, pose_names, progress);
    warn_about_turn(report, pose_names, progress);
}

} // namespace pliant
