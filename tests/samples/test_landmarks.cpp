// Compares Landmarks with computations on all vertices, and checks the order of blended parts.
#include "blend/asset_file.h"
#include "blend/landmarks.h"
#include "draw/layers.h"

#include <doctest/doctest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

using namespace pliant::player;

namespace {

const glm::mat3 z_up { { 1.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, -1.0f }, { 0.0f, 1.0f, 0.0f } };
constexpr float tolerance = 1e-5f; // of the size of the shape: tens of roundings in single precision

std::vector<glm::vec3> rebuilt(const pliant_asset& asset, const std::vector<float>& q)
{
    std::vector<glm::vec3> positions(asset.vertex_count);
    pliant_reconstruct(&asset, q.data(), 0, asset.vertex_count, &positions[0].x, sizeof positions[0]);
    return positions;
}

// Between poses and a little outside.
std::vector<float> random_coordinates(const pliant_asset& asset, std::mt19937& random)
{
    std::uniform_real_distribution<float> number(-0.3f, 1.0f);
    std::vector<float> q(asset.dimension, 0.0f);
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) {
        const float weight = number(random);
        for (std::uint32_t j = 0; j < asset.dimension; ++j) q[j] += weight * pliant_asset_pose_coordinates(&asset, k)[j];
    }
    return q;
}

void compare(const pliant_asset& asset, const glm::mat3& to_world)
{
    const std::vector<std::vector<std::uint32_t>> groups { { 0 }, { 1, 3, 4, asset.vertex_count - 1 } };
    Landmarks landmarks(asset, to_world, groups);
    std::mt19937 random(7);
    std::vector<glm::vec3> means;
    for (int i = 0; i < 50; ++i) {
        const std::vector<float> q = random_coordinates(asset, random);
        const std::vector<glm::vec3> positions = rebuilt(asset, q);
        float lowest = std::numeric_limits<float>::max(), size = 0.0f;
        for (const glm::vec3& position : positions) {
            lowest = std::min(lowest, (to_world * position).y);
            size = std::max(size, glm::length(position));
        }
        CHECK(std::abs(landmarks.lowest(q.data()) - lowest) <= tolerance * size);
        CHECK(landmarks.rebuilt_tiles() >= 1);
        landmarks.means(q.data(), means);
        REQUIRE(means.size() == groups.size());
        for (std::size_t g = 0; g < groups.size(); ++g) {
            glm::vec3 mean(0.0f);
            for (std::uint32_t v : groups[g]) mean += positions[v] / static_cast<float>(groups[g].size());
            CHECK(glm::distance(means[g], mean) <= tolerance * size);
        }
    }
}

Actor actor_at(const std::vector<Vertex>& vertices, float z) { return { &vertices, { 0.0f, 0.0f, z }, {}, nullptr }; }

} // namespace

TEST_CASE("floor and means of parts without rebuilding all vertices")
{
    for (const char* name :
         { "strip_neo", "tube_neo", "tube_compact", "tube_compact_fine", "tube_factored", "beam_mooney" }) {
        CAPTURE(name);
        const AssetFile file(std::string(PLIANT_TINY_ASSETS) + "/" + name + ".pliant");
        compare(file.view(), glm::mat3(1.0f));
        compare(file.view(), z_up);
    }
}

TEST_CASE("tiles that cannot have the lowest vertex are not rebuilt")
{
    // Tubes in five layers, one above the other, z up: only tiles of the lowest layer are rebuilt.
    const AssetFile file(PLIANT_LARGE_ASSET);
    Landmarks landmarks(file.view(), z_up, {});
    landmarks.lowest(pliant_asset_pose_coordinates(&file.view(), 1));
    CHECK(landmarks.tile_count() > 20);
    CHECK(landmarks.rebuilt_tiles() < landmarks.tile_count() / 2);
    compare(file.view(), z_up);
}

TEST_CASE("blended parts from back to front, of all actors")
{
    // The camera looks along -z: a larger z is nearer.
    const std::vector<Vertex> vertices { { { 0, 0, 0 } }, { { 0, 0, 1 } }, { { 0, 0, 3 } }, { { 9, 9, 5 } } };
    const std::vector<Actor> actors { actor_at(vertices, 0.0f), actor_at(vertices, -10.0f) };
    const std::vector<std::vector<std::uint32_t>> parts { { 1, 2 }, { 0 } }; // means at z = 2 and 0
    const std::vector<Layer> layers = layers_of(glm::mat4(1.0f), actors, parts);
    REQUIRE(layers.size() == 4);
    const std::size_t order[4][2] = { { 1, 1 }, { 1, 0 }, { 0, 1 }, { 0, 0 } }; // actor, part
    for (std::size_t i = 0; i < 4; ++i) {
        CAPTURE(i);
        CHECK(layers[i].actor == order[i][0]);
        CHECK(layers[i].blended == order[i][1]);
    }
    CHECK(layers[0].depth == 10.0f);

    // A built shape provides the centres of its parts, in its own axes.
    BuiltShape built;
    built.placing[3] = { 0.0f, 0.0f, -20.0f, 1.0f };
    built.blended_centres = { { 0, 0, 1 }, { 0, 0, 2 } };
    const std::vector<Layer> with_built
        = layers_of(glm::mat4(1.0f), { actors[0], { nullptr, glm::vec3(0.0f), {}, &built } }, parts);
    CHECK(with_built[0].actor == 1);
    CHECK(with_built[0].blended == 0);
    CHECK(with_built[0].depth == 19.0f);
    CHECK(layers_of(glm::mat4(1.0f), actors, {}).empty());
}
