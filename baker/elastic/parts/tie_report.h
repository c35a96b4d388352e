// The report of a bake on the parts of a character: how many there are, how they are tied and how far they drift.
#pragma once

#include "base/common/progress.h"
#include "base/weights/domain.h"
#include "elastic/parts/drift.h"
#include "elastic/parts/joints.h"

namespace pliant {

// One part. Vertices identify parts to the user: one vertex of the part, and one of its parent. For the root they are the
// same.
struct PartSummary {
    std::uint32_t vertex, parent_vertex;
    std::size_t vertex_count, tie_count;
    double distance; // to the parent, root mean square over the poses, in units of the diagonal
};

// The largest drift over some shapes, and the weights of that shape.
struct WorstDrift {
    TieDrift drift;
    Eigen::VectorXd weights;
};

// Of layers: the joint that misses the sum of the layers' turns most, at weights within the ranges.
struct WorstTurn {
    JointTurn turn;
    std::size_t part = 0;
    Weights weights;
};

struct TieReport {
    std::size_t part_count = 1;
    std::size_t tie_count = 0; // with those that joints replace
    std::size_t seam_count = 0, joint_count = 0;
    std::vector<PartSummary> parts; // by part number
    WorstDrift reference, blends;   // over the checks: of the unreduced averages, and of the blends
    WorstDrift turning;             // of the blends' rigid parts that turn, in units of each part's radius
    WorstTurn turn;
};

// The counts and parts, and of layers the turns at the ends of their ranges, of one layer and of two; without drift.
TieReport start_tie_report(const TieSet& ties, const NormalizedPoses& set, const WeightDomain& domain);

// Adds one check: the unreduced average (`reference`) and the blend at the same weights.
void add_check(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& reference,
               const Shape& blend, TieReport& report);

// Replaces vertex numbers of the elastic mesh by those in the files. `numbers`: per vertex; empty if they are the same.
void use_file_numbers(const std::vector<std::uint32_t>& numbers, TieReport& report);

// One vertex of every part without ties, and of every part far from its parent.
std::vector<std::uint32_t> loose_parts(const TieReport& report);
std::vector<std::uint32_t> distant_parts(const TieReport& report);

// Warns of parts without ties (P4409), of parts far from their parent (P4410), of blends that drift by more than a limit
// (P4408), and of layers whose turns of a part do not add up (P4414).
void warn_about_ties(const TieReport& report, const std::vector<std::string>& pose_names, Progress& progress);

} // namespace pliant
