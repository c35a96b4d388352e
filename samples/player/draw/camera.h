// An orbit camera that frames a character, and where in the picture it puts it.
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
    // Looks at the middle of what the poses fill, from a distance at which all of it is seen.
    explicit Camera(const Extent& extent);

    // Degrees. yaw turns around the up axis (0: from +z), pitch looks down from above; it stays within -5 and 89.
    void set_view(float yaw, float pitch);
    void orbit(float yaw, float pitch) { set_view(yaw_ + yaw, pitch_ + pitch); }
    // factor < 1 comes closer.
    void zoom(float factor);
    void reset();
    // The view that reset() goes back to; goes there.
    void set_home(float yaw, float pitch);

    struct Matrices {
        glm::mat4 view { 1.0f };
        glm::mat4 projection { 1.0f };
        glm::vec3 eye { 0.0f };
    };

    // Fits the poses into `free`, a part of the `picture` (its width and height), the rest of the picture being covered by panels.
    // room_beside: how many times its own width a character needs (two side by side: 2).
    Matrices matrices(glm::vec2 picture, const Area& free, float room_beside = 1.0f) const;

    // The direction to the right in the picture, level with the floor.
    glm::vec3 right() const;
    // How wide and how high the poses look together, in units of the asset.
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
