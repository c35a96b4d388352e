// Joints: penalty terms that hold a rigid part which rotates far against its parent. A tie pulls each vertex from the arc to
// the chord; a joint holds one pivot and the rotation about it. baker/THEORY.md, "Ties", has the derivation.
#pragma once

#include "base/weights/weights.h"
#include "elastic/parts/tie_set.h"

namespace pliant {

// Below this rotation between any two poses (radians) ties suffice: the mean place of a vertex at a tenth of the diagonal
// from the pivot is off the arc by 1 - cos(t/2) of that distance, 0.1 % of the diagonal.
constexpr double min_rotation = 0.3;

// `first` ... `last`: all ties of one part, at least one. Returns the terms that can replace them (the pivot, then one per
// direction of the part), or none unless the tied vertices and their anchors are each rigid and rotate far against each
// other between two poses. Cost: constant per pose (at most 16 ties are used).
std::vector<PenaltyTerm> find_joint_terms(const NormalizedPoses& set, const Tie* first, const Tie* last);

// Of layers, in radians: how far a joint turns its part against the rest shape, how far the layers' own turns would add up
// to, and the angle between the two. A joint blends the axes of the part linearly, and the part takes the nearest rotation.
// From 0 to 1 it follows one layer; below 0, above 1 and where layers add up it turns by less.
struct JointTurn {
    double angle = 0, sum = 0, miss = 0;
};
JointTurn turn_of_layers(const Joint& joint, const Weights& v);

} // namespace pliant
