// The panel of sliders: one for each layer of the asset.
#pragma once

#include "blend/asset_file.h"
#include "panels/overlay.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace pliant::player {

// The text in the search field, which panels of many layers have. Lives as long as the session.
struct SliderSearch {
    std::array<char, 64> text {};
};

// References must outlive the call of draw_sliders().
struct SliderModel {
    const std::vector<LayerWeight>& layers;
    const std::vector<double>& weights;
    const std::vector<double>* truth = nullptr; // if set, the weights that are shown instead; they have rings
};

struct SliderActions {
    std::vector<std::pair<std::uint32_t, double>> weights; // of layers that the user moved or reset
    bool reset_all = false;
};

// A slider reaches half a range beyond both ends of its layer's range. The panel is at the bottom left, between the height
// `top` and the end of the window, `bottom`.
SliderActions draw_sliders(const Overlay& overlay, const SliderModel& model, SliderSearch& search, float top, float bottom);

} // namespace pliant::player
