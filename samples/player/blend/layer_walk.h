// Weights of layers that show what an asset can do: the layers one by one, then mixtures of a few of them.
#pragma once

#include "blend/asset_file.h"
#include "blend/weight_path.h"

#include <vector>

namespace pliant::player {

// Random mixtures of two to four layers (of all, if there are fewer) at weights well inside their ranges, away from the
// initial weights, which the others have. The same on every call.
std::vector<std::vector<double>> layer_mixtures(const std::vector<WeightRange>& layers);

// The high and the low end of each layer's range, and the initial weights after them; at last the mixtures.
std::vector<std::vector<double>> layer_keys(const std::vector<WeightRange>& layers);

// A closed path from the initial weights through all keys, which it reaches and leaves slowly. For 30 rows per second.
WeightPath layer_walk(const std::vector<WeightRange>& layers);

} // namespace pliant::player
