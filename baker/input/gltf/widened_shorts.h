// Positions that were rounded to fewer bits than the normalized shorts that hold them.
#pragma once

#include "input/gltf/primitive.h"

namespace pliant {

// Programs round positions to 14 bits, say, and fill the lowest bits of shorts with the highest again (gltf-transform):
// their grid is coarser than a unit. Sets position_step of primitives whose numbers all have that pattern, where enough of
// them have it for chance to be no explanation: of all primitives of a file together, else of each alone.
void find_widened_shorts(const std::vector<GltfPrimitive*>& primitives);

} // namespace pliant
