// Pictures without a window.
#pragma once

#include "options.h"

namespace pliant::player {

// One blend, as options say. Throws Error; then no file has appeared or changed.
void write_screenshot(const Options& options, const AssetFile& file);

// All poses on top; below, for the middle of each edge of the control polygon (five at most) and its centre, the linear blend
// beside the elastic one.
void write_sheet(const Options& options, const AssetFile& file);

} // namespace pliant::player
