#include "run/stage.h"

#include "panels/hud_heat.h"

namespace pliant::player {
namespace {

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
    if (options.wire) scene_.set_wire(Wire::over);
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
    unreduced_.set_heat(std::vector<float>(heat_.size(), reference_heat));
}

const Character& Stage::character(Kind kind) const
{
    return kind == Kind::linear ? linear_ : kind == Kind::elastic ? elastic_ : unreduced_;
}

Actor Stage::actor(Kind kind, glm::vec3 offset) const
{
    const glm::vec3 colour = kind == Kind::linear ? linear_colour
        : kind == Kind::elastic                   ? elastic_colour
                                                  : unreduced_colour;
    return { &character(kind).vertices(), offset, colour };
}

Extent Stage::extent_shown() const
{
    ExtentOfShapes all;
    add_shown(all);
    return all.extent();
}

void Stage::add_shown(ExtentOfShapes& all) const
{
    for (Kind kind : kinds_of(shown_.show)) all.add(character(kind).vertices());
}

void Stage::draw(const Canvas& canvas, const Area& area, const Area& free, float scale)
{
    const glm::vec2 picture { area.width, area.height };
    const Area room = without_captions(shown_, { free.x - area.x, free.y - area.y, free.width, free.height }, scale);
    const std::vector<Kind> kinds = kinds_of(shown_.show);
    const Camera::Placement placement = camera_.place(picture, room, kinds.size());
    std::vector<Actor> actors;
    for (std::size_t i = 0; i < kinds.size(); ++i) actors.push_back(actor(kinds[i], placement.offsets[i]));
    scene_.draw(canvas, area, free, placement.matrices, actors);
    caption_places_.clear();
    for (glm::vec2 below : placement.below) caption_places_.push_back(below / picture);
}

void Stage::draw_tile(const Canvas& canvas, const Area& area, float least_distance, bool neutral)
{
    const Area whole { 0.0f, 0.0f, area.width, area.height };
    Actor shape = actor(kinds_of(shown_.show).front(), {});
    if (neutral) shape.colour = single_pose_colour;
    scene_.draw(canvas, area, area, camera_.place({ area.width, area.height }, whole, 1, least_distance).matrices,
                { shape });
}

} // namespace pliant::player
