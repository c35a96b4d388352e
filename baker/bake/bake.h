// The baker's pipeline: poses in, asset out. Each stage returns its result by value, with its part of the report.
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

// Bakes. Throws Failure, or Interrupted through progress. Cost for some 15,000 vertices and 5 poses: 3 to 15 minutes
// with the adaptive subspace (tests/bench/README.md), about one with krylov. Whether a missed tolerance is a failure is
// decided by the caller (find_miss in warnings.h).
BakedAsset bake(const PoseSet& poses, const BakeOptions& options, Progress& progress);

} // namespace pliant
