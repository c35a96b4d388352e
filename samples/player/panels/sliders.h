// The panel of sliders: one for each weight, of layers or of poses.
#pragma once

#include "blend/asset_file.h"
#include "panels/overlay.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace pliant::player {

// What the panel remembers from frame to frame. Lives as long as the session.
struct SliderState {
    std::array<char, 64> search {};     // the text in the search field, which panels of many weights have
    std::optional<std::uint32_t> typed; // the weight that has a field to type a number
    std::array<char, 32> number {};     // the text in that field
    bool wants_focus = false;
    std::optional<bool> open; // unset in the first frames: then the list is open if there is room
    bool was_open = true;     // in the last frame

    void toggle() { open = !was_open; }
};

// References must outlive the call of draw_sliders().
struct SliderModel {
    const std::vector<WeightRange>& ranges;
    const std::vector<double>& weights;
    const std::vector<double>* truth = nullptr; // if set, the weights that are shown instead; they have rings
    bool of_layers = false;                     // sliders reach half a range beyond both ends
};

struct SliderActions {
    std::vector<std::pair<std::uint32_t, double>> weights; // that the user moved, typed or reset
    bool reset_all = false;
};

// The panel stands at the left, between the heights `top` and `bottom`, at the lower end. Its list scrolls if the room is
// too small, and can be closed; if there is no room even for its head, it is shown only when it is opened by its key.
SliderActions draw_sliders(const Overlay& overlay, const SliderModel& model, SliderState& state, float top, float bottom);

} // namespace pliant::player
