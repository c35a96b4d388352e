// An orbit camera that fits all poses into a part of the picture.
#pragma once

#include "blend/character.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace pliant::player {

// A rectangle of pixels, origin at the top left.
struct Area {
    float x = 0.0f, y = 0.0f, width = 1.0f, height = 1.0f;
};

class Camera {
public:
    // Looks at the centre of the extent, from a distance at which all of it is visible.
    explicit Camera(const Extent& extent);

    // In degrees. yaw: around the up axis, 0 looks from +z. pitch: positive looks down; clamped to -5 to 89.
    void set_view(float yaw, float pitch);
    void orbit(float yaw, float pitch) { set_view(yaw_ + yaw, pitch_ + pitch); }
    // factor < 1 moves closer.
    void zoom(float factor);
    void reset();
    // Sets the view that reset() returns to, and resets.
    void set_home(float yaw, float pitch);

    struct Matrices {
        glm::mat4 view { 1.0f };
        glm::mat4 projection { 1.0f };
        glm::vec3 eye { 0.0f };
    };

    // Fits the poses into `free`, the part of the picture that panels do not cover. picture: width and height in pixels.
    // room_beside: width needed, in widths of a character (two side by side: 2).
    Matrices matrices(glm::vec2 picture, const Area& free, float room_beside = 1.0f) const;

    // The direction to the right in the picture, parallel to the floor.
    glm::vec3 right() const;
    // Width and height of all poses together as seen from here, in the asset's units.
    glm::vec2 size() const;

private:
    glm::mat4 rotation() const;

    Extent extent_;
    float home_yaw_, home_pitch_;
    float yaw_ = 0.0f;
    float pitch_ = 0.0f;
    float zoom_ = 1.0f;
};

} // namespace pliant::player
