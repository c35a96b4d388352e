// Draws characters in a studio: a backdrop, a floor with soft shadows, and lights that turn with the camera.
#pragma once

#include "blend/character.h"
#include "draw/actor.h"
#include "draw/bodies.h"
#include "draw/camera.h"
#include "draw/gl_objects.h"
#include "draw/paint.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <optional>
#include <vector>

namespace pliant::player {

// low: windows with a driver that renders on the processor. medium: other windows. high: pictures.
enum class Quality { low, medium, high };

// The colours of the kinds of blend.
inline const glm::vec3 elastic_colour { 0.76f, 0.20f, 0.085f };
inline const glm::vec3 linear_colour { 0.20f, 0.29f, 0.42f };
inline const glm::vec3 unreduced_colour { 0.105f, 0.30f, 0.20f };
inline const glm::vec3 single_pose_colour { 0.62f, 0.56f, 0.48f };

enum class Wire { none, over, only };

class Scene {
public:
    // All actors must be blends of the file's asset. extent: of all poses. with_paint: also reads the asset's materials.
    // Throws Error.
    Scene(const AssetFile& file, const Extent& extent, Quality quality, bool with_paint);

    // Whether there are materials, and whether to show them instead of the actors' colours (default: yes).
    bool has_paint() const { return paint_.has_value(); }
    void toggle_paint() { shows_paint_ = !shows_paint_; }
    // The edges of all triangles: not shown (default), over the surfaces, or without surfaces.
    void set_wire(Wire wire) { wire_ = wire; }
    void next_wire() { wire_ = wire_ == Wire::none ? Wire::over : wire_ == Wire::over ? Wire::only : Wire::none; }
    // The vertices of each blended part, whose means built shapes must provide.
    std::vector<std::vector<std::uint32_t>> blended_parts() const;

    // Draws into the part `area` of the canvas, between its begin() and resolve(). glow: the part of the canvas in whose
    // centre the characters stand.
    void draw(const Canvas& canvas, const Area& area, const Area& glow, const Camera::Matrices& camera,
              const std::vector<Actor>& actors);

private:
    struct Stage {
        glm::vec3 centre { 0.0f };
        float radius = 1.0f;
    };

    Stage stage_for(const std::vector<Actor>& actors) const;
    void place_lights(const Stage& stage, const glm::mat4& view);
    void make_footprint_target();
    void draw_shadow_maps(const std::vector<Actor>& actors);
    void draw_footprint(const Stage& stage, const std::vector<Actor>& actors);
    float body_height() const { return std::max(extent_.highest.y - extent_.lowest.y, 1e-6f); }
    void draw_backdrop(const Area& area, const Area& glow);
    void draw_floor(const Stage& stage, const Camera::Matrices& camera);
    void draw_actors(const Camera::Matrices& camera, const std::vector<Actor>& actors);
    void draw_surfaces(const glm::mat4& view, const std::vector<Actor>& actors) const;
    void draw_wire(const std::vector<Actor>& actors) const;
    void set_lights(const Program& program) const;
    void draw_shadow(std::size_t actor) const;
    void draw_painted(const glm::mat4& view, const std::vector<Actor>& actors) const;
    void draw_layers(const glm::mat4& view, const std::vector<Actor>& actors) const;
    void use_part(const PaintedPart& part) const;

    Extent extent_;
    std::optional<Paint> paint_;
    bool shows_paint_ = true;
    Wire wire_ = Wire::none;
    int shadow_size_, light_count_, footprint_size_;
    float dome_lowest_, floor_radius_;
    Program backdrop_, depth_, floor_, body_;
    GlName empty_array_, shadow_texture_, shadow_target_, footprint_, footprint_depth_, footprint_target_, white_;
    Bodies bodies_;
    std::vector<glm::mat4> light_clips_;    // world to clip space, for drawing the maps
    std::vector<glm::mat4> light_matrices_; // world to the unit cube, for looking up
    std::vector<glm::vec4> lights_;

    Scene(const pliant_asset& asset, const Extent& extent, Quality quality, const struct ShaderSources& sources);
};

} // namespace pliant::player
