// Weights to train and to check with, the same for the same seed.
#pragma once

#include "base/common/random.h"
#include "base/weights/weights.h"

#include <vector>

namespace pliant {

// A point of the simplex: Dirichlet with parameter 1 (uniform), or, with `skew`, uniform numbers cubed and normalized, which
// gathers near edges and corners.
Weights random_weights(Random& random, std::size_t count, bool skew);

// One of a mixed bag, by index modulo 3: uniform on the simplex, of more than few_poses on a random face of three to
// sparse_limit of them; on a random edge (between a tenth and nine tenths of it); near edges and corners.
Weights mixed_weights(Random& random, std::size_t pose_count, std::size_t index);

// `count` weights spread over the simplex, the equal ones first, denser near edges and corners, where averages change
// fastest; the first ones alone are spread, too. For two poses evenly spaced. No corners: poses are reproduced anyway.
std::vector<Weights> training_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed);

// `count` weights of a mixed bag (mixed_weights).
std::vector<Weights> draw_weights(std::uint64_t seed, std::size_t pose_count, int count);

// Weights that cover the simplex of `pose_count` poses: the poses, the equal ones, then `count` of a mixed bag (inside, on
// edges, near edges and corners). The same for the same seed.
std::vector<std::vector<float>> covering_weights(std::size_t pose_count, std::size_t count, std::uint64_t seed);

} // namespace pliant
