// The contents of a window for one file: everything in the window that depends on the file.
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

// Its GL context must be current for its lifetime.
class Session {
public:
    virtual ~Session() = default;

    // Advances the animation by a time step.
    virtual void advance(double seconds) = 0;
    // Handles the keys that ImGui received in this frame.
    virtual void read_keys() = 0;
    // Blends and draws the scene. area: the whole canvas. free: the part in whose centre the characters stand. scale: pixels
    // per pixel of the design.
    virtual void draw_scene(const Canvas& canvas, const Area& area, const Area& free, float scale) = 0;
    // The space that the characters take now, for the camera.
    virtual Extent extent_shown() const = 0;
    // Draws panels and captions, and handles input in them. width, height: of the window, in ImGui's units.
    virtual void draw_panels(const Overlay& overlay, int width, int height, bool with_help) = 0;
    virtual Camera& camera() = 0;
    virtual Scene& scene() = 0;
    virtual const AssetFile& file() const = 0;
};

// A session for one character or a crowd, depending on the options. Throws Error.
std::unique_ptr<Session> open_session(const Options& options, AssetFile file, Quality quality, const GlContext& context);

} // namespace pliant::player
