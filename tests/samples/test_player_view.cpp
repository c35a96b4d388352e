// What a picture of the player looks like: the camera fits shapes and shadows, and texts can be read. No OpenGL.
#include "draw/camera.h"
#include "panels/palette.h"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

using namespace pliant::player;

namespace {

// Where a point is in a picture of 200 x 100 pixels.
glm::vec2 pixel(const Camera::Matrices& seen, glm::vec3 point)
{
    const glm::vec4 clip = seen.projection * seen.view * glm::vec4(point, 1.0f);
    return { (clip.x / clip.w + 1.0f) * 100.0f, (1.0f - clip.y / clip.w) * 50.0f };
}

// The bounding box of shapes and shadows in the picture: left, top, right, bottom.
glm::vec4 bounds_of(const Camera::Placement& placed, const std::vector<glm::vec3>& outline, float yaw)
{
    const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), glm::radians(yaw), { 0.0f, 1.0f, 0.0f }));
    const glm::vec3 light = turn * key_light;
    glm::vec4 box(1e9f, 1e9f, -1e9f, -1e9f);
    for (const glm::vec3& offset : placed.offsets) {
        for (const glm::vec3& point : outline) {
            for (const glm::vec3& seen : { point, point - light * (point.y / light.y) }) {
                const glm::vec2 at = pixel(placed.matrices, seen + offset);
                box = { std::min(box.x, at.x), std::min(box.y, at.y), std::max(box.z, at.x), std::max(box.w, at.y) };
            }
        }
    }
    return box;
}

} // namespace

TEST_CASE("the camera fits shapes and shadows into the free part, in its middle")
{
    const Extent extent { { -1, 0, -1 },
                          { 2, 3, 1 },
                          { { -1, 0, 0 }, { 2, 3, 0 }, { 0, 1, -1 }, { 0, 1, 1 }, { 0.5f, 0, 1 } } };
    const Area free { 50.0f, 10.0f, 140.0f, 70.0f };
    for (float yaw : { 30.0f, -100.0f }) {
        for (float pitch : { 0.0f, 12.0f, 70.0f }) {
            for (std::size_t count : { 1u, 2u, 3u }) {
                CAPTURE(yaw);
                CAPTURE(pitch);
                CAPTURE(count);
                Camera camera(extent);
                camera.set_view(yaw, pitch);
                const Camera::Placement placed = camera.place({ 200.0f, 100.0f }, free, count);
                const glm::vec4 box = bounds_of(placed, extent.outline, yaw);
                CHECK(box.x > 50.0f);
                CHECK(box.y > 10.0f);
                CHECK(box.z < 190.0f);
                CHECK(box.w < 80.0f);
                CHECK(std::max((box.z - box.x) / 140.0f, (box.w - box.y) / 70.0f) > 0.88f);
                CHECK(std::abs(box.x + box.z - 240.0f) < 4.0f);
                CHECK(std::abs(box.y + box.w - 90.0f) < 4.0f);
                for (const glm::vec2& below : placed.below) CHECK(below.y <= box.w + 0.01f);
            }
        }
    }
}

TEST_CASE("the camera moves with the mouse, and frames again")
{
    const Extent extent { { -1, 0, -1 }, { 1, 2, 1 }, { { -1, 0, 0 }, { 1, 2, 0 }, { 0, 1, -1 }, { 0, 1, 1 } } };
    const Area whole { 0.0f, 0.0f, 200.0f, 100.0f };
    const glm::vec2 picture(200.0f, 100.0f);
    Camera camera(extent);
    const glm::vec3 middle(0.0f, 1.0f, 0.0f);
    const glm::vec2 before = pixel(camera.place(picture, whole).matrices, middle);
    camera.pan({ 0.2f, 0.1f }); // of the picture's height
    const glm::vec2 way = pixel(camera.place(picture, whole).matrices, middle) - before;
    CHECK(std::abs(way.x - 20.0f) < 2.5f);
    CHECK(std::abs(way.y + 10.0f) < 2.5f);
    camera.zoom(0.5f);
    const float far = camera.place(picture, whole).distance;
    camera.frame(extent);
    CHECK(glm::distance(pixel(camera.place(picture, whole).matrices, middle), before) < 1e-3f);
    CHECK(camera.place(picture, whole).distance == far);
    Extent small = extent;
    for (glm::vec3& point : small.outline) point *= 0.5f;
    camera.frame(small);
    CHECK(camera.place(picture, whole).distance < 0.6f * far);
    camera.reset();
    CHECK(camera.place(picture, whole).distance == far);
}

TEST_CASE("every text has a contrast of 4.5 : 1 with what it stands on, whatever is behind the panels")
{
    struct Colour {
        double r, g, b;
    };
    const auto over = [](std::uint32_t top, Colour below) {
        const double a = (top >> 24) / 255.0;
        const auto mix = [a](std::uint32_t t, double u) { return a * (t & 255u) / 255.0 + (1.0 - a) * u; };
        return Colour { mix(top, below.r), mix(top >> 8, below.g), mix(top >> 16, below.b) };
    };
    const auto luminance = [](Colour c) { // WCAG 2.1, relative luminance
        const auto linear = [](double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); };
        return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
    };
    const auto contrast = [&](std::uint32_t text, Colour below) {
        const double a = luminance(over(text, below)), b = luminance(below);
        return (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
    };
    CHECK(contrast(rgba(0, 0, 0), { 1, 1, 1 }) == doctest::Approx(21.0));
    CHECK(contrast(rgba(104, 116, 136), { 0.8, 0.83, 0.875 }) < 4.5); // what captions once had
    for (const Colour& behind : { Colour { 0, 0, 0 }, Colour { 1, 1, 1 }, Colour { 0.8, 0.83, 0.875 } }) {
        const Colour plate = over(panel, behind);
        for (std::uint32_t text : { ink, faint_ink, elastic_ink, linear_ink, unreduced_ink })
            CHECK(contrast(text, plate) >= 4.5);
        for (std::uint32_t on : { button, hovered_button, pressed_button }) CHECK(contrast(ink, over(on, plate)) >= 4.5);
        CHECK(contrast(error_ink, over(error_panel, behind)) >= 4.5);
        for (std::uint32_t text : { ink, faint_ink }) CHECK(contrast(text, over(field, behind)) >= 4.5);
    }
    for (std::uint32_t chosen : { ink, elastic_ink, linear_ink, unreduced_ink })
        CHECK(contrast(white_ink, over(chosen, { 1, 1, 1 })) >= 4.5);
}
