// The contact sheet: the poses, and blends of them, linear beside elastic.
#pragma once

#include "blend/asset_file.h"
#include "run/options.h"

namespace pliant::player {

// Writes options.sheet; needs no display. If it throws Error, no file was changed.
void write_sheet(const Options& options, const AssetFile& file);

} // namespace pliant::player
