#include "run/stage.h"

namespace pliant::player {
namespace {

// Distance of the centres of characters side by side, in widths.
constexpr float separation = 1.04f;

float diagonal_of_first_pose(Character& character)
{
    character.blend(weights_of_pose(character.file().view(), 0), BlendMode::linear);
    return diagonal_of(character.positions(), character.file().view().boundary_vertex_count);
}

bool needs(Kind kind, Show show)
{
    for (Kind one : kinds_of(show))
        if (one == kind) return true;
    return false;
}

} // namespace

Stage::Stage(const Options& options, const AssetFile& file, const Truth* truth, Quality quality)
    : truth_(truth)
    , elastic_(file, options.to_world())
    , linear_(file, options.to_world())
    , unreduced_(file, options.to_world())
    , extent_(extent_of_poses(linear_))
    , diagonal_(diagonal_of_first_pose(linear_))
    , camera_(extent_)
    , scene_(file, extent_, quality, !options.plain)
    , polygon_(file.view().pose_count)
    , heat_(file.view().vertex_count)
{
    if (options.view) camera_.set_view(options.view->x, options.view->y);
}

const Shown& Stage::blend(const std::vector<double>& weights, Show show, bool heat)
{
    shown_.show = show;
    shown_.heat = heat;
    shown_.weights = weights;
    if (truth_) {
        shown_.truth = truth_->nearest(weights);
        shown_.weights = truth_->weights(*shown_.truth);
    }
    // Without a truth, heat shows the distance between the two blends and needs both.
    const bool difference = heat && !truth_;
    if (difference || needs(Kind::linear, show)) shown_.cost = linear_.blend(shown_.weights, BlendMode::linear);
    if (difference || needs(Kind::elastic, show)) {
        const BlendCost cost = elastic_.blend(shown_.weights, BlendMode::elastic);
        if (show != Show::linear) shown_.cost = cost;
    }
    if (truth_ && (heat || needs(Kind::unreduced, show))) unreduced_.show(truth_->shape(*shown_.truth));
    if (heat) {
        colour_by_distance();
    } else {
        for (Character* character : { &linear_, &elastic_, &unreduced_ }) character->set_heat({});
    }
    return shown_;
}

void Stage::colour_by_distance()
{
    const std::size_t count = linear_.file().view().boundary_vertex_count;
    if (!truth_) {
        shown_.linear_heat = shown_.elastic_heat
            = measure_heat(linear_.positions(), elastic_.positions(), count, diagonal_, heat_);
        linear_.set_heat(heat_);
        elastic_.set_heat(heat_);
        return;
    }
    const std::vector<glm::vec3>& truth = truth_->shape(*shown_.truth);
    shown_.linear_heat = measure_heat(linear_.positions(), truth, count, diagonal_, heat_);
    linear_.set_heat(heat_);
    shown_.elastic_heat = measure_heat(elastic_.positions(), truth, count, diagonal_, heat_);
    elastic_.set_heat(heat_);
    unreduced_.set_heat(std::vector<float>(heat_.size(), 0.0f));
}

Actor Stage::actor(Kind kind, glm::vec3 offset) const
{
    switch (kind) {
    case Kind::linear: return { &linear_.vertices(), offset, linear_colour };
    case Kind::elastic: return { &elastic_.vertices(), offset, elastic_colour };
    case Kind::unreduced: break;
    }
    return { &unreduced_.vertices(), offset, unreduced_colour };
}

void Stage::draw(const Canvas& canvas, const Area& area, const Area& free)
{
    const glm::vec2 picture { area.width, area.height };
    const Area free_in_area { free.x - area.x, free.y - area.y, free.width, free.height };
    const std::vector<Kind> kinds = kinds_of(shown_.show);
    const float last = static_cast<float>(kinds.size()) - 1.0f;
    const glm::vec3 step = camera_.right() * (separation * camera_.size().x);
    std::vector<Actor> actors;
    for (std::size_t i = 0; i < kinds.size(); ++i)
        actors.push_back(actor(kinds[i], step * (static_cast<float>(i) - 0.5f * last)));
    scene_.draw(canvas, area, free, camera_.matrices(picture, free_in_area, 1.0f + separation * last), actors);
}

void Stage::draw_pose(const Canvas& canvas, const Area& area)
{
    const Area whole { 0.0f, 0.0f, area.width, area.height };
    scene_.draw(canvas, area, area, camera_.matrices({ area.width, area.height }, whole),
                { { &linear_.vertices(), {}, single_pose_colour } });
}

} // namespace pliant::player
