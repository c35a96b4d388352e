// Single pictures and sequences of them, with or without a display.
#pragma once

#include "blend/asset_file.h"
#include "run/options.h"

namespace pliant::player {

// Writes options.screenshot: a blend or, with options.crowd, a crowd. If it throws Error, no file was changed.
void write_screenshot(const Options& options, const AssetFile& file);

// Writes the pictures of options.sequence along the path, one after the other, each completely or not at all. Reports
// progress on standard error. If it throws Error, the pictures already written stay.
void write_sequence(const Options& options, const AssetFile& file);

} // namespace pliant::player
