// Serialises an asset (formats/SPEC.md).
#pragma once

#include "output/asset/asset_model.h"

namespace pliant {

// The bytes of the asset. Throws std::invalid_argument for a load whose
// centres are not the predictor's, and for smoothing groups that are not one number below the vertex count for each vertex.
std::vector<std::uint8_t> encode_asset(const AssetModel& asset, const AssetRecord& record);

} // namespace pliant
