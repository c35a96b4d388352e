#include "mesh/compare_poses.h"

#include "mesh/check_surface.h"

#include <algorithm>
#include <fmt/format.h>

namespace pliant {
namespace {

using Index = std::uint32_t;

// Faces without a repeated vertex only; others are equal if they are equal as they stand, which keeps this linear.
bool equal_up_to_rotation(const Index* a, const Index* b, std::size_t size)
{
    const Index* start = std::find(b, b + size, a[0]);
    if (start == b + size) return false;
    const auto head = static_cast<std::size_t>(b + size - start);
    return std::equal(start, b + size, a) && std::equal(b, start, a + head);
}

bool same_face(const Polygons& a, const Polygons& b, std::size_t face)
{
    return a.size(face) == b.size(face)
        && equal_up_to_rotation(&a.indices[a.offsets[face]], &b.indices[b.offsets[face]], a.size(face));
}

std::string corners_of(const Polygons& faces, std::size_t face)
{
    std::string text;
    for (std::size_t i = 0; i < faces.size(face) && i < 6; ++i)
        text += fmt::format("{}{}", i == 0 ? "" : " ", faces.indices[faces.offsets[face] + i]);
    return text + (faces.size(face) > 6 ? " ..." : "");
}

// If face f of one mesh is face f of the other, corner by corner, under one renumbering of the vertices.
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

std::uint64_t mix(std::uint64_t x) // the finaliser of splitmix64 (Steele, Lea, Flood 2014)
{
    x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
    x = (x ^ x >> 27) * 0x94d049bb133111ebu;
    return x ^ x >> 31;
}

// Colours of the vertices after a few rounds in which each learns what is around it (Weisfeiler and Leman 1968), sorted: equal for
// meshes that differ in numbering only, and different for nearly all others.
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

} // namespace

bool check_same_faces(const MeshFile& first, const MeshFile& other, FindingList& findings)
{
    const Polygons &a = first.faces, &b = other.faces;
    const auto vertex_count = static_cast<std::size_t>(first.positions.rows());
    if (first.positions.rows() != other.positions.rows()) {
        findings.add(
            error_at(3003, other.path,
                     fmt::format("has {} vertices, {} has {}", other.positions.rows(), first.path, first.positions.rows()),
                     "poses must be the same mesh in other positions: export them all from the same one"));
        return false;
    }
    std::size_t face = 0;
    const std::size_t common = std::min(a.count(), b.count());
    while (face < common && same_face(a, b, face)) ++face;
    if (face == common && a.count() == b.count()) return true;

    const bool is_proven = equal_under_row_renumbering(a, b, vertex_count);
    const bool is_likely
        = is_proven || (a.count() == b.count() && sorted_colours(a, vertex_count) == sorted_colours(b, vertex_count));
    const std::string difference = face < common
        ? fmt::format("face {} is {} here and {} in {}", face, corners_of(b, face), corners_of(a, face), first.path)
        : fmt::format("has {} faces, {} has {}", b.count(), first.path, a.count());
    if (is_likely) {
        findings.add(error_at(
            3005, where_is_face(other, face),
            fmt::format("{}the same surface with other numbers: {}", is_proven ? "is " : "seems to be ", difference),
            "vertices or faces were reordered: export with 'keep vertex order'"));
    } else {
        findings.add(error_at(3004, where_is_face(other, face), fmt::format("has other faces: {}", difference),
                              "poses must be the same mesh in other positions: export them all from the same one"));
    }
    return false;
}

} // namespace pliant
