// PNG files, whole or not at all.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace pliant::player {

// Writes width x height RGB pixels, top row first, under a temporary name beside `path`, then renames it. Throws Error; then
// nothing has changed at `path`.
void write_png(const std::string& path, int width, int height, const std::vector<std::uint8_t>& pixels);

// STEM_001SUFFIX, or the first higher number at which nothing exists.
std::string unused_path(const std::string& stem, const std::string& suffix);

} // namespace pliant::player
