// Where the shape of a blend of many poses is looked for.
#pragma once

#include "elastic/average/placement.h"
#include "elastic/average/rotation_strain.h"
#include "elastic/average/solver_pool.h"

#include <memory>
#include <vector>

namespace pliant {

// Poses, or layers, added up before any energy is asked. Their displacements, or the rotations and strains of their cells:
// half of a limb that turned is then a limb that turned half as far. The one with less energy is the guess; at the poses
// both are the pose itself.
class PoseSum {
public:
    // Rotations and strains are those against `base`. The pool must outlive it. Cost: the coordinates of every pose; at the
    // first call of each worker a factorisation with one unknown per vertex.
    PoseSum(SolverPool& pool, const Shape& base);

    // The sum of rotations and strains. Tasks may call it at the same time, each with its worker. Cost: a solve with one
    // unknown per vertex.
    Shape turned(const Weights& w, std::size_t worker) const;

    // The guess: the one of least energy of both sums and `turned`, of which the last is given, with what is known to be
    // missing from it. Cost: their energies.
    Shape guess(const Weights& w, const Shape& turned, const Shape* correction) const;

private:
    SolverPool& pool_;
    Placement placement_;
    RotationStrain coordinates_;
    Eigen::VectorXd rest_;                               // coordinates of pose 0
    Eigen::MatrixXf changes_;                            // of each other pose from them
    mutable std::vector<std::unique_ptr<CellFit>> fits_; // one for each worker, made when it is needed
};

} // namespace pliant
