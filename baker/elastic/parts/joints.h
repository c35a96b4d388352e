// Joints: penalty terms that hold a rigid part which rotates far against its parent. A tie pulls each vertex from the arc to
// the chord; a joint holds one pivot and the rotation about it. baker/THEORY.md, "Ties", has the derivation.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// `first` ... `last`: all ties of one part, at least one. Returns the terms that can replace them (the pivot, then one per
// direction of the part), or none unless the tied vertices and their anchors are each rigid and rotate far against each
// other between two poses. Cost: constant per pose (at most 16 ties are used).
std::vector<PenaltyTerm> find_joint_terms(const NormalizedPoses& set, const Tie* first, const Tie* last);

} // namespace pliant
