// How an asset is exported, and what came of it.
#pragma once

#include "output/export/normals.h"

#include <string>
#include <vector>

namespace pliant {

struct ExportOptions {
    bool with_morph_targets = true;
    int bone_count = 0;            // above 0: a skin of so many bones instead of morph targets
    bool with_asset = false;       // embedded
    double quantisation_error = 0; // above 0: whole numbers, positions within it of the diagonal
    bool with_compression = false; // of all accessors, by meshoptimizer
    bool with_normals = true;
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
    NormalError normal_error;
    double position_error = 0;                // of whole numbers, at the vertices, of the diagonal
    double table_mean = 0, table_largest = 0; // of the table of weights, likewise
    std::size_t centre_count = 0;
    std::size_t bone_count = 0;
    double skin_rms = 0, skin_largest = 0; // over the diagonal, at fresh weights and in the animation
};

} // namespace pliant
