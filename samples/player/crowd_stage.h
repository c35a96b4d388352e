// A crowd with camera and scene: what window and pictures show with --crowd.
#pragma once

#include "camera.h"
#include "control_polygon.h"
#include "crowd.h"
#include "frame_times.h"
#include "options.h"
#include "scene.h"

namespace pliant::player {

// Needs a current GL context. The file must outlive the stage.
class CrowdStage {
public:
    CrowdStage(const Options& options, const AssetFile& file, Quality quality);

    // One frame: blends all characters at a phase of their loops, then draws them into a part of the canvas, in the middle of `free`,
    // waits until that is done, and adds the frame's times.
    void blend(double phase, BlendMode mode);
    void draw(const Canvas& canvas, const Area& area, const Area& free);

    bool has_paint() const { return scene_.has_paint(); }
    void show_paint(bool shown) { scene_.show_paint(shown); }

    double loop_seconds() const { return loop_seconds_; }
    Camera& camera() { return camera_; }
    const Crowd& crowd() const { return crowd_; }
    const FrameTimes& times() const { return times_; }
    const CrowdCost& cost() const { return cost_; } // of the last frame

private:
    ControlPolygon polygon_;
    std::optional<WeightPath> path_;
    double loop_seconds_;
    Crowd crowd_;
    Extent one_;
    std::vector<glm::vec3> places_;
    Camera camera_;
    Scene scene_;
    FrameTimes times_;
    CrowdCost cost_;
    BlendMode mode_ = BlendMode::elastic;
};

} // namespace pliant::player
