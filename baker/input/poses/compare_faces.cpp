#include "input/poses/compare_poses.h"

#include "base/mesh/renumbering.h"
#include "input/poses/check_surface.h"

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

} // namespace

bool check_same_vertex_count(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics)
{
    if (first.positions.rows() == other.positions.rows()) return true;
    diagnostics.add(
        error_at(3003, other.path,
                 fmt::format("has {} vertices, {} has {}", other.positions.rows(), first.path, first.positions.rows()),
                 "all poses must have the same mesh and differ in positions only: export them all from one mesh"));
    return false;
}

bool check_same_faces(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics)
{
    const Polygons &a = first.faces, &b = other.faces;
    const auto vertex_count = static_cast<std::size_t>(first.positions.rows());
    if (!check_same_vertex_count(first, other, diagnostics)) return false;
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
        diagnostics.add(error_at(
            3005, where_is_face(other, face),
            fmt::format("{}the same surface in a different order: {}", is_proven ? "is " : "seems to be ", difference),
            "vertices or faces were reordered: export with 'keep vertex order'"));
    } else {
        diagnostics.add(
            error_at(3004, where_is_face(other, face), fmt::format("has other faces: {}", difference),
                     "all poses must have the same mesh and differ in positions only: export them all from one mesh"));
    }
    return false;
}

} // namespace pliant
