#include "draw/camera.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::player {
namespace {

constexpr float home_yaw = 30.0f;
constexpr float home_pitch = 12.0f;
constexpr float field_of_view
    = 26.0f; // degrees, vertical: a portrait lens, which distorts limbs that point at the camera little

// Characters side by side are compared, so they must be seen from nearly the same direction. Each additional character
// makes the focal length longer by this many times that of one character.
constexpr float longer_lens = 2.0f;

// The bounding box of the outline in the axes of a camera with this rotation.
struct Silhouette {
    glm::vec3 lowest { std::numeric_limits<float>::max() };
    glm::vec3 highest { std::numeric_limits<float>::lowest() };
};

Silhouette silhouette(const std::vector<glm::vec3>& outline, const glm::mat3& rotation)
{
    Silhouette result;
    for (const glm::vec3& point : outline) {
        result.lowest = glm::min(result.lowest, rotation * point);
        result.highest = glm::max(result.highest, rotation * point);
    }
    return result;
}

// The smallest distance from `centre` at which the outline fits into half angles of the given tangents.
float fitting_distance(const std::vector<glm::vec3>& outline, const glm::mat3& rotation, glm::vec3 centre,
                       glm::vec2 tangents)
{
    float distance = 1e-6f; // an outline of zero size still needs a valid frustum
    for (const glm::vec3& point : outline) {
        const glm::vec3 seen = rotation * point - centre;
        distance = std::max(distance, seen.z + std::abs(seen.x) / tangents.x);
        distance = std::max(distance, seen.z + std::abs(seen.y) / tangents.y);
    }
    return distance;
}

} // namespace

Camera::Camera(const Extent& extent)
    : extent_(extent)
    , home_yaw_(home_yaw)
    , home_pitch_(home_pitch)
{
    reset();
}

void Camera::reset()
{
    set_view(home_yaw_, home_pitch_);
    zoom_ = 1.0f;
}

void Camera::set_home(float yaw, float pitch)
{
    home_yaw_ = yaw;
    home_pitch_ = pitch;
    reset();
}

void Camera::set_view(float yaw, float pitch)
{
    yaw_ = std::remainder(yaw, 360.0f);
    pitch_ = std::clamp(pitch, -5.0f, 89.0f);
}

void Camera::zoom(float factor) { zoom_ = std::clamp(zoom_ * factor, 0.1f, 6.0f); }

glm::vec3 Camera::right() const
{
    const float yaw = glm::radians(yaw_);
    return { std::cos(yaw), 0.0f, -std::sin(yaw) };
}

glm::mat4 Camera::rotation() const
{
    const glm::mat4 pitched = glm::rotate(glm::mat4(1.0f), glm::radians(pitch_), glm::vec3(1.0f, 0.0f, 0.0f));
    return glm::rotate(pitched, glm::radians(-yaw_), glm::vec3(0.0f, 1.0f, 0.0f));
}

glm::vec2 Camera::size() const
{
    const Silhouette seen = silhouette(extent_.outline, glm::mat3(rotation()));
    return seen.highest - seen.lowest;
}

Camera::Matrices Camera::matrices(glm::vec2 picture, const Area& free, float room_beside) const
{
    // Half the free part, as tangents of view angles, with a margin of a twelfth.
    const float half_height = std::tan(glm::radians(field_of_view) * 0.5f) / (1.0f + longer_lens * (room_beside - 1.0f));
    const glm::vec2 reach = glm::vec2(free.width / room_beside, free.height) * (0.92f * half_height / picture.y);
    const glm::mat3 turn(rotation());
    const Silhouette seen = silhouette(extent_.outline, turn);
    const glm::vec3 centre = (seen.lowest + seen.highest) * 0.5f;
    const float distance = zoom_ * fitting_distance(extent_.outline, turn, centre, reach);

    Matrices result;
    result.view = glm::translate(glm::mat4(1.0f), -centre - glm::vec3(0.0f, 0.0f, distance)) * rotation();
    result.eye = glm::vec3(glm::inverse(result.view)[3]);

    // Near and far planes close to the scene and its floor.
    const float radius = glm::length(extent_.highest - extent_.lowest) * 0.5f;
    const float nearest = std::max(distance - room_beside * 2.0f * radius, 0.02f * distance);
    const float farthest = distance + 8.0f * radius;
    const float half_width = half_height * picture.x / picture.y;
    result.projection = glm::frustum(-half_width * nearest, half_width * nearest, -half_height * nearest,
                                     half_height * nearest, nearest, farthest);
    // Centres the view in the free rectangle by shifting the picture, not by turning the camera.
    const glm::vec2 middle { free.x + 0.5f * free.width, free.y + 0.5f * free.height };
    const glm::vec2 shift { 2.0f * middle.x / picture.x - 1.0f, 1.0f - 2.0f * middle.y / picture.y };
    result.projection = glm::translate(glm::mat4(1.0f), { shift, 0.0f }) * result.projection;
    return result;
}

} // namespace pliant::player
