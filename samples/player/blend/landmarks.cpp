#include "blend/landmarks.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::player {
namespace {

// Vertices. Of a factored basis each range costs as much as the whole units that it touches.
std::uint32_t tile_size_of(const pliant_asset& asset) { return std::max(64u, pliant_range_unit(&asset)); }

std::vector<glm::vec3> rebuilt(const pliant_asset& asset, const std::vector<float>& q)
{
    std::vector<glm::vec3> positions(asset.vertex_count);
    pliant_reconstruct(&asset, q.data(), 0, asset.vertex_count, &positions[0].x, sizeof positions[0]);
    return positions;
}

// The step along each coordinate with which its column is measured: as large as blends make the coordinate. A smaller
// step would measure rounding, a larger one would lose digits of the other coordinates.
std::vector<float> steps_of(const pliant_asset& asset)
{
    float farthest = 0.0f; // over all poses and coordinates, for assets that store no limits
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) {
        const float* pose = pliant_asset_pose_coordinates(&asset, k);
        for (std::uint32_t j = 0; j < asset.dimension; ++j) farthest = std::max(farthest, std::abs(pose[j]));
    }
    std::vector<float> steps;
    for (std::uint32_t j = 0; j < asset.dimension; ++j) {
        pliant_column column {};
        pliant_asset_column(&asset, j, &column);
        steps.push_back(column.limit > 0.0f ? column.limit : farthest > 0.0f ? farthest : 1.0f);
    }
    return steps;
}

} // namespace

Landmarks::Landmarks(const pliant_asset& asset, const glm::mat3& to_world,
                     const std::vector<std::vector<std::uint32_t>>& groups)
    : asset_(asset)
    , up_(to_world[0].y, to_world[1].y, to_world[2].y)
    , tile_size_(tile_size_of(asset))
    , columns_(1 + static_cast<std::size_t>(asset.dimension))
    , groups_(groups)
    , means_(groups.size() * columns_)
    , bottoms_((asset.vertex_count + tile_size_ - 1) / tile_size_)
    , positions_(tile_size_)
{
    centres_.resize(bottoms_.size() * columns_);
    radii_.resize(bottoms_.size() * columns_);
    std::vector<float> q(asset.dimension, 0.0f);
    const std::vector<glm::vec3> origin = rebuilt(asset, q);
    probe(origin, std::vector<glm::vec3>(origin.size(), glm::vec3(0.0f)), 1.0f, 0);
    const std::vector<float> steps = steps_of(asset);
    for (std::uint32_t j = 0; j < asset.dimension; ++j) {
        q[j] = steps[j];
        probe(rebuilt(asset, q), origin, steps[j], 1 + static_cast<std::size_t>(j));
        q[j] = 0.0f;
    }
}

// The effect of one column, per unit of its coordinate, on the heights in each tile and on the means.
void Landmarks::probe(const std::vector<glm::vec3>& shape, const std::vector<glm::vec3>& origin, float step,
                      std::size_t column)
{
    for (std::size_t tile = 0; tile < bottoms_.size(); ++tile) {
        float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
        for (std::size_t v = tile * tile_size_; v < std::min((tile + 1) * tile_size_, shape.size()); ++v) {
            const float height = glm::dot(up_, shape[v] - origin[v]) / step;
            low = std::min(low, height);
            high = std::max(high, height);
        }
        centres_[tile * columns_ + column] = 0.5f * (low + high);
        radii_[tile * columns_ + column] = 0.5f * (high - low);
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        glm::dvec3 sum(0.0);
        for (std::uint32_t v : groups_[g]) sum += glm::dvec3(shape[v] - origin[v]);
        means_[g * columns_ + column]
            = glm::vec3(sum / (static_cast<double>(groups_[g].size()) * static_cast<double>(step)));
    }
}

float Landmarks::lowest_of_tile(const float* q, std::uint32_t tile)
{
    const std::uint32_t first = tile * tile_size_, count = std::min(tile_size_, asset_.vertex_count - first);
    pliant_reconstruct(&asset_, q, first, count, &positions_[0].x, sizeof positions_[0]);
    float lowest = std::numeric_limits<float>::max();
    for (std::uint32_t i = 0; i < count; ++i) lowest = std::min(lowest, glm::dot(up_, positions_[i]));
    return lowest;
}

// Visits tiles in the order of their lower bounds, until no bound is below the lowest height found. The bounds are
// rounded by about a millionth of the height, so a tile that is skipped wrongly moves the floor by no more than that.
float Landmarks::lowest(const float* q)
{
    for (std::size_t tile = 0; tile < bottoms_.size(); ++tile) {
        const float *centres = &centres_[tile * columns_], *radii = &radii_[tile * columns_];
        float centre = centres[0], radius = radii[0];
        for (std::size_t j = 1; j < columns_; ++j) {
            centre += q[j - 1] * centres[j];
            radius += std::abs(q[j - 1]) * radii[j];
        }
        bottoms_[tile] = { centre - radius, static_cast<std::uint32_t>(tile) };
    }
    std::sort(bottoms_.begin(), bottoms_.end());
    float lowest = std::numeric_limits<float>::max();
    rebuilt_tiles_ = 0;
    for (const auto& [bottom, tile] : bottoms_) {
        if (bottom >= lowest) break;
        lowest = std::min(lowest, lowest_of_tile(q, tile));
        ++rebuilt_tiles_;
    }
    return lowest;
}

void Landmarks::means(const float* q, std::vector<glm::vec3>& result) const
{
    result.resize(groups_.size());
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const glm::vec3* columns = &means_[g * columns_];
        result[g] = columns[0];
        for (std::size_t j = 1; j < columns_; ++j) result[g] += q[j - 1] * columns[j];
    }
}

} // namespace pliant::player
