#include "output/asset/vertex_tiles.h"

#include "pliant_format.h"

#include <algorithm>
#include <map>
#include <numeric>

namespace pliant {

namespace {

constexpr std::size_t tile_size = PLIANT_FORMAT_COMPACT_VERTICES, most_at_place = 1024;

Eigen::Vector3d at(const Eigen::VectorXd& rest, std::uint32_t v) { return rest.segment<3>(3 * Eigen::Index(v)); }

// By one coordinate, then by the others: vertices at the same place become neighbours.
void sort_along(const Eigen::VectorXd& rest, VertexTile& vertices, int axis)
{
    std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
        for (int c = 0; c < 3; ++c) {
            const Eigen::Index k = (axis + c) % 3, i = 3 * Eigen::Index(a) + k, j = 3 * Eigen::Index(b) + k;
            if (rest[i] != rest[j]) return rest[i] < rest[j];
        }
        return a < b;
    });
}

// Whether a vertex has the place of a vertex of another block.
std::vector<bool> shared_places(const Eigen::VectorXd& rest, std::uint32_t vertices_per_block)
{
    VertexTile vertices(std::size_t(rest.size() / 3));
    std::iota(vertices.begin(), vertices.end(), 0U);
    std::vector<bool> is_shared(vertices.size());
    if (vertices.size() <= vertices_per_block) return is_shared;
    sort_along(rest, vertices, 0);
    for (std::size_t first = 0, last = 0; first < vertices.size(); first = last) { // ascending at a place
        while (last < vertices.size() && at(rest, vertices[last]) == at(rest, vertices[first])) ++last;
        if (vertices[first] / vertices_per_block == vertices[last - 1] / vertices_per_block) continue;
        for (std::size_t i = first; i < last; ++i) is_shared[vertices[i]] = true;
    }
    return is_shared;
}

class Cutter {
public:
    Cutter(const Eigen::VectorXd& rest, std::vector<VertexTile>& tiles)
        : rest_(rest)
        , tiles_(tiles)
    {
    }

    void cut(VertexTile vertices)
    {
        std::size_t place = 0;
        if (vertices.size() > tile_size) {
            sort_along(rest_, vertices, widest_axis(vertices));
            place = place_to_cut(vertices, (vertices.size() + tile_size - 1) / tile_size / 2 * tile_size);
        }
        if (place == 0) {
            std::sort(vertices.begin(), vertices.end());
            tiles_.push_back(std::move(vertices));
            return;
        }
        const auto middle = vertices.begin() + std::ptrdiff_t(place);
        cut({ vertices.begin(), middle });
        cut({ middle, vertices.end() });
    }

private:
    int widest_axis(const VertexTile& vertices) const
    {
        Eigen::Vector3d low = at(rest_, vertices[0]), high = low;
        for (std::uint32_t v : vertices) {
            low = low.cwiseMin(at(rest_, v));
            high = high.cwiseMax(at(rest_, v));
        }
        int axis = 0;
        (high - low).maxCoeff(&axis);
        return axis;
    }

    // The nearest place to `wished` that separates no vertices at the same place, first before it; 0 if there is none.
    std::size_t place_to_cut(const VertexTile& vertices, std::size_t wished) const
    {
        const Eigen::Vector3d there = at(rest_, vertices[wished]);
        std::size_t first = wished, last = wished;
        while (first > 0 && at(rest_, vertices[first - 1]) == there) --first;
        if (first > 0) return first;
        while (last < vertices.size() && at(rest_, vertices[last]) == there) ++last;
        if (last < vertices.size()) return last;
        return vertices.size() > most_at_place ? wished : 0;
    }

    const Eigen::VectorXd& rest_;
    std::vector<VertexTile>& tiles_;
};

} // namespace

std::vector<VertexTile> cut_tiles(const Eigen::VectorXd& rest, std::uint32_t vertices_per_block,
                                  const std::function<int(std::uint32_t)>& kind_of)
{
    const auto n = std::uint32_t(rest.size() / 3);
    const std::vector<bool> is_shared = shared_places(rest, vertices_per_block);
    std::vector<VertexTile> tiles;
    Cutter cutter(rest, tiles);
    std::map<int, VertexTile> shared;
    for (std::uint32_t first = 0; first < n; first += vertices_per_block) {
        std::map<int, VertexTile> kinds;
        for (std::uint32_t v = first; v < std::min(n, first + vertices_per_block); ++v)
            (is_shared[v] ? shared : kinds)[kind_of(v)].push_back(v);
        for (auto& [kind, vertices] : kinds) cutter.cut(std::move(vertices));
    }
    for (auto& [kind, vertices] : shared) cutter.cut(std::move(vertices));
    return tiles;
}

} // namespace pliant
