#include "draw/scene.h"

#include "blend/heat.h"
#include "draw/layers.h"
#include "draw/shaders.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace pliant::player {
namespace {

// The key light and a dome of lights, each with a shadow map. lowest: sine of the lowest elevation in the dome; with few
// lights it is high, so that their shadows overlap near the feet. floor: its radius, in radii of the scene.
struct Lighting {
    int light_count, shadow_size, key_taps, dome_taps, footprint_size, sky_taps;
    float lowest, floor;
};
constexpr Lighting low_lighting { 1 + 3, 320, 7, 3, 256, 3, 0.82f, 1.5f };
constexpr Lighting medium_lighting { 1 + 16, 768, 12, 4, 512, 12, 0.25f, 2.4f };
constexpr Lighting high_lighting { 1 + 24, 768, 24, 8, 1024, 16, 0.17f, 2.4f };

constexpr float footprint_width = 1.1f; // half of the map's, in radii of the scene

constexpr Lighting lighting(Quality quality)
{
    return quality == Quality::low ? low_lighting : quality == Quality::medium ? medium_lighting : high_lighting;
}

ShaderSources sources_for(Quality quality)
{
    const Lighting l = lighting(quality);
    return shader_sources(l.light_count, l.key_taps, l.dome_taps, l.sky_taps);
}

// Directions spread evenly over the sky above `lowest` (a Fibonacci spiral), brighter towards the zenith.
glm::vec4 dome_light(int i, int count, float lowest)
{
    const float up = lowest + (1.0f - lowest) * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    const float angle = static_cast<float>(i) * 2.39996323f;
    const float level = std::sqrt(1.0f - up * up);
    return { level * std::cos(angle), up, level * std::sin(angle), 0.55f + 0.45f * up };
}

} // namespace

Scene::Scene(const AssetFile& file, const Extent& extent, Quality quality, bool with_paint)
    : Scene(file.view(), extent, quality, sources_for(quality))
{
    if (!with_paint) return;
    const std::optional<Painting> painting = painting_of(file);
    if (!painting) return;
    paint_.emplace(*painting);
    bodies_.take_paint(file.view(), *painting, *paint_);
}

Scene::Scene(const pliant_asset& asset, const Extent& extent, Quality quality, const ShaderSources& sources)
    : extent_(extent)
    , shadow_size_(lighting(quality).shadow_size)
    , light_count_(lighting(quality).light_count)
    , footprint_size_(lighting(quality).footprint_size)
    , dome_lowest_(lighting(quality).lowest)
    , floor_radius_(lighting(quality).floor)
    , backdrop_("backdrop", sources.backdrop_vertex, sources.backdrop_fragment)
    , depth_("depth", sources.depth_vertex, sources.depth_fragment)
    , floor_("floor", sources.floor_vertex, sources.floor_fragment)
    , body_("body", sources.body_vertex, sources.body_fragment)
    , empty_array_(make_vertex_array())
    , shadow_texture_(make_texture())
    , shadow_target_(make_framebuffer())
    , footprint_(make_texture())
    , footprint_depth_(make_renderbuffer())
    , footprint_target_(make_framebuffer())
    , white_(make_white_texture())
    , bodies_(asset)
{
    glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_texture_.get());
    glTexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_DEPTH_COMPONENT24, shadow_size_, shadow_size_, light_count_, 0,
                 GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    const GLfloat lit[] = { 1.0f, 1.0f, 1.0f, 1.0f };
    glTexParameterfv(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BORDER_COLOR, lit);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    make_footprint_target();
}

// Outside of the map nothing is above the floor.
void Scene::make_footprint_target()
{
    glBindTexture(GL_TEXTURE_2D, footprint_.get());
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, footprint_size_, footprint_size_, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER,
                    GL_LINEAR_MIPMAP_NEAREST); // each look-up has one level for all pixels
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glBindRenderbuffer(GL_RENDERBUFFER, footprint_depth_.get());
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, footprint_size_, footprint_size_);
    glBindFramebuffer(GL_FRAMEBUFFER, footprint_target_.get());
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, footprint_.get(), 0);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, footprint_depth_.get());
}

std::vector<std::vector<std::uint32_t>> Scene::blended_parts() const
{
    return paint_ ? paint_->blended() : std::vector<std::vector<std::uint32_t>> {};
}

Scene::Stage Scene::stage_for(const std::vector<Actor>& actors) const
{
    glm::vec3 lowest = extent_.lowest, highest = extent_.highest;
    for (const Actor& actor : actors) {
        lowest = glm::min(lowest, extent_.lowest + actor.offset);
        highest = glm::max(highest, extent_.highest + actor.offset);
    }
    Stage stage;
    stage.centre = (lowest + highest) * 0.5f;
    stage.radius = std::max(glm::length(highest - lowest) * 0.5f, 1e-6f); // a scene of zero size still needs valid matrices
    return stage;
}

