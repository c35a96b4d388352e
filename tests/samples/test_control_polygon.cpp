// The mathematics of the player: coordinates in the control polygon, and the motion of the point.
#include "blend/asset_file.h"
#include "blend/control_polygon.h"
#include "blend/motion.h"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <random>

using pliant::player::ControlPolygon;
using pliant::player::Motion;

namespace {

double sum(const std::vector<double>& weights)
{
    double total = 0.0;
    for (double weight : weights) total += weight;
    return total;
}

} // namespace

TEST_CASE("one weight in a corner, exactly")
{
    for (std::uint32_t count : { 2u, 3u, 4u, 5u, 7u, 12u, 64u }) {
        const ControlPolygon polygon(count);
        REQUIRE(polygon.corner_count() == count);
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::vector<double> weights = polygon.weights(polygon.corners()[k]);
            for (std::uint32_t i = 0; i < count; ++i) CHECK(weights[i] == (i == k ? 1.0 : 0.0));
        }
    }
}

TEST_CASE("two weights on an edge, linear along it")
{
    for (std::uint32_t count : { 2u, 3u, 5u, 8u }) {
        const ControlPolygon polygon(count);
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::uint32_t next = (k + 1) % count;
            for (double t : { 0.125, 0.5, 0.8 }) {
                const std::vector<double> weights
                    = polygon.weights((1.0 - t) * polygon.corners()[k] + t * polygon.corners()[next]);
                CHECK(weights[k] == doctest::Approx(1.0 - t).epsilon(1e-12));
                CHECK(weights[next] == doctest::Approx(t).epsilon(1e-12));
                for (std::uint32_t i = 0; i < count; ++i)
                    if (i != k && i != next) CHECK(weights[i] == 0.0);
            }
        }
    }
}

TEST_CASE("inside: positive, sum one, and the weighted corners give the point back")
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
    for (std::uint32_t count : { 2u, 3u, 4u, 5u, 6u, 9u, 64u }) {
        const ControlPolygon polygon(count);
        for (int i = 0; i < 200; ++i) {
            const glm::dvec2 point = polygon.nearest_inside({ anywhere(random), anywhere(random) });
            const std::vector<double> weights = polygon.weights(point);
            CHECK(sum(weights) == doctest::Approx(1.0).epsilon(1e-12));
            for (double weight : weights) CHECK(weight >= 0.0);
            CHECK(glm::distance(polygon.point(weights), point) < 1e-9);
        }
        for (double weight : polygon.weights({ 0.0, 0.0 })) CHECK(weight == doctest::Approx(1.0 / count).epsilon(1e-12));
    }
}

TEST_CASE("a point outside counts as the nearest inside")
{
    const ControlPolygon polygon(5);
    const glm::dvec2 outside = 3.0 * polygon.corners()[2];
    CHECK(polygon.nearest_inside(outside) == polygon.corners()[2]);
    CHECK(polygon.weights(outside)[2] == 1.0);
    const glm::dvec2 inside { 0.1, -0.2 };
    CHECK(polygon.nearest_inside(inside) == inside);
}

TEST_CASE("the idle path is closed, stays inside, visits every corner and has no jumps")
{
    for (std::uint32_t count : { 2u, 3u, 5u, 10u }) {
        const ControlPolygon polygon(count);
        CHECK(glm::distance(polygon.idle_point(0.0), polygon.idle_point(1.0)) < 1e-12);
        for (std::uint32_t k = 0; k < count; ++k)
            CHECK(glm::distance(polygon.idle_point(static_cast<double>(k) / count), polygon.corners()[k]) < 1e-9);
        const int steps = 1000 * static_cast<int>(count);
        for (int i = 0; i < steps; ++i) {
            const glm::dvec2 point = polygon.idle_point(static_cast<double>(i) / steps);
            CHECK(glm::distance(point, polygon.nearest_inside(point)) < 1e-12);
            CHECK(glm::distance(point, polygon.idle_point((i + 1.0) / steps)) < 0.02);
        }
    }
}

TEST_CASE("motion: plays until touched, travels to corners, takes the path up again")
{
    const ControlPolygon polygon(4);
    Motion motion(polygon, { 0.0, 0.0 }, true);
    CHECK(motion.plays());
    for (int i = 0; i < 200; ++i) motion.advance(0.02);
    CHECK(glm::length(motion.point()) > 0.05);

    motion.drag_to({ 0.2, 0.1 });
    CHECK_FALSE(motion.plays());
    motion.advance(1.0);
    CHECK(motion.point() == glm::dvec2(0.2, 0.1));

    motion.go_to(3);
    motion.advance(0.3);
    CHECK(motion.point() != polygon.corners()[3]);
    motion.advance(10.0);
    CHECK(glm::distance(motion.point(), polygon.corners()[3]) < 1e-12);
    CHECK_FALSE(motion.plays());

    motion.toggle_play();
    CHECK(motion.plays());
    motion.toggle_play();
    CHECK_FALSE(motion.plays());
}

TEST_CASE("labels drop what all names begin with")
{
    using pliant::player::without_common_prefix;
    using Names = std::vector<std::string>;
    CHECK(without_common_prefix({ "creature_rest", "creature_reach" }) == Names { "rest", "reach" });
    CHECK(without_common_prefix({ "rest", "reach" }) == Names { "rest", "reach" });
    CHECK(without_common_prefix({ "a_", "a_b" }) == Names { "a_", "a_b" });
    CHECK(without_common_prefix({ "pose", "pose" }) == Names { "pose", "pose" });
}
