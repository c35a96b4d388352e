// A subspace of snapshots of layers, or of the averages of many poses.
#pragma once

#include "elastic/average/corrected_family.h"
#include "reduced/subspace/adaptive.h"

namespace pliant {

// Mixtures to train with, in random order. Of layers each one alone, pairs and triples that move the same vertices, random
// sparse and dense ones; layers that move different vertices add up linearly and need no training. Of averages a mixed bag.
std::vector<Weights> training_mixtures(const NormalizedPoses& set, const WeightDomain& domain, std::uint64_t seed);

// Shapes that are found at most, for so many weights.
std::size_t mixture_count(std::size_t weight_count);

// Differences of the poses are kept exactly; the other directions are those by which the shapes of mixtures differ from
// linear sums. Two of three mixtures are those of the highest score: the energy of their linear sum is high, and no
// known mixture is near. The others are unbiased: a wave is the last one if these lie in the span of all shapes before them,
// to a part of the tolerance.
FoundSubspace build_mixture_subspace(CorrectedFamily& known, const WeightDomain& domain,
                                     const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                     Progress* progress);

} // namespace pliant
