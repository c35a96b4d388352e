// One character in all kinds of blend, with camera and scene; shared by windows and pictures.
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
    // truth: may be null; if given, characters are shown only at its weights. File and truth must outlive the stage.
    Stage(const Options& options, const AssetFile& file, const Truth* truth, Quality quality);

    // Blends the kinds that `show` contains. heat: colours them by distance.
    const Shown& blend(const std::vector<double>& weights, Show show, bool heat = false);
    const Shown& shown() const { return shown_; }

    // Draws the last blend into a part of the canvas, with the characters in the centre of `free`. scale: pixels per pixel
    // of the design, for the room of captions.
    void draw(const Canvas& canvas, const Area& area, const Area& free, float scale);
    // The same without captions, all in one size if the distance is the same: the camera's for the largest.
    void draw_tile(const Canvas& canvas, const Area& area, float least_distance, bool neutral);

    // The space that the shapes of the last blend take.
    Extent extent_shown() const;
    void add_shown(ExtentOfShapes& all) const;
    // Where the captions of the characters are, as a share of the area of the last draw().
    const std::vector<glm::vec2>& caption_places() const { return caption_places_; }

    // Lets the next elastic blend start cold, after a jump in the weights.
    void forget() { elastic_.forget(); }

    bool has_paint() const { return scene_.has_paint(); }

    Camera& camera() { return camera_; }
    Scene& scene() { return scene_; }
    const ControlPolygon& polygon() const { return polygon_; }
    const Truth* truth() const { return truth_; }

private:
    void colour_by_distance();
    const Character& character(Kind kind) const;
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
    std::vector<glm::vec2> caption_places_;
};

} // namespace pliant::player
