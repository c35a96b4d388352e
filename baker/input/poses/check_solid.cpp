#include "input/poses/check_solid.h"

#include "input/poses/check_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pliant {
namespace {

// A tetrahedron has practically no volume below this part of its longest edge cubed (a regular one has 0.12, the worst of
// the meshes that we know 1e-3). Its energy is made of the inverse of the matrix E of its edges, squared. With all edges up
// to L the product of the two larger singular values of E is at most 1.5 L^2 and the largest 1.7 L, so a volume of 1e-6 L^3
// keeps the condition of E below 4.4e5 and that of its square below 2e11: four digits of the energy are left in double
// precision.
constexpr double volume_limit = 1e-6;

// Nor may a tetrahedron be smaller than this part of the mean volume: in lengths, 1e-5. See area_limit for triangles.
constexpr double relative_volume_limit = 1e-15;

// Beyond this ratio bakes took ten times as long as with one material, and missed their tolerance.
constexpr double most_stiffness = 1e4;

bool has_repeated_vertex(Tetrahedron t)
{
    std::sort(t.begin(), t.end());
    return std::adjacent_find(t.begin(), t.end()) != t.end();
}

struct TetShape {
    double volume = 0; // with its sign
    double edge = 0;   // the longest
};

TetShape shape_of(const Positions& positions, const Tetrahedron& t)
{
    std::array<Eigen::Vector3d, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = positions.row(t[i]).transpose();
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t k = 0; k < i; ++k) longest = std::max(longest, (x[i] - x[k]).squaredNorm());
    }
    return { (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0])) / 6, std::sqrt(longest) };
}

// The volumes of a pose in units of its box, and which of them are practically none.
struct Volumes {
    double unit = 1; // of length
    std::vector<TetShape> shapes;
    std::vector<bool> is_flat;
    std::size_t flat_count = 0, negative_count = 0;
};

Volumes measure(const MeshFile& mesh)
{
    Volumes result;
    const Positions positions = to_unit_box(mesh.positions);
    result.unit = (0.5 * mesh.positions.colwise().maxCoeff() - 0.5 * mesh.positions.colwise().minCoeff()).maxCoeff();
    const double rounding = result.unit > 0 ? coordinate_rounding(mesh.positions) / result.unit : 0;
    double mean = 0;
    for (const Tetrahedron& tet : mesh.tets) {
        result.shapes.push_back(shape_of(positions, tet));
        mean += std::abs(result.shapes.back().volume) / static_cast<double>(mesh.tets.size());
    }
    result.is_flat.resize(mesh.tets.size(), false);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto& [volume, edge] = result.shapes[t];
        // Rounding moves a corner by this much across a face of at most half an edge squared.
        const double least = std::max(volume_limit * edge, rounding) * edge * edge;
        const bool is_flat = !(std::abs(volume) > least && std::abs(volume) > relative_volume_limit * mean);
        result.is_flat[t] = is_flat;
        result.flat_count += is_flat;
        result.negative_count += !is_flat && volume < 0;
    }
    return result;
}

} // namespace

std::string corners_of(const Tetrahedron& t) { return fmt::format("{} {} {} {}", t[0], t[1], t[2], t[3]); }

void check_stiffness(const MeshFile& mesh, DiagnosticList& diagnostics)
{
    double softest = std::numeric_limits<double>::infinity(), stiffest = 0;
    for (const std::uint32_t material : mesh.regions.of_tet) {
        softest = std::min(softest, mesh.regions.materials[material].young);
        stiffest = std::max(stiffest, mesh.regions.materials[material].young);
    }
    if (!(stiffest > most_stiffness * softest)) return;
    diagnostics.add(warning_at(3016, mesh.path,
                               fmt::format("its stiffest material is {:.2g} times as stiff as its softest (above {:.0f})",
                                           stiffest / softest, most_stiffness),
                               "the bake takes long and may miss its tolerance: 1,000 times is as good as rigid"));
}

std::string where_is_tet(const MeshFile& mesh, std::size_t tet)
{
    if (tet >= mesh.tet_lines.size()) return mesh.path;
    return mesh.path + ":" + std::to_string(mesh.tet_lines[tet]);
}

void orient_tets(std::vector<MeshFile>& meshes, DiagnosticList& diagnostics)
{
    const Volumes volumes = measure(meshes[0]);
    const std::size_t count = meshes[0].tets.size();
    if (volumes.negative_count == 0 || volumes.negative_count + volumes.flat_count != count) return;
    for (MeshFile& mesh : meshes) {
        for (Tetrahedron& tet : mesh.tets) std::swap(tet[2], tet[3]);
    }
    diagnostics.add(warning_at(
        2214, meshes[0].path, fmt::format("all {} tetrahedra have the opposite orientation: reversed in all poses", count),
        "harmless if the program that wrote the file uses that convention; if it flipped an axis, export again"));
}

bool check_volumes(const MeshFile& mesh, const MeshFile* first, DiagnosticList& diagnostics)
{
    check_precision(mesh, diagnostics);
    const Volumes volumes = measure(mesh);
    const double unit3 = volumes.unit * volumes.unit * volumes.unit;
    if (first && volumes.negative_count != 0 && volumes.negative_count + volumes.flat_count == mesh.tets.size()) {
        diagnostics.add(error_at(3007, mesh.path,
                                 fmt::format("is mirrored relative to {}: all its tetrahedra are inside out", first->path),
                                 "the export flipped an axis of one of the two: export both in the same way"));
        return false;
    }
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto& [volume, edge] = volumes.shapes[t];
        if (has_repeated_vertex(mesh.tets[t])) continue; // P2211 says it better
        if (volumes.is_flat[t]) {
            diagnostics.add(error_at(2212, where_is_tet(mesh, t),
                                     fmt::format("tetrahedron {} ({}) has no volume: {:.3g} with an edge of {:.3g}", t,
                                                 corners_of(mesh.tets[t]), volume * unit3, edge * volumes.unit),
                                     "move its corners apart in this pose, or remove it from all poses"));
        } else if (volume < 0) {
            diagnostics.add(
                error_at(2213, where_is_tet(mesh, t),
                         fmt::format("tetrahedron {} ({}) is inverted: its volume is {:.3g}", t, corners_of(mesh.tets[t]),
                                     volume * unit3),
                         "repair the pose; if the tetrahedron is inverted in all poses, repair the order of its vertices"));
        }
    }
    return volumes.flat_count == 0 && volumes.negative_count == 0;
}

} // namespace pliant
