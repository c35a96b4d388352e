// A crowd with camera and scene, for windows and pictures with --crowd.
#pragma once

#include "blend/control_polygon.h"
#include "blend/crowd.h"
#include "blend/frame_times.h"
#include "draw/camera.h"
#include "draw/gl_context.h"
#include "draw/gpu_crowd.h"
#include "draw/scene.h"
#include "run/options.h"

#include <memory>

namespace pliant::player {

// Needs a current GL context. File and context must outlive the stage.
class CrowdStage {
public:
    // Throws Error. With Rebuild::automatic, pliant::gl reconstructs the shapes, unless the driver renders on the
    // processor or cannot do it; in the latter case a line on standard error says so.
    CrowdStage(const Options& options, const AssetFile& file, Quality quality, const GlContext& context);

    // One frame: blend() blends all characters at a phase of their loops; draw() draws them into a part of the canvas, in
    // the centre of `free`, waits for completion, and adds the frame's times to times().
    void blend(double phase, BlendMode mode);
    void draw(const Canvas& canvas, const Area& area, const Area& free);

    bool has_paint() const { return scene_.has_paint(); }

    // Chooses between pliant::gl and the processor. If the driver cannot reconstruct shapes, returns false, prints a line on
    // standard error, and the processor continues.
    bool rebuild_on_gpu(bool on);
    bool rebuilds_on_gpu() const { return on_gpu_; }
    const char* rebuilder() const { return on_gpu_ ? gpu_->path_name() : "processor"; }

    double loop_seconds() const { return loop_seconds_; }
    Camera& camera() { return camera_; }
    Scene& scene() { return scene_; }
    // Of all poses, at the places of all characters.
    Extent extent_shown() const { return extent_of_crowd(one_, places_); }
    const Crowd& crowd() const { return crowd_; }
    const FrameTimes& times() const { return times_; }
    const CrowdCost& cost() const { return cost_; } // of the last frame

private:
    void make_gpu();

    const AssetFile& file_;
    const GlContext& context_;
    glm::mat3 to_world_;
    ControlPolygon polygon_;
    std::optional<WeightPath> path_;
    double loop_seconds_;
    Crowd crowd_;
    Extent one_;
    std::vector<glm::vec3> places_;
    Camera camera_;
    Scene scene_;
    std::unique_ptr<GpuCrowd> gpu_; // created on first use, then kept
    bool on_gpu_ = false;
    FrameTimes times_;
    CrowdCost cost_;
    BlendMode mode_ = BlendMode::elastic;
};

} // namespace pliant::player
