// Weights of a blend: one number per pose, none negative, with the sum 1; of layers one number per layer, any.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace pliant {

using Weights = Eigen::VectorXd; // one per pose, or one per layer

// A mixture of at most so many poses, or layers, is sparse.
constexpr std::size_t sparse_limit = 6;

// More poses than this are seldom blended all at once: there is no point in filling their simplex.
constexpr std::size_t few_poses = 12;

// Unit weight vector e_k of length m, and equal weights.
Weights corner_weights(std::size_t pose_count, std::size_t pose);
Weights equal_weights(std::size_t pose_count);

// How much each of `pose_count` poses counts in the linear blend, with the sum 1: w itself, or of layers (1 - sum v, v).
Weights linear_shares(const Weights& w, std::size_t pose_count);

// "0.25,0.75": for messages.
std::string weights_text(const Weights& w);

// Of few poses weights_text(); of layers, and of many poses, those that are not zero, by their names: "smile=1,blink=0.5".
// Of more than six the largest: "smile=1,blink=0.9,... and 46 smaller ones".
std::string blend_text(const Weights& w, const std::vector<std::string>& pose_names);

// Weights as people give them, checked and divided by their sum. Throws Failure (usage, P1203, P1204).
Weights normalized_weights(const std::vector<double>& values, std::size_t pose_count);

// Weights of layers as people give them, checked. Throws Failure (usage, P1203, P1204).
Weights layer_weights(const std::vector<double>& values, std::size_t layer_count);

} // namespace pliant
