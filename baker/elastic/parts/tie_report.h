// What a bake says about the parts of a character and how well they keep their place.
#pragma once

#include "base/common/progress.h"
#include "elastic/parts/drift.h"

namespace pliant {

// A part for people: a vertex of it, and one of the part that it hangs on.
struct PartSummary {
    std::uint32_t vertex, parent_vertex;
    std::size_t vertex_count, tie_count;
    double distance; // of the nearest vertex of either from the other (root mean square over the poses), per diagonal
};

// The largest drift (elastic/parts/drift.h) over some shapes, and where.
struct WorstDrift {
    TieDrift drift;
    Eigen::VectorXd weights;
};

struct TieReport {
    std::size_t part_count = 1, tie_count = 0, seam_count = 0, joint_count = 0; // ties: those that joints replace, too
    std::vector<PartSummary> parts;                                             // all, by number
    WorstDrift reference, blends;                                               // over the checks
};

// `numbers`: of the vertices in the files; empty: the same.
void use_file_numbers(const std::vector<std::uint32_t>& numbers, TieReport& report);

TieReport start_tie_report(const TieSet& ties, const ShapeSet& set);

// One check: the unreduced average and the blend at the same weights.
void add_check(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& reference,
               const Shape& blend, TieReport& report);

// A vertex of each part that nothing could be tied to, and of each that is far from what it hangs on.
std::vector<std::uint32_t> loose_parts(const TieReport& report);
std::vector<std::uint32_t> distant_parts(const TieReport& report);

// Warns of parts that nothing could be tied to (P4409), of parts that are far from what they hang on (P4410) and of those that drift
// (P4408: farther than `limit`).
void warn_about_ties(const TieReport& report, double limit, Progress& progress);

} // namespace pliant
