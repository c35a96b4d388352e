// The window.
#pragma once

#include "blend/asset_file.h"
#include "run/options.h"

namespace pliant::player {

// Runs until the user quits. Throws Error if there is no display or no OpenGL 3.3.
void run_window(const Options& options, AssetFile file);

} // namespace pliant::player
