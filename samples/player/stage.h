// What window and pictures share: characters for the blends to show, camera and scene for them.
#pragma once

#include "camera.h"
#include "control_polygon.h"
#include "hud.h"
#include "options.h"
#include "scene.h"

namespace pliant::player {

// Needs a current GL context.
class Stage {
public:
    Stage(const Options& options, const AssetFile& file, Quality quality);

    // Blends what is shown. Returns the cost of the elastic blend if there is one, else of the linear one.
    BlendCost blend(const std::vector<double>& weights, Show show);

    // Draws what was blended last into a part of the canvas, its characters in the middle of `free`.
    void draw(const Canvas& canvas, const Area& area, const Area& free);
    // Draws the linear blend in a neutral colour: for single poses, where the two blends are one.
    void draw_pose(const Canvas& canvas, const Area& area);

    // The next elastic blend starts afresh: for jumps.
    void forget() { elastic_.forget(); }

    Camera& camera() { return camera_; }
    const ControlPolygon& polygon() const { return polygon_; }

private:
    glm::vec3 beside() const;

    Character elastic_;
    Character linear_;
    Extent extent_;
    Camera camera_;
    Scene scene_;
    ControlPolygon polygon_;
    Show show_ = Show::elastic;
};

} // namespace pliant::player
