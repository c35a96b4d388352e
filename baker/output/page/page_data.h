// What a page shows of an asset.
#pragma once

#include "base/common/diagnostics.h"
#include "output/page/render.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant {

// A circle on a picture around something that a warning names.
struct PageMark {
    float x = 0, y = 0;     // pixels
    bool is_visible = true; // else it lies behind the shape: dashed
    std::string label;      // "vertex 3050"
};

struct PagePicture {
    Image image;
    std::string title, note; // note may be empty
    std::vector<PageMark> marks;
};

// The same weights twice.
struct PageBlend {
    std::string title;
    PagePicture linear, elastic;
    std::optional<PagePicture> difference; // coloured by distance
    double distance = 0;                   // of the vertex that is farthest apart in the two, over the diagonal
};

// A layer, and the weights that the bake measured.
struct PageLayer {
    std::string name;
    double low = 0, high = 1, initial = 0;
};

struct PageColumn {
    double amplitude = 0; // no vertex moves further by it, over the diagonal
    double bits = 32;     // a number, in the mean
};

struct PageChunk {
    std::string tag;
    std::uint64_t size = 0;
};

struct PageStage {
    std::string name;
    double seconds = 0;
};

struct PageWarning {
    Diagnostic diagnostic;
    std::optional<PagePicture> picture; // of the elements that it names
};

struct PageData {
    std::string name; // of the asset's file
    std::string format;
    std::vector<std::string> poses;
    std::vector<PageLayer> layers; // of an asset of layers, one for each pose after pose 0; else empty
    std::uint64_t vertices = 0, triangles = 0, file_size = 0, frame_bytes = 0, solver_memory = 0;
    std::size_t dimension = 0;
    bool is_compact = false;
    double bytes_per_number = 0;

    std::vector<PagePicture> pose_pictures;
    std::optional<PageBlend> centre; // all poses in equal parts; of layers the worst mixture
    std::vector<PageBlend> edges;    // the largest difference first
    std::size_t edge_count = 0;      // before any were left out
    std::size_t pose_count = 0;
    std::string view; // "three-quarter view, y upwards"

    std::vector<PageColumn> columns;
    bool has_stored_amplitudes = false; // else measured on the blends that were drawn or checked
    std::vector<PageChunk> chunks;
    std::string certificate; // JSON text, maybe of a stranger: what is not as it should be is left out

    // From the report of the bake.
    bool has_report = false;
    std::vector<PageStage> stages;
    std::vector<PageWarning> warnings;
};

} // namespace pliant
