#include "run/crowd_stage.h"

#include "blend/error.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include <algorithm>
#include <cstdio>

namespace pliant::player {
namespace {

// From higher up than a single character, so that the rows behind are visible.
constexpr float crowd_yaw = 14.0f, crowd_pitch = 30.0f;

Extent extent_of_one(const AssetFile& file, const glm::mat3& to_world)
{
    Character character(file, to_world);
    return extent_with_turns(extent_of_poses(character));
}

// A little more than the poses need, so that neighbours do not touch. Behind each row is room in which those of the next one
// can be seen.
glm::vec2 room_of(const Extent& one)
{
    const glm::vec3 size = one.highest - one.lowest;
    return { size.x * 0.84f, size.z * 0.74f + 0.6f * size.y };
}

// Lighter or darker than the colour of the blend, so that characters can be told apart.
glm::vec3 tint(glm::vec3 colour, float own) { return colour * glm::exp(own * glm::vec3(0.14f, 0.50f, 0.42f)); }

} // namespace

CrowdStage::CrowdStage(const Options& options, const AssetFile& file, Quality quality, const GlContext& context)
    : file_(file)
    , context_(context)
    , to_world_(options.to_world())
    , polygon_(file.view().pose_count)
    , path_(path_for(options, file))
    , loop_seconds_(player::loop_seconds(polygon_, path_, options.fps))
    , crowd_(file, options.to_world(), static_cast<std::uint32_t>(options.crowd))
    , one_(extent_of_one(file, options.to_world()))
    , places_(crowd_places(crowd_.count(), room_of(one_)))
    , camera_(extent_of_crowd(one_, places_))
    , scene_(file, one_, quality, !options.plain)
{
    camera_.set_home(crowd_yaw, crowd_pitch);
    if (options.view) camera_.set_view(options.view->x, options.view->y);
    if (options.wire) scene_.set_wire(Wire::over);
    if (options.rebuild == Rebuild::gpu) {
        make_gpu();
        on_gpu_ = true;
    }
    if (options.rebuild == Rebuild::automatic) rebuild_on_gpu(!context.is_software());
}

void CrowdStage::make_gpu()
{
    if (gpu_) return;
    gpu_ = std::make_unique<GpuCrowd>(file_, to_world_, crowd_.count(), scene_.blended_parts(), context_.loader());
}

bool CrowdStage::rebuild_on_gpu(bool on)
{
    try {
        if (on) make_gpu();
        if (on_gpu_ != on) times_ = {}; // medians must not mix the two
        on_gpu_ = on;
    } catch (const Error& error) {
        std::fprintf(stderr, "pliant-player: warning P%d: %s; the CPU is used instead\n", static_cast<int>(error.number),
                     error.what());
    }
    return on_gpu_ == on;
}

void CrowdStage::blend(double phase, BlendMode mode)
{
    glFinish(); // work left over from the previous frame must not count here
    mode_ = mode;
    cost_ = {};
    crowd_.solve(crowd_weights(crowd_.count(), phase, polygon_, path_), mode, cost_);
    if (on_gpu_)
        gpu_->rebuild(crowd_, cost_);
    else
        crowd_.reconstruct(cost_);
}

void CrowdStage::draw(const Canvas& canvas, const Area& area, const Area& free)
{
    const Stopwatch watch;
    std::vector<Actor> actors;
    const glm::vec3 axis = (one_.lowest + one_.highest) * 0.5f;
    const glm::vec3 colour = mode_ == BlendMode::elastic ? elastic_colour : linear_colour;
    for (std::uint32_t i = 0; i < crowd_.count(); ++i) {
        const float own = crowd_variation(i);
        Actor actor { nullptr, places_[i], tint(colour, own), nullptr, own * largest_crowd_turn, axis };
        if (on_gpu_)
            actor.built = &gpu_->shape(i);
        else
            actor.vertices = &crowd_.vertices(i);
        actors.push_back(actor);
    }
    const Area free_in_area { free.x - area.x, free.y - area.y, free.width, free.height };
    scene_.draw(canvas, area, free, camera_.place({ area.width, area.height }, free_in_area).matrices, actors);
    glFinish();
    times_.add({ cost_.solve_us * 1e-3, cost_.rebuild_us() * 1e-3, watch.microseconds() * 1e-3 });
}

} // namespace pliant::player
