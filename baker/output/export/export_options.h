// How an asset is exported, and what came of it.
#pragma once

#include "output/export/normals.h"

#include <string>
#include <vector>

namespace pliant {

struct ExportOptions {
    bool with_morph_targets = true;
    int bone_count = 0;                   // above 0: a skin of so many bones instead of morph targets
    bool with_asset = false;              // embedded
    bool with_compression = false;        // of positions, normals and triangles, by Draco
    std::string name = "character";       // of mesh and node
    std::string source;                   // the asset's file, for messages
    std::vector<std::vector<float>> path; // weights of the animation, one row a frame; none: no animation
    double frames_per_second = 30;
};

struct ExportReport {
    std::size_t vertex_count = 0, triangle_count = 0, target_count = 0, frame_count = 0;
    std::size_t part_count = 0, image_count = 0; // of the asset's scene; one part without
    double diagonal = 0;                         // of the reachable set, input units
    bool has_stored_ranges = false;              // with morph targets
    bool box_covers = true;                      // the box that engines compute from the accessors holds all shapes
    NormalError normal_error;
    std::size_t bone_count = 0;
    double compression_error = 0;          // of a coordinate, input units
    double skin_rms = 0, skin_largest = 0; // over the diagonal, at fresh weights and in the animation
};

} // namespace pliant
