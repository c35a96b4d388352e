#include "run/crowd_session.h"

#include "panels/hud_crowd.h"
#include "run/blend_session.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cmath>

namespace pliant::player {

CrowdSession::CrowdSession(const Options& options, AssetFile file, Quality quality, const GlContext& context)
    : file_(std::move(file))
    , stage_(options, file_, quality, context)
    , mode_(options.linear ? BlendMode::linear : BlendMode::elastic)
{
}

void CrowdSession::advance(double seconds)
{
    if (plays_) phase_ = std::fmod(phase_ + seconds / stage_.loop_seconds(), 1.0);
}

void CrowdSession::read_keys()
{
    const auto pressed = [](int key) { return ImGui::IsKeyPressed(key, false); };
    if (pressed(GLFW_KEY_L)) mode_ = mode_ == BlendMode::linear ? BlendMode::elastic : BlendMode::linear;
    if (pressed(GLFW_KEY_G)) stage_.rebuild_on_gpu(!stage_.rebuilds_on_gpu());
    if (pressed(GLFW_KEY_SPACE)) plays_ = !plays_;
}

void CrowdSession::draw_scene(const Canvas& canvas, const Area& area, const Area& free, float)
{
    stage_.blend(phase_, mode_);
    stage_.draw(canvas, area, free);
}

void CrowdSession::draw_panels(const Overlay& overlay, int width, int height, bool with_help)
{
    draw_crowd_hud(overlay,
                   { file_, stage_.crowd(), stage_.times(), stage_.cost(), stage_.rebuilder(), stage_.rebuilds_on_gpu(),
                     mode_, with_help, stage_.has_paint() },
                   width, height);
}

std::unique_ptr<Session> open_session(const Options& options, AssetFile file, Quality quality, const GlContext& context)
{
    if (options.crowd > 0) return std::make_unique<CrowdSession>(options, std::move(file), quality, context);
    return std::make_unique<BlendSession>(options, std::move(file), quality);
}

} // namespace pliant::player
