// A subspace of snapshots of layers.
#pragma once

#include "elastic/average/layered_family.h"
#include "reduced/subspace/adaptive.h"

namespace pliant {

// Mixtures to train with, in random order: each layer alone, pairs and triples of layers that move the same vertices, random
// sparse and dense mixtures. Layers that move different vertices add up linearly and need no training.
std::vector<Weights> layer_mixtures(const NormalizedPoses& set, const WeightDomain& domain, std::uint64_t seed);

// Differences of the poses are kept exactly; the other directions are those by which the shapes of mixtures differ from
// linear sums. Two of three mixtures are those of the highest score: the energy of their linear sum is high, and no
// known mixture is near. The others are unbiased: a wave is the last one if these lie in the span of all shapes before them,
// to a part of the tolerance.
FoundSubspace build_layered_subspace(LayeredFamily& known, const WeightDomain& domain,
                                     const std::vector<Weights>& check_weights, const AdaptiveOptions& options,
                                     Progress* progress);

} // namespace pliant
