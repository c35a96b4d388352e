// What a bake would cost, from counts alone.
#pragma once

#include "bake/options.h"

namespace pliant {

// How many averages a bake of so many poses is trained with.
std::size_t training_count(std::size_t pose_count);

// Factorisations that a bake of a surface with the adaptive subspace never exceeds, besides the calibration of ties: some
// ten times their usual number.
int factorization_limit(std::size_t pose_count, const BakeOptions& options);

// Dimension, seconds on one core, bytes of working memory, bytes of the asset: orders of magnitude.
struct BakeEstimate {
    Eigen::Index dimension;
    double seconds;
    double memory;
    double asset_size;
};
BakeEstimate estimate_bake(std::size_t vertex_count, std::size_t pose_count, const BakeOptions& options);

} // namespace pliant
