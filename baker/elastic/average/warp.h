// Displacements made curved: what they turn they do not stretch.
#pragma once

#include "elastic/average/cells.h"

namespace pliant {

// A displacement that turns a limb by an angle a stretches it by 1 / cos a, and the energy of that stretch hides the energy
// that a Newton step is after. Here every cell takes the rotation and the strain that the displacement means to first order,
// and the shape whose cells come closest to that is rebuilt: rotation-strain coordinates (Huang, Tong, Zhou, Bao, Desbrun
// 2011). The derivative at zero is the displacement itself, so a descent direction stays one.
// One for each thread.
class Warp {
public:
    // The set must outlive it.
    Warp(const NormalizedPoses& set, SolverKind kind)
        : set_(set)
        , fit_(set, kind)
    {
    }

    // y + step to first order; fixed vertices move by `step` exactly. Cost: a solve with one unknown per vertex.
    Shape operator()(const Shape& y, const Shape& step) const;

private:
    const NormalizedPoses& set_;
    CellFit fit_;
};

} // namespace pliant
