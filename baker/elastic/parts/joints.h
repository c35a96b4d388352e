// Joints: what holds a rigid part that rotations far against the part that it hangs on. Why, and how they are chosen: baker/THEORY.md, "Ties".
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// Where a part that these ties (all of the part, one at least) hold is rigid there and rotations far, and what it hangs on is rigid there, too:
// terms that can take the place of its ties. Else none.
std::vector<PenaltyTerm> find_joint_terms(const ShapeSet& set, const Tie* first, const Tie* last);

} // namespace pliant