// The lights turn with the camera around the up axis, as if the characters stood on a turntable in a studio.
void Scene::place_lights(const Stage& stage, const glm::mat4& view)
{
    const float yaw = std::atan2(-view[2][0], view[0][0]);
    const glm::mat4 turn = glm::rotate(glm::mat4(1.0f), yaw, glm::vec3(0.0f, 1.0f, 0.0f));
    lights_.assign(1, glm::vec4(glm::normalize(key_light), 1.0f));
    for (int i = 0; i + 1 < light_count_; ++i) lights_.push_back(dome_light(i, light_count_ - 1, dome_lowest_));

    light_clips_.clear();
    light_matrices_.clear();
    const glm::mat4 to_unit
        = glm::translate(glm::mat4(1.0f), glm::vec3(0.5f)) * glm::scale(glm::mat4(1.0f), glm::vec3(0.5f));
    const float r = stage.radius * 1.02f;
    for (glm::vec4& light : lights_) {
        const glm::vec3 direction = glm::vec3(turn * glm::vec4(glm::vec3(light), 0.0f));
        light = glm::vec4(direction, light.w);
        const glm::vec3 up = std::abs(direction.y) > 0.9f ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(0.0f, 1.0f, 0.0f);
        const glm::mat4 from_light = glm::lookAt(stage.centre + direction * r, stage.centre, up);
        light_clips_.push_back(glm::ortho(-r, r, -r, r, 0.0f, 2.0f * r) * from_light);
        light_matrices_.push_back(to_unit * light_clips_.back());
    }
}

// Transparent places cast no shadow. A shadow map has no partial light, so alpha is thresholded.
void Scene::draw_shadow(std::size_t actor) const
{
    depth_.set("cutoff", 0.0f);
    if (!paint_ || !shows_paint_ || (!paint_->has(Alpha::mask) && !paint_->has(Alpha::blend))) {
        bodies_.draw(actor);
        return;
    }
    for (const PaintedPart& part : paint_->parts()) {
        depth_.set("cutoff", part.alpha == Alpha::opaque ? 0.0f : part.alpha == Alpha::mask ? part.cutoff : 0.5f);
        depth_.set("alpha_factor", part.factor.a);
        paint_->bind(part);
        bodies_.draw(actor, part);
    }
}

void Scene::draw_shadow_maps(const std::vector<Actor>& actors)
{
    glBindFramebuffer(GL_FRAMEBUFFER, shadow_target_.get());
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    glViewport(0, 0, shadow_size_, shadow_size_);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    depth_.use();
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, white_.get());
    depth_.set("picture", 0);
    for (int light = 0; light < light_count_; ++light) {
        glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, shadow_texture_.get(), 0, light);
        glClear(GL_DEPTH_BUFFER_BIT);
        for (std::size_t i = 0; i < actors.size(); ++i) {
            depth_.set("matrix", light_clips_[light] * model_of(actors[i]));
            draw_shadow(i);
        }
    }
}

// What a camera below the floor sees that looks up: the height of the lowest surface above each place.
void Scene::draw_footprint(const Stage& stage, const std::vector<Actor>& actors)
{
    glBindFramebuffer(GL_FRAMEBUFFER, footprint_target_.get());
    glViewport(0, 0, footprint_size_, footprint_size_);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const float r = footprint_width * stage.radius, top = footprint_top * body_height();
    glm::mat4 from_below(0.0f);
    from_below[0][0] = from_below[2][1] = 1.0f / r;
    from_below[1][2] = 2.0f / top;
    from_below[3] = { -stage.centre.x / r, -stage.centre.z / r, 2.0f * footprint_below * body_height() / top - 1.0f, 1.0f };
    for (std::size_t i = 0; i < actors.size(); ++i) {
        depth_.set("matrix", from_below * model_of(actors[i]));
        draw_shadow(i);
    }
    glBindTexture(GL_TEXTURE_2D, footprint_.get());
    glGenerateMipmap(GL_TEXTURE_2D);
}

void Scene::set_lights(const Program& program) const
{
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_texture_.get());
    program.set("shadows", 0);
    program.set("light_matrices", light_matrices_.data(), light_count_);
    program.set("lights", lights_.data(), light_count_);
}

void Scene::draw_backdrop(const Area& area, const Area& glow)
{
    glDisable(GL_DEPTH_TEST);
    backdrop_.use();
    const float x = (glow.x + 0.5f * glow.width - area.x) / area.width;
    const float y = (glow.y + 0.45f * glow.height - area.y) / area.height;
    backdrop_.set("glow", glm::vec2(x, 1.0f - y));
    backdrop_.set("aspect", area.width / area.height);
    glBindVertexArray(empty_array_.get());
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glEnable(GL_DEPTH_TEST);
}

void Scene::draw_floor(const Stage& stage, const Camera::Matrices& camera)
{
    if (camera.eye.y <= 0.0f) return; // invisible from below
    floor_.use();
    set_lights(floor_);
    floor_.set("view_projection", camera.projection * camera.view);
    floor_.set("centre", stage.centre);
    floor_.set("radius", floor_radius_ * stage.radius);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, footprint_.get());
    floor_.set("footprint", 1);
    floor_.set("footprint_radius", footprint_width * stage.radius);
    floor_.set("body_height", body_height());
    const float own_radius = 0.5f * glm::length(extent_.highest - extent_.lowest);
    floor_.set("key_softness", std::max(0.020f * own_radius / stage.radius, 0.006f));
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE); // soles lie in the floor plane and are drawn over it
    glBindVertexArray(empty_array_.get());
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

