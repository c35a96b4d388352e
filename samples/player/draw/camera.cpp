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

// Distance of the centres of characters side by side, in widths.
constexpr float separation = 1.04f;

// Characters side by side are compared, so they must be seen from nearly the same direction. Each additional width of a
// character makes the focal length longer by this many times that of one character.
constexpr float longer_lens = 2.0f;

// A bounding box in the axes of a camera, or on its picture.
struct Box {
    glm::vec3 lowest { std::numeric_limits<float>::max() };
    glm::vec3 highest { std::numeric_limits<float>::lowest() };

    void add(glm::vec3 point)
    {
        lowest = glm::min(lowest, point);
        highest = glm::max(highest, point);
    }
    glm::vec3 centre() const { return (lowest + highest) * 0.5f; }
};

// The outline, and its shadow on the floor.
std::vector<glm::vec3> with_shadow(const std::vector<glm::vec3>& outline, float yaw)
{
    std::vector<glm::vec3> points = outline;
    const glm::vec3 light = glm::mat3(glm::rotate(glm::mat4(1.0f), glm::radians(yaw), { 0.0f, 1.0f, 0.0f })) * key_light;
    for (const glm::vec3& point : outline) points.push_back(point - light * (point.y / light.y));
    return points;
}

// The smallest distance from `centre` at which the points, in the axes of the camera, fit into half angles of the given
// tangents.
float fitting_distance(const std::vector<glm::vec3>& points, glm::vec3 centre, glm::vec2 tangents)
{
    float distance = 1e-6f; // an outline of zero size still needs a valid frustum
    for (const glm::vec3& point : points) {
        const glm::vec3 seen = point - centre;
        distance = std::max(distance, seen.z + std::abs(seen.x) / tangents.x);
        distance = std::max(distance, seen.z + std::abs(seen.y) / tangents.y);
    }
    return distance;
}

// What is nearer looks larger: from the centre of the points to that of their picture.
glm::vec3 centre_of_picture(const std::vector<glm::vec3>& points, glm::vec2 tangents)
{
    Box box;
    for (const glm::vec3& point : points) box.add(point);
    glm::vec3 centre = box.centre();
    for (int i = 0; i < 4; ++i) {
        const float distance = fitting_distance(points, centre, tangents);
        Box seen;
        for (const glm::vec3& point : points) seen.add((point - centre) / std::max(distance - point.z + centre.z, 1e-6f));
        centre += glm::vec3(glm::vec2(seen.centre()) * distance, 0.0f);
    }
    return centre;
}

// In pixels, from the top left.
glm::vec3 on_picture(const Camera::Matrices& seen, glm::vec2 picture, glm::vec3 point)
{
    const glm::vec4 clip = seen.projection * seen.view * glm::vec4(point, 1.0f);
    return { (clip.x / clip.w + 1.0f) * 0.5f * picture.x, (1.0f - clip.y / clip.w) * 0.5f * picture.y, 0.0f };
}

} // namespace

Camera::Camera(const Extent& extent)
    : home_(extent)
    , home_yaw_(home_yaw)
    , home_pitch_(home_pitch)
{
    reset();
}

void Camera::frame(const Extent& extent)
{
    extent_ = extent;
    zoom_ = 1.0f;
    pan_ = glm::vec3(0.0f);
}

void Camera::reset()
{
    frame(home_);
    set_view(home_yaw_, home_pitch_);
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

void Camera::zoom(float factor) { zoom_ = std::clamp(zoom_ * factor, 0.05f, 6.0f); }

void Camera::pan(glm::vec2 way) { pan_ -= glm::transpose(glm::mat3(rotation())) * glm::vec3(way * seen_height_, 0.0f); }

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
    Box box;
    for (const glm::vec3& point : with_shadow(extent_.outline, yaw_)) box.add(glm::mat3(rotation()) * point);
    return box.highest - box.lowest;
}

// Of a perspective with the middle of the free part in the middle of the view.
glm::mat4 Camera::projection(glm::vec2 picture, const Area& free, float half_height, float distance, float radius) const
{
    // Near and far planes close to the scene and its floor.
    const float nearest = std::max(distance - radius, 0.02f * distance), farthest = distance + 4.0f * radius;
    const float half_width = half_height * picture.x / picture.y;
    const glm::mat4 centred = glm::frustum(-half_width * nearest, half_width * nearest, -half_height * nearest,
                                           half_height * nearest, nearest, farthest);
    // The picture is shifted, the camera is not turned.
    const glm::vec2 middle { free.x + 0.5f * free.width, free.y + 0.5f * free.height };
    const glm::vec2 shift { 2.0f * middle.x / picture.x - 1.0f, 1.0f - 2.0f * middle.y / picture.y };
    return glm::translate(glm::mat4(1.0f), { shift, 0.0f }) * centred;
}

Camera::Placement Camera::place(glm::vec2 picture, const Area& free, std::size_t count, float least_distance)
{
    Placement result;
    const float beside = separation * static_cast<float>(count - 1); // in widths of one character
    const glm::vec3 step = right() * (separation * size().x);
    const glm::mat3 turn(rotation());
    const std::vector<glm::vec3> one = with_shadow(extent_.outline, yaw_);
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        result.offsets.push_back(step * (static_cast<float>(i) - 0.5f * static_cast<float>(count - 1)));
        for (const glm::vec3& point : one) points.push_back(turn * (point + result.offsets.back()));
    }
    // Half the free part, as tangents of view angles, with a margin of a twelfth.
    const float half_height = std::tan(glm::radians(field_of_view) * 0.5f) / (1.0f + longer_lens * beside);
    const glm::vec2 reach = glm::vec2(free.width, free.height) * (0.92f * half_height / picture.y);
    const glm::vec3 centre = centre_of_picture(points, reach);
    result.distance = fitting_distance(points, centre, reach);

    const float distance = zoom_ * std::max(result.distance, least_distance);
    const float radius = glm::length(extent_.highest - extent_.lowest) * 0.5f;
    seen_height_ = 2.0f * half_height * distance;
    Matrices& seen = result.matrices;
    seen.view = glm::translate(glm::mat4(1.0f), -centre - turn * pan_ - glm::vec3(0.0f, 0.0f, distance)) * rotation();
    seen.eye = glm::vec3(glm::inverse(seen.view)[3]);
    seen.projection = projection(picture, free, half_height, distance, (1.0f + beside) * 2.0f * radius);
    for (const glm::vec3& offset : result.offsets) {
        Box body, all;
        for (const glm::vec3& point : extent_.outline) body.add(on_picture(seen, picture, point + offset));
        for (const glm::vec3& point : one) all.add(on_picture(seen, picture, point + offset));
        result.below.emplace_back(body.centre().x, all.highest.y);
    }
    return result;
}

} // namespace pliant::player
