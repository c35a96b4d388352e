#include "input/poses/compare_poses.h"

#include "base/mesh/renumbering.h"
#include "base/mesh/solid.h"
#include "input/poses/check_solid.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

// Sorted, and whether that took an even number of exchanges.
std::pair<Tetrahedron, bool> sorted(Tetrahedron t)
{
    bool is_even = true;
    for (std::size_t i = 1; i < 4; ++i) {
        for (std::size_t k = i; k > 0 && t[k] < t[k - 1]; --k) {
            std::swap(t[k], t[k - 1]);
            is_even = !is_even;
        }
    }
    return { t, is_even };
}

// Tetrahedra as rows of four numbers: good for comparing rows, and no faces of anything.
Polygons to_rows(const std::vector<Tetrahedron>& tets)
{
    Polygons rows;
    for (const Tetrahedron& tet : tets) {
        rows.indices.insert(rows.indices.end(), tet.begin(), tet.end());
        rows.offsets.push_back(static_cast<std::uint32_t>(rows.indices.size()));
    }
    return rows;
}

// All faces of all tetrahedra, those inside twice.
Polygons to_faces(const std::vector<Tetrahedron>& tets)
{
    std::vector<Triangle> triangles;
    for (const Tetrahedron& tet : tets) {
        for (const auto& corners : tet_faces) triangles.push_back({ tet[corners[0]], tet[corners[1]], tet[corners[2]] });
    }
    return to_polygons(triangles);
}

// Of two solids with the same tetrahedra, of which `b` has materials. Of moduli only ratios matter.
bool has_same_materials(const SolidRegions& a, const SolidRegions& b)
{
    if (a.of_tet.empty()) return false;
    const auto material = [](const SolidRegions& regions, std::size_t tet) -> const SolidMaterial& {
        return regions.materials[regions.of_tet[tet]];
    };
    const double unit_a = material(a, 0).young, unit_b = material(b, 0).young;
    for (std::size_t tet = 0; tet < a.of_tet.size(); ++tet) {
        const SolidMaterial &x = material(a, tet), &y = material(b, tet);
        constexpr double digits = 1e-6; // that a file may have lost
        if (std::abs(x.poisson - y.poisson) > digits
            || std::abs(x.young / unit_a - y.young / unit_b) > digits * x.young / unit_a)
            return false;
    }
    return true;
}

} // namespace

void check_same_materials(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics)
{
    if (other.regions.of_tet.empty() || has_same_materials(first.regions, other.regions)) return;
    diagnostics.add(warning_at(3015, other.path,
                               fmt::format("has materials that are not used: {} has {}", first.path,
                                           first.regions.of_tet.empty() ? "none" : "others"),
                               "the first pose gives the materials: name the file that has them first"));
}

bool check_same_kind(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics)
{
    if (first.tets.empty() == other.tets.empty()) return true;
    const auto kind = [](const MeshFile& mesh) { return mesh.tets.empty() ? "a surface" : "a solid of tetrahedra"; };
    diagnostics.add(error_at(3012, other.path, fmt::format("is {}, {} is {}", kind(other), first.path, kind(first)),
                             "all poses must be surfaces, or all must be solids"));
    return false;
}

bool check_same_tets(const MeshFile& first, const MeshFile& other, DiagnosticList& diagnostics)
{
    if (!check_same_vertex_count(first, other, diagnostics)) return false;
    const std::vector<Tetrahedron>&a = first.tets, &b = other.tets;
    std::size_t tet = 0;
    const std::size_t common = std::min(a.size(), b.size());
    while (tet < common && (a[tet] == b[tet] || sorted(a[tet]) == sorted(b[tet]))) ++tet;
    if (tet == common && a.size() == b.size()) return true;

    const auto vertex_count = static_cast<std::size_t>(first.positions.rows());
    const bool is_proven = equal_under_row_renumbering(to_rows(a), to_rows(b), vertex_count);
    const bool is_likely = is_proven
        || (a.size() == b.size() && sorted_colours(to_faces(a), vertex_count) == sorted_colours(to_faces(b), vertex_count));
    const std::string difference = tet < common
        ? fmt::format("tetrahedron {} is {} here and {} in {}", tet, corners_of(b[tet]), corners_of(a[tet]), first.path)
        : fmt::format("has {} tetrahedra, {} has {}", b.size(), first.path, a.size());
    if (is_likely) {
        diagnostics.add(error_at(
            3005, where_is_tet(other, tet),
            fmt::format("{}the same solid in a different order: {}", is_proven ? "is " : "seems to be ", difference),
            "vertices or tetrahedra were reordered: export all poses from the same mesh"));
    } else {
        diagnostics.add(
            error_at(3004, where_is_tet(other, tet), fmt::format("has other tetrahedra: {}", difference),
                     "all poses must have the same mesh and differ in positions only: export them all from one mesh"));
    }
    return false;
}

} // namespace pliant
