// An orbit camera that fits characters, side by side and with their shadows, into a part of the picture. No OpenGL.
#pragma once

#include "blend/character.h"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace pliant::player {

// A rectangle of pixels, origin at the top left.
struct Area {
    float x = 0.0f, y = 0.0f, width = 1.0f, height = 1.0f;
};

// The direction to the key light of a camera with yaw 0, of any length. The lights turn with the camera.
inline const glm::vec3 key_light { -0.55f, 0.95f, 0.62f };

class Camera {
public:
    // Looks at the centre of the extent, from a distance at which all of it is visible.
    explicit Camera(const Extent& extent);

    // In degrees. yaw: around the up axis, 0 looks from +z. pitch: positive looks down; clamped to -5 to 89.
    void set_view(float yaw, float pitch);
    void orbit(float yaw, float pitch) { set_view(yaw_ + yaw, pitch_ + pitch); }
    // factor < 1 moves closer.
    void zoom(float factor);
    // Moves the scene to the right and up, in heights of the picture that place() has last been called for.
    void pan(glm::vec2 way);
    // Fits another extent from now on, seen from the same direction, without zoom and pan.
    void frame(const Extent& extent);
    // Everything as at the start.
    void reset();
    // Sets the view that reset() returns to, and resets.
    void set_home(float yaw, float pitch);

    struct Matrices {
        glm::mat4 view { 1.0f };
        glm::mat4 projection { 1.0f };
        glm::vec3 eye { 0.0f };
    };

    // Where a row of characters stands, and how it is seen.
    struct Placement {
        Matrices matrices;
        std::vector<glm::vec3> offsets; // of the characters, from left to right
        std::vector<glm::vec2> below;   // the middle of each character and the lowest place of its shadow, in pixels
        float distance = 0.0f;          // at which it fits
    };

    // Fits `count` characters with the camera's extent into `free`, the part of the picture that panels do not cover.
    // picture: width and height in pixels. least_distance: of another extent that must be seen in the same size.
    Placement place(glm::vec2 picture, const Area& free, std::size_t count = 1, float least_distance = 0.0f);

    // Width and height of the extent and its shadow as seen from here, in the asset's units.
    glm::vec2 size() const;

private:
    glm::mat4 rotation() const;
    glm::vec3 right() const; // in the picture, parallel to the floor
    glm::mat4 projection(glm::vec2 picture, const Area& free, float half_height, float distance, float radius) const;

    Extent home_, extent_;
    float home_yaw_, home_pitch_;
    float yaw_ = 0.0f;
    float pitch_ = 0.0f;
    float zoom_ = 1.0f;
    glm::vec3 pan_ { 0.0f };
    float seen_height_ = 0.0f; // of the picture, at the distance of its centre, in the asset's units
};

} // namespace pliant::player
