// What a bake would cost, from counts alone.
#pragma once

#include "bake/options.h"

namespace pliant {

// How many averages a bake of so many poses is trained with.
std::size_t training_count(std::size_t pose_count);

// Newton's method of a bake stops after so many iterations.
constexpr int iteration_limit = 15;

// A bound of the factorisations in a bake of a surface with the adaptive subspace, twenty to sixty times their usual
// number. Not counted: the calibration of ties, and repeated attempts at a nearly singular Hessian.
int factorization_limit(std::size_t pose_count, const BakeOptions& options);

// Dimension, seconds on one core, bytes of working memory, bytes of the asset: orders of magnitude.
struct BakeEstimate {
    Eigen::Index dimension;
    double seconds;
    double memory;
    double asset_size;
};
BakeEstimate estimate_bake(const PoseSet& poses, const BakeOptions& options);

} // namespace pliant
