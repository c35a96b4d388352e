#include "base/mesh/renumbering.h"

#include <algorithm>

namespace pliant {
namespace {

using Index = std::uint32_t;

std::uint64_t mix(std::uint64_t x) // the finaliser of splitmix64 (Steele, Lea, Flood 2014)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

} // namespace

bool equal_under_row_renumbering(const Polygons& a, const Polygons& b, std::size_t vertex_count)
{
    if (a.offsets != b.offsets) return false;
    constexpr Index unknown = UINT32_MAX;
    std::vector<Index> forth(vertex_count, unknown), back(vertex_count, unknown);
    for (std::size_t i = 0; i < a.indices.size(); ++i) {
        Index& to = forth[a.indices[i]];
        Index& from = back[b.indices[i]];
        if (to == unknown && from == unknown) {
            to = b.indices[i];
            from = a.indices[i];
        } else if (to != b.indices[i] || from != a.indices[i]) {
            return false;
        }
    }
    return true;
}

std::vector<std::uint64_t> sorted_colours(const Polygons& faces, std::size_t vertex_count)
{
    constexpr int rounds = 6;
    std::vector<std::uint64_t> colours(vertex_count, 1);
    for (int round = 0; round < rounds; ++round) {
        std::vector<std::uint64_t> next(vertex_count, 0);
        for (std::size_t face = 0; face < faces.count(); ++face) {
            const Index* corners = &faces.indices[faces.offsets[face]];
            const std::size_t size = faces.size(face);
            for (std::size_t i = 0; i < size; ++i) {
                const std::uint64_t after = colours[corners[(i + 1) % size]],
                                    before = colours[corners[(i + size - 1) % size]];
                next[corners[i]] += mix(mix(after) + 3 * mix(before + size)); // a sum does not see the order of the faces
            }
        }
        for (std::size_t v = 0; v < vertex_count; ++v) colours[v] = mix(colours[v] + next[v]);
    }
    std::sort(colours.begin(), colours.end());
    return colours;
}

} // namespace pliant
