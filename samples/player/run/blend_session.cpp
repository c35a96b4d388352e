#include "run/blend_session.h"

#include "panels/hud_heat.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace pliant::player {

std::optional<Truth> truth_for(const Options& options, const AssetFile& file)
{
    if (options.truth_weights.empty()) return std::nullopt;
    return Truth(options.truth_weights, options.truth_pattern, file);
}

Show first_show(const Options& options)
{
    if (options.both) return Show::both;
    if (options.linear) return Show::linear;
    return options.truth_weights.empty() ? Show::elastic : Show::three;
}

BlendSession::BlendSession(const Options& options, AssetFile file, Quality quality)
    : file_(std::move(file))
    , truth_(truth_for(options, file_))
    , stage_(options, file_, truth_ ? &*truth_ : nullptr, quality)
    , playback_(stage_.polygon(), weights_for(options, file_), !options.has_weights(), path_for(options, file_), options.fps)
    , show_(first_show(options))
    , heat_(options.heat)
    , has_lines_(!options.path.empty())
{
}

void BlendSession::read_keys()
{
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
    if (pressed(GLFW_KEY_L)) show_ = show_ == Show::linear ? Show::elastic : Show::linear;
    if (pressed(GLFW_KEY_B)) show_ = show_ == Show::both ? Show::elastic : Show::both;
    if (pressed(GLFW_KEY_T) && truth_) show_ = show_ == Show::three ? Show::elastic : Show::three;
    if (pressed(GLFW_KEY_E)) heat_ = !heat_;
    if (pressed(GLFW_KEY_SPACE)) playback_.toggle_play();
    if (pressed(GLFW_KEY_S)) sliders_.toggle();
    if (pressed(GLFW_KEY_0)) reset_weights();
    if (file_.has_layers()) return;
    for (std::uint32_t k = 0; k < std::min(stage_.polygon().corner_count(), 9u); ++k)
        if (pressed(GLFW_KEY_1 + static_cast<int>(k))) playback_.go_to(k);
}

void BlendSession::set_weight(std::uint32_t which, double value)
{
    std::vector<double> weights = playback_.weights();
    if (file_.has_layers())
        weights[which] = value;
    else
        set_share(weights, which, value);
    playback_.show(weights);
}

void BlendSession::reset_weights()
{
    std::vector<double> weights;
    for (const WeightRange& range : file_.weights()) weights.push_back(range.initial);
    playback_.show(weights);
}

void BlendSession::draw_scene(const Canvas& canvas, const Area& area, const Area& free, float scale)
{
    history_.add(stage_.blend(playback_.weights(), show_, heat_).cost);
    stage_.draw(canvas, area, free, scale);
}

void BlendSession::draw_panels(const Overlay& overlay, int width, int height, bool with_help)
{
    const HudModel model { file_,
                           stage_.polygon(),
                           stage_.shown(),
                           stage_.truth(),
                           playback_.weights(),
                           playback_.point(),
                           has_lines_ ? playback_.path_frame() : std::nullopt,
                           has_lines_ ? playback_.path_count() : 0,
                           with_help,
                           stage_.has_paint(),
                           history_.median(&BlendCost::solve_us),
                           history_.median(&BlendCost::reconstruct_us),
                           history_.median(&BlendCost::normals_us) };
    const HudActions actions = draw_hud(overlay, model, sliders_, width, height);
    const Area free = free_area(overlay.scale(), width, height);
    std::vector<glm::vec2> places = stage_.caption_places();
    for (glm::vec2& place : places) place *= glm::vec2(width, height);
    draw_side_captions(overlay, stage_.shown(), free, places);
    draw_heat_legend(overlay, stage_.shown(), free);
    if (actions.show) show_ = *actions.show;
    if (actions.drag_to) playback_.drag_to(*actions.drag_to);
    if (actions.go_to) playback_.go_to(*actions.go_to);
    for (const auto& [which, value] : actions.sliders.weights) set_weight(which, value);
    if (actions.sliders.reset_all) reset_weights();
}

} // namespace pliant::player
