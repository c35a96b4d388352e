// What window and pictures share: characters for the blends to show, camera and scene for them.
#pragma once

#include "blend/control_polygon.h"
#include "blend/truth.h"
#include "draw/camera.h"
#include "draw/scene.h"
#include "panels/shown.h"
#include "run/options.h"

namespace pliant::player {

// Needs a current GL context.
class Stage {
public:
    // truth: may be null; with it all characters are shown at its weights alone. File and truth must outlive the stage.
    Stage(const Options& options, const AssetFile& file, const Truth* truth, Quality quality);

    // Blends what is shown. heat: colours by distance.
    const Shown& blend(const std::vector<double>& weights, Show show, bool heat = false);
    const Shown& shown() const { return shown_; }

    // Draws what was blended last into a part of the canvas, its characters in the middle of `free`.
    void draw(const Canvas& canvas, const Area& area, const Area& free);
    // Draws the linear blend in a neutral colour: for single poses, where the two blends are one.
    void draw_pose(const Canvas& canvas, const Area& area);

    // The next elastic blend starts afresh: for jumps.
    void forget() { elastic_.forget(); }

    bool has_paint() const { return scene_.has_paint(); }
    void show_paint(bool shown) { scene_.show_paint(shown); }

    Camera& camera() { return camera_; }
    const ControlPolygon& polygon() const { return polygon_; }
    const Truth* truth() const { return truth_; }

private:
    void colour_by_distance();
    Actor actor(Kind kind, glm::vec3 offset) const;

    const Truth* truth_;
    Character elastic_;
    Character linear_;
    Character unreduced_;
    Extent extent_;
    float diagonal_; // of the first pose, in the asset's units
    Camera camera_;
    Scene scene_;
    ControlPolygon polygon_;
    Shown shown_;
    std::vector<float> heat_;
};

} // namespace pliant::player
