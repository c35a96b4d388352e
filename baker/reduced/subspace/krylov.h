// The subspace of von Tycowicz, Schulz, Seidel, Hildebrandt 2015, Algorithm 1.
#pragma once

#include "elastic/average/newton.h"
#include "reduced/subspace/subspace.h"

namespace pliant {

// What the Krylov sequences start from. The paper takes tangents, and says that differences can be taken, too.
enum class KrylovStart { tangents, differences };

struct KrylovOptions {
    int ritz_count = 2;         // Krylov-Ritz vectors per start vector
    Eigen::Index dimension = 0; // 0: whatever ritz_count gives; else the fewest Ritz vectors that reach it, cut to it
    Eigen::Index max_dimension = 256;
    KrylovStart start = KrylovStart::tangents;
};

// For every pair of poses: the difference x_j - x_k; the tangent of the curve of averages at x_k, K_k w = grad W_j(x_k); and
// from each tangent ritz_count vectors of the Krylov space of K_k^-1 M_k. From differences: no tangents, and the Krylov
// space of each x_j - x_k. One factorisation per pose. K_k is singular by the rigid motions of the pose, which are kept out
// of loads and solutions.
Subspace build_krylov_subspace(NewtonSolver& solver, const KrylovOptions& options, Progress* progress);

} // namespace pliant
