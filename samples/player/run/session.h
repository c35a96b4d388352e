// What a window shows of one file. The window asks it for everything that depends on the file.
#pragma once

#include "draw/camera.h"
#include "draw/gl_context.h"
#include "draw/gl_objects.h"
#include "draw/scene.h"
#include "panels/overlay.h"
#include "run/options.h"

#include <memory>
#include <string>

namespace pliant::player {

// Needs its GL context to be current for as long as it lives.
class Session {
public:
    virtual ~Session() = default;

    // Moves on by so many seconds.
    virtual void advance(double seconds) = 0;
    // Looks at the keys that ImGui has seen in this frame.
    virtual void read_keys() = 0;
    // Blends and draws the scene: `area` is the whole canvas, the characters stand in the middle of `free`.
    virtual void draw_scene(const Canvas& canvas, const Area& area, const Area& free) = 0;
    // Draws panels and captions, and does what the user did with them. width, height: of the window in ImGui's units.
    virtual void draw_panels(const Overlay& overlay, int width, int height, bool with_help) = 0;
    virtual Camera& camera() = 0;
    virtual std::string title() const = 0;
};

// As one character or a crowd, with what else the options name. Throws Error.
std::unique_ptr<Session> open_session(const Options& options, AssetFile file, Quality quality, const GlContext& context);

} // namespace pliant::player
