// Shapes of a coarse mesh carried over to the fine one.
#pragma once

#include "base/mesh/decimate.h"
#include "elastic/average/rotation_strain.h"
#include "elastic/energy/energy.h"

#include <memory>

namespace pliant {

// A coarse mesh of the same poses, its energy, and a coarser one or null.
struct CoarseBody {
    DecimatedPoses poses;
    std::unique_ptr<Energy> energy;
    std::unique_ptr<CoarseBody> coarser;
};

// Where the vertices of the fine mesh lie on the coarse one: barycentric coordinates in a triangle near by, of pose 0.
struct CoarsePlace {
    Triangle corners; // vertices of the coarse mesh
    Eigen::Vector3d weights;
};

// Per vertex of the fine surface. Distances run along the edges of the fine mesh, so that parts which touch in pose 0 stay
// apart. Cost: n log n.
std::vector<CoarsePlace> find_coarse_places(const NormalizedPoses& fine, const DecimatedPoses& coarse);

// A shape near the average for w of the fine poses, given that of the coarse ones: the blend of the rotations and strains of
// the fine poses, plus the difference of the coarse average from the blend of the coarse poses. Rotations and strains are
// those from pose `base`. Cost: a linear solve with one unknown per vertex, factored here.
Shape prolong(const NormalizedPoses& fine, const DecimatedPoses& coarse, std::size_t base, const Weights& w,
              const Shape& coarse_average, SolverKind kind);

} // namespace pliant
