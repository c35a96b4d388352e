// The paper's whole pipeline on one set of poses, each stage timed: its Table I.
#pragma once

#include "bake/options.h"
#include "base/mesh/pose_set.h"

namespace pliant {

// Algorithm 1's subspace of `dimension` dimensions; as surrogate energy a ghost of surfaces, the quartic of St.
// Venant-Kirchhoff solids, three cubature points per dimension of Mooney-Rivlin solids; the runtime along a path of weights
// that a drag in a polygon makes. One row of CSV below its header. Only linear systems, and for cubature reduced averages,
// are solved on the full mesh. `surrogate_s` includes the averages that the predictor is fitted to; `unconverged` of them
// did not converge.
std::string pipeline_csv(const PoseSet& poses, const EnergyOptions& options, Eigen::Index dimension);

} // namespace pliant
