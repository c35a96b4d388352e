// The subspace of Barbic, da Silva, Popovic 2009 ("Deformable object animation using reduced optimal control"), with which
// von Tycowicz et al. 2015 compare in Table II. For comparison only.
#pragma once

#include "elastic/average/newton.h"
#include "reduced/subspace/subspace.h"

namespace pliant {

// Vibrations of a pose: K x = lambda M x, lambda > 0, the softest first.
struct LinearModes {
    Eigen::MatrixXd vectors;     // 3n x count, mass-orthonormal, mass-orthogonal to the rigid motions of the pose
    Eigen::VectorXd eigenvalues; // ascending
    double residual = 0;         // largest |K x - lambda M x| over lambda |M x|, in the norm of M^-1
    int iterations = 0;
};

// The `count` softest modes of the pose (or average) at which `solver` is factored (NewtonSolver::factorize_equilibrium),
// for the masses of the set: subspace iteration (Bathe, Wilson 1972) with a Rayleigh-Ritz step, until `residual` <=
// tolerance or 60 iterations are done, whichever comes first; look at the residual. Cost: an iteration solves for count + 8
// right-hand sides, or twice as many as count. Deterministic.
LinearModes linear_modes(const NewtonSolver& solver, Eigen::Index count, double tolerance = 1e-6);

struct BarbicOptions {
    int mode_count = 4;         // linear modes per pose
    Eigen::Index dimension = 0; // 0: whatever mode_count gives; else the fewest modes that reach it, cut to it
    Eigen::Index max_dimension = 256;
};

// Differences x_k - x_0; for every pair of poses the tangent of the curve of averages at x_k; for every pose its linear
// modes. One factorisation per pose.
Subspace build_barbic_subspace(NewtonSolver& solver, const BarbicOptions& options, Progress* progress);

} // namespace pliant
