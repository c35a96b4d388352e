#include "elastic/parts/find_ties.h"

#include "base/mesh/point_tree.h"
#include "elastic/parts/attach_parts.h"
#include "elastic/parts/joints.h"
#include "elastic/parts/seams.h"

namespace pliant {

namespace {

void find_joints(const NormalizedPoses& set, TieSet& out)
{
    for (std::size_t first = 0, last = 0; first < out.ties.size(); first = last) {
        last = end_of_part(out, first);
        std::vector<PenaltyTerm> terms = find_joint_terms(set, out.ties.data() + first, out.ties.data() + last);
        if (!terms.empty()) out.joints.push_back({ first, last - first, std::move(terms) });
    }
}

void tie_seams(const NormalizedPoses& set, const Eigen::MatrixXd& columns, const std::vector<BorderEdge>& border,
               TieSet& out)
{
    std::vector<std::size_t> part_of(std::size_t(columns.cols()), 0);
    for (std::size_t p = 0; p < out.parts.count(); ++p)
        for (const std::uint32_t v : out.parts.vertices[p]) part_of[v] = p;
    for (const auto& vertices : find_seams(set, columns, border)) {
        out.ties.push_back(make_tie(set, part_of[vertices[0]], vertices));
        ++out.seam_count;
    }
}

} // namespace

TieSet find_ties(const NormalizedPoses& set)
{
    TieSet out;
    if (set.is_solid()) return out;
    out.parts = find_parts(set);
    const std::vector<BorderEdge> border = find_border(set);
    out.distances.assign(out.parts.count(), 0);
    out.tree.parents.assign(out.parts.count(), no_part);
    if (out.parts.count() < 2 && border.empty()) return out;
    const Eigen::MatrixXd columns = pose_space(set);
    if (out.parts.count() > 1) attach_parts(set, columns, out);
    find_joints(set, out);
    tie_seams(set, columns, border, out);
    return out;
}

} // namespace pliant
