// Measures blends without drawing.
#pragma once

#include "run/options.h"

namespace pliant::player {

// Blends options.benchmark_frames times along one round of the given path or the idle path, and prints medians to
// standard output, as text or JSON.
void run_benchmark(const Options& options, const AssetFile& file);

} // namespace pliant::player
