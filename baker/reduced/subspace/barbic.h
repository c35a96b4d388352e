// The subspace of Barbic, da Silva, Popovic 2009 ("Deformable object animation using reduced optimal control"), with which
// von Tycowicz et al. 2015 compare in Table II. For comparison only.
#pragma once

#include "elastic/average/newton.h"
#include "reduced/subspace/subspace.h"

namespace pliant {

// Vibrations of a shape: K x = lambda M x, lambda > 0, the softest first.
struct LinearModes {
    Eigen::MatrixXd vectors;     // 3n x count, mass-orthonormal, mass-orthogonal to the rigid motions of the shape
    Eigen::VectorXd eigenvalues; // ascending
    double residual = 0;         // largest |K x - lambda M x| over lambda |M x|, in the norm of M^-1
    int iterations = 0;
};

// The `count` softest modes of the pose (or average) at which `solver` is factored (NewtonSolver::factorize_equilibrium),
// for the masses of the set: subspace iteration (Bathe, Wilson 1972) with a Rayleigh-Ritz step, until `residual` <=
// tolerance or 60 iterations are done, whichever comes first; look at the residual. Cost: an iteration solves for count + 8
// right-hand sides, or twice as many as count. Deterministic.
LinearModes linear_modes(const NewtonSolver& solver, Eigen::Index count, double tolerance = 1e-6);

// How modes change along each other (Barbic, James 2005): -K^-1 (DK . x_i) x_j, one column (3n) for each pair i <= j, in the
// order 00, 01, 11, 02, ... `solver` is factored at pose `k`, whose modes these are. DK is that of W_k, found by differences
// of its gradient.
Eigen::MatrixXd modal_derivatives(const NewtonSolver& solver, std::size_t k, const Eigen::MatrixXd& modes);

struct BarbicOptions {
    int mode_count = 4;         // linear modes of pose 0; their derivatives come with them
    Eigen::Index dimension = 0; // 0: whatever mode_count gives; else cut to it, with as many modes as it takes
    Eigen::Index max_dimension = 256;
};

// One object, whose energy is that of pose 0, and deformation curves that pass through the poses: the statics of pose 0
// under the loads F_0(x_k) that hold it at x_k. Spans the differences x_k - x_0; for every other pose k the tangents of its
// curve at both ends, K_0(x_k) t = F_0(x_k) and K_0(x_0) t = F_0(x_k); linear modes of pose 0 and their derivatives. Pose k
// is no equilibrium of W_0: where K_0(x_k) is indefinite, its projection takes its place. One factorisation per pose.
Subspace build_barbic_subspace(NewtonSolver& solver, const BarbicOptions& options, Progress* progress);

} // namespace pliant
