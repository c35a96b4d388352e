// Blends of an asset next to unreduced averages at fresh weights: what `pliant measure` prints.
#pragma once

#include "bake/options.h"
#include "base/common/progress.h"
#include "base/mesh/pose_set.h"
#include "elastic/average/shape_error.h"
#include "output/asset/runtime_blender.h"

#include <cstdint>
#include <string>
#include <vector>

namespace pliant {

struct MeasureOptions {
    int sample_count = 10;
    std::uint64_t seed = 2;
    // Look for each average from the blend only, and by continuation where that is far: quicker, but another branch nearer
    // than that is not seen.
    bool from_blend = false;
};

// One blend.
struct Measurement {
    std::string kind; // uniform, edge, corner; of layers single, pair, sparse, dense, corner
    Weights weights;
    ShapeError error,
        linear; // of the blend, of the linear blend; the energies are NaN where the asset draws a surface of its own
    double nearest_error = 0; // relative L2, to the average next to the blend
    pliant_solve_info info {};
    double microseconds = 0;      // median of cold solves
    bool has_converged = false;   // the unreduced average
    std::size_t branch_count = 0; // jumps on the way, other averages for these weights
};

// `asset_path` is for messages, `energy` what the asset's certificate says (read_energy_options). `surface`: what the asset
// draws in the place of its solid's boundary; null: nothing. Throws Failure (bad_input, P5104) for other poses than those of
// the asset. Cost: an average for each weight.
std::vector<Measurement> measure(RuntimeBlender& blender, const std::string& asset_path, const PoseSet& poses,
                                 const EnergyOptions& energy, const RenderMesh* surface, const MeasureOptions& options,
                                 Progress& progress);

// The middle one of the values; 0 without any.
double median(std::vector<double> values);

} // namespace pliant