void Scene::draw_actors(const Camera::Matrices& camera, const std::vector<Actor>& actors)
{
    body_.use();
    set_lights(body_);
    body_.set("view_projection", camera.projection * camera.view);
    body_.set("eye", camera.eye);
    body_.set("height", std::max(extent_.highest.y - extent_.lowest.y, 1e-6f));
    const HeatColours heat = linear_heat_colours();
    body_.set("heat_colours", heat.data(), static_cast<int>(heat.size()));
    glActiveTexture(GL_TEXTURE1); // unit 0 has the shadows
    glBindTexture(GL_TEXTURE_2D, white_.get());
    body_.set("picture", 1);
    body_.set("wire", 0.0f);
    if (wire_ != Wire::only) draw_surfaces(camera.view, actors);
    if (wire_ != Wire::none) draw_wire(actors);
    glActiveTexture(GL_TEXTURE0);
}

// Surfaces are moved back a little, so that edges on them are visible.
void Scene::draw_surfaces(const glm::mat4& view, const std::vector<Actor>& actors) const
{
    const bool is_painted = paint_ && shows_paint_;
    body_.set("is_painted", is_painted ? 1 : 0);
    body_.set("is_blended", 0);
    body_.set("cutoff", 0.0f);
    glPolygonOffset(1.0f, 1.0f);
    if (wire_ != Wire::none) glEnable(GL_POLYGON_OFFSET_FILL);
    if (is_painted) {
        draw_painted(view, actors);
    } else {
        for (std::size_t i = 0; i < actors.size(); ++i) {
            body_.set("base_colour", glm::vec4(actors[i].colour, 1.0f));
            body_.set("model", model_of(actors[i]));
            bodies_.draw(i);
        }
    }
    glDisable(GL_POLYGON_OFFSET_FILL);
}

void Scene::draw_wire(const std::vector<Actor>& actors) const
{
    body_.set("wire", wire_ == Wire::over ? 0.45f : 0.75f);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (std::size_t i = 0; i < actors.size(); ++i) {
        body_.set("model", model_of(actors[i]));
        bodies_.draw(i);
    }
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glDisable(GL_BLEND);
}

void Scene::use_part(const PaintedPart& part) const
{
    paint_->bind(part);
    body_.set("base_colour", part.factor);
    body_.set("cutoff", part.alpha == Alpha::mask ? part.cutoff : 0.0f);
    body_.set("is_blended", part.alpha == Alpha::blend ? 1 : 0);
}

// Part by part, blended parts last, when everything behind them has been drawn.
void Scene::draw_painted(const glm::mat4& view, const std::vector<Actor>& actors) const
{
    const std::vector<PaintedPart>& parts = paint_->parts();
    const std::size_t first_blended = parts.size() - paint_->blended().size();
    for (std::size_t p = 0; p < first_blended; ++p) {
        use_part(parts[p]);
        for (std::size_t i = 0; i < actors.size(); ++i) {
            body_.set("model", model_of(actors[i]));
            bodies_.draw(i, parts[p]);
        }
    }
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthMask(GL_FALSE);
    draw_layers(view, actors);
    glDepthMask(GL_TRUE);
    glDisable(GL_BLEND);
}

// Blended parts of all actors, the farthest first.
void Scene::draw_layers(const glm::mat4& view, const std::vector<Actor>& actors) const
{
    const std::size_t first_blended = paint_->parts().size() - paint_->blended().size();
    for (const Layer& layer : layers_of(view, actors, paint_->blended())) {
        const PaintedPart& part = paint_->parts()[first_blended + layer.blended];
        use_part(part);
        body_.set("model", model_of(actors[layer.actor]));
        bodies_.draw(layer.actor, part);
    }
}

void Scene::draw(const Canvas& canvas, const Area& area, const Area& glow, const Camera::Matrices& camera,
                 const std::vector<Actor>& actors)
{
    const Stage stage = stage_for(actors);
    place_lights(stage, camera.view);
    bodies_.place(actors);
    draw_shadow_maps(actors);
    draw_footprint(stage, actors);

    canvas.begin();
    const auto x = static_cast<GLint>(area.x), width = static_cast<GLint>(area.width),
               height = static_cast<GLint>(area.height);
    const GLint y = canvas.height() - static_cast<GLint>(area.y) - height;
    glViewport(x, y, width, height);
    glScissor(x, y, width, height);
    glEnable(GL_SCISSOR_TEST);
    glEnable(GL_MULTISAMPLE);
    glClear(GL_DEPTH_BUFFER_BIT);
    draw_backdrop(area, glow);
    draw_floor(stage, camera);
    draw_actors(camera, actors);
    glDisable(GL_SCISSOR_TEST);
}

} // namespace pliant::player
