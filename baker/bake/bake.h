// The baker's pipeline: poses in, asset out. Each stage takes values and returns its result and its part of the report by
// value.
#pragma once

#include "bake/options.h"
#include "bake/report.h"

#include <cstdint>
#include <vector>

namespace pliant {

struct BakedAsset {
    std::vector<std::uint8_t> bytes;
    BakeReport report;
};

// Bakes. Throws Failure, or Interrupted through progress. Cost for some 15,000 vertices and 5 poses: minutes with the
// adaptive subspace (4 to 8 measured, tests/bench/README.md), about one with krylov.
BakedAsset bake(const PoseSet& poses, const BakeOptions& options, Progress& progress);

} // namespace pliant
