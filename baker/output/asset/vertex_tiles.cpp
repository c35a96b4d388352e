#include "output/asset/vertex_tiles.h"

#include "pliant_format.h"

#include <algorithm>
#include <map>

namespace pliant {

namespace {

constexpr std::size_t tile_size = PLIANT_FORMAT_COMPACT_VERTICES;

class Cutter {
public:
    Cutter(const Eigen::VectorXd& rest, std::vector<VertexTile>& tiles)
        : rest_(rest)
        , tiles_(tiles)
    {
    }

    void cut(VertexTile vertices)
    {
        if (vertices.size() <= tile_size) {
            std::sort(vertices.begin(), vertices.end());
            tiles_.push_back(std::move(vertices));
            return;
        }
        sort_along(vertices, widest_axis(vertices));
        const std::size_t tile_count = (vertices.size() + tile_size - 1) / tile_size;
        const auto middle = vertices.begin() + std::ptrdiff_t(place_to_cut(vertices, tile_count / 2 * tile_size));
        cut({ vertices.begin(), middle });
        cut({ middle, vertices.end() });
    }

private:
    Eigen::Vector3d at(std::uint32_t v) const { return rest_.segment<3>(3 * Eigen::Index(v)); }

    int widest_axis(const VertexTile& vertices) const
    {
        Eigen::Vector3d low = at(vertices[0]), high = low;
        for (std::uint32_t v : vertices) {
            low = low.cwiseMin(at(v));
            high = high.cwiseMax(at(v));
        }
        int axis = 0;
        (high - low).maxCoeff(&axis);
        return axis;
    }

    // By one coordinate, then by the others: vertices at the same place become neighbours.
    void sort_along(VertexTile& vertices, int axis) const
    {
        std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
            for (int c = 0; c < 3; ++c) {
                const int k = (axis + c) % 3;
                if (at(a)[k] != at(b)[k]) return at(a)[k] < at(b)[k];
            }
            return a < b;
        });
    }

    // `wished`, or before it, where it would separate vertices at the same place. More than a tile of them are separated.
    std::size_t place_to_cut(const VertexTile& vertices, std::size_t wished) const
    {
        std::size_t place = wished;
        while (place > 0 && wished - place < tile_size && at(vertices[place - 1]) == at(vertices[place])) --place;
        return place == 0 || wished - place == tile_size ? wished : place;
    }

    const Eigen::VectorXd& rest_;
    std::vector<VertexTile>& tiles_;
};

} // namespace

std::vector<std::vector<VertexTile>> cut_tiles(const Eigen::VectorXd& rest, std::uint32_t block_vertices,
                                               const std::function<int(std::uint32_t)>& kind_of)
{
    const auto n = std::uint32_t(rest.size() / 3);
    std::vector<std::vector<VertexTile>> blocks;
    for (std::uint32_t first = 0; first < n; first += block_vertices) {
        std::map<int, VertexTile> kinds;
        for (std::uint32_t v = first; v < std::min(n, first + block_vertices); ++v) kinds[kind_of(v)].push_back(v);
        Cutter cutter(rest, blocks.emplace_back());
        for (auto& [kind, vertices] : kinds) cutter.cut(std::move(vertices));
    }
    return blocks;
}

} // namespace pliant
