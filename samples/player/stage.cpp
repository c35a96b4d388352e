#include "stage.h"

namespace pliant::player {

namespace {

// Side by side, the characters' middles are this many widths apart.
constexpr float kSeparation = 1.04f;

} // namespace

Stage::Stage(const Options& options, const AssetFile& file, Quality quality)
    : elastic_(file, options.to_world())
    , linear_(file, options.to_world())
    , extent_(extent_of_poses(linear_))
    , camera_(extent_)
    , scene_(file.view(), extent_, quality)
    , polygon_(file.view().pose_count)
{
    if (options.view) camera_.set_view(options.view->x, options.view->y);
}

BlendCost Stage::blend(const std::vector<double>& weights, Show show)
{
    show_ = show;
    BlendCost cost;
    if (show != Show::elastic) cost = linear_.blend(weights, BlendMode::linear);
    if (show != Show::linear) cost = elastic_.blend(weights, BlendMode::elastic);
    return cost;
}

// Half the way from one character to the other, along the picture's horizontal.
glm::vec3 Stage::beside() const { return camera_.right() * (0.5f * kSeparation * camera_.size().x); }

void Stage::draw(const Canvas& canvas, const Area& area, const Area& free)
{
    const glm::vec2 picture { area.width, area.height };
    const Area free_in_area { free.x - area.x, free.y - area.y, free.width, free.height };
    if (show_ == Show::both) {
        const std::vector<Actor> actors { { &linear_.vertices(), -beside(), kLinearColour },
                                          { &elastic_.vertices(), beside(), kElasticColour } };
        scene_.draw(canvas, area, free, camera_.matrices(picture, free_in_area, 1.0f + kSeparation), actors);
        return;
    }
    const bool elastic = show_ == Show::elastic;
    const Actor actor { elastic ? &elastic_.vertices() : &linear_.vertices(), {}, elastic ? kElasticColour : kLinearColour };
    scene_.draw(canvas, area, free, camera_.matrices(picture, free_in_area), { actor });
}

void Stage::draw_pose(const Canvas& canvas, const Area& area)
{
    const Area whole { 0.0f, 0.0f, area.width, area.height };
    scene_.draw(canvas, area, area, camera_.matrices({ area.width, area.height }, whole),
                { { &linear_.vertices(), {}, kPoseColour } });
}

} // namespace pliant::player
