#include "blend/surface.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <limits>

namespace pliant::player {
namespace {

long long nanoseconds_now()
{
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void add_layers(const pliant_asset& asset, const std::vector<double>& weights, std::vector<float>& q)
{
    const float* rest = pliant_asset_pose_coordinates(&asset, 0);
    std::copy(rest, rest + q.size(), q.begin());
    for (std::uint32_t k = 0; k < weights.size(); ++k) {
        const float* layer = pliant_asset_pose_coordinates(&asset, k + 1);
        const float weight = static_cast<float>(weights[k]);
        for (std::size_t j = 0; j < q.size(); ++j) q[j] += weight * (layer[j] - rest[j]);
    }
}

} // namespace

Stopwatch::Stopwatch()
    : start_(nanoseconds_now())
{
}

double Stopwatch::microseconds() const { return static_cast<double>(nanoseconds_now() - start_) * 1e-3; }

void blend_linearly(const pliant_asset& asset, const std::vector<double>& weights, std::vector<float>& q)
{
    if (asset.has_layers) {
        add_layers(asset, weights, q);
        return;
    }
    double sum = 0.0;
    for (double weight : weights) sum += weight;
    std::fill(q.begin(), q.end(), 0.0f);
    for (std::uint32_t k = 0; k < weights.size(); ++k) {
        const float* pose = pliant_asset_pose_coordinates(&asset, k);
        const float weight = static_cast<float>(weights[k] / sum);
        for (std::size_t j = 0; j < q.size(); ++j) q[j] += weight * pose[j];
    }
}

std::vector<double> weights_of_pose(const pliant_asset& asset, std::uint32_t pose)
{
    std::vector<double> weights(asset.weight_count, 0.0);
    if (!asset.has_layers) {
        weights[pose] = 1.0;
    } else if (pose > 0) {
        weights[pose - 1] = 1.0;
    }
    return weights;
}

void compute_normals(const pliant_asset& asset, const std::vector<glm::vec3>& positions, std::vector<Vertex>& vertices)
{
    for (Vertex& vertex : vertices) vertex.normal = glm::vec3(0.0f);
    const std::uint32_t *triangle = asset.triangles, *group = asset.smoothing_groups;
    for (std::uint32_t t = 0; t < asset.triangle_count; ++t, triangle += 3) {
        const glm::vec3 corner = positions[triangle[0]];
        const glm::vec3 normal = glm::cross(positions[triangle[1]] - corner, positions[triangle[2]] - corner);
        for (int i = 0; i < 3; ++i) vertices[group ? group[triangle[i]] : triangle[i]].normal += normal;
    }
    if (!group) return;
    // A group's number is its lowest vertex (formats/SPEC.md, SMTH), so the sum is at that vertex before others copy it.
    for (std::uint32_t v = 0; v < asset.vertex_count; ++v) vertices[v].normal = vertices[group[v]].normal;
}

void stand_on_floor(const glm::mat3& to_world, const std::vector<glm::vec3>& positions, std::vector<Vertex>& vertices)
{
    float floor = std::numeric_limits<float>::infinity();
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v].position = to_world * positions[v];
        vertices[v].normal = to_world * vertices[v].normal;
        floor = std::min(floor, vertices[v].position.y);
    }
    for (Vertex& vertex : vertices) vertex.position.y -= floor;
}

} // namespace pliant::player
