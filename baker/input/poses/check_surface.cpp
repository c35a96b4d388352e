#include "input/poses/check_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

// A triangle counts as flat if its height is below this part of its longest edge. Slivers of 0.25 degrees (4e-3) occur in
// good meshes. Below 1e-6 the metric of the triangle has a condition number above 1e12, and nothing of its energy is left in
// double precision. And rounding at a distance of 1e6 sizes from the origin, 1e-10, gives a flat triangle of a mesh with 1e4
// edges across a height of 1e-6 edges, so that its verdict is the same there.
constexpr double height_limit = 1e-6;

// Nor may a triangle be smaller than this part of the mean area: its stiffness per mass would be 1e10 times that of the
// others.
constexpr double area_limit = 1e-10;

// Spacing of the coordinates in units of the bounding box's diagonal above which details of a mesh suffer.
constexpr double coarse_spacing = 1e-5;

Eigen::Vector3d row(const Positions& positions, std::uint32_t vertex) { return positions.row(vertex).transpose(); }

// Area vector of a triangle: normal times area.
Eigen::Vector3d area_vector(const Positions& positions, const Triangle& t)
{
    const Eigen::Vector3d origin = row(positions, t[0]);
    return 0.5 * (row(positions, t[1]) - origin).cross(row(positions, t[2]) - origin);
}

double longest_edge(const Positions& positions, const Triangle& t)
{
    const Eigen::Vector3d a = row(positions, t[0]), b = row(positions, t[1]), c = row(positions, t[2]);
    return std::sqrt(std::max({ (b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm() }));
}

// Half of the longest side of the bounding box, in the units of the file.
double half_size(const Positions& positions)
{
    return (0.5 * positions.colwise().maxCoeff() - 0.5 * positions.colwise().minCoeff()).maxCoeff();
}

} // namespace

double coordinate_rounding(const Positions& positions)
{
    if (positions.size() == 0) return 0;
    const double largest = positions.cwiseAbs().maxCoeff();
    const bool is_single = (positions.cast<float>().cast<double>().array() == positions.array()).all();
    return largest * (is_single ? 0x1p-24 : 0x1p-53);
}

Positions to_unit_box(const Positions& positions)
{
    const Eigen::RowVector3d centre = 0.5 * positions.colwise().maxCoeff() + 0.5 * positions.colwise().minCoeff();
    const double unit = half_size(positions);
    Positions result = positions.rowwise() - centre;
    if (unit > 0) result /= unit;
    return result;
}

void check_precision(const MeshFile& mesh, DiagnosticList& diagnostics)
{
    const Eigen::RowVector3d size = mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff();
    const double spacing = 0x1p-23 * mesh.positions.cwiseAbs().maxCoeff(); // of floats, which assets and blends consist of
    const bool is_point = !(size.norm() > 0);                              // P2202 says it better
    if (is_point || spacing <= coarse_spacing * size.norm()) return;
    diagnostics.add(warning_at(2209, mesh.path,
                               fmt::format("is so far from the origin that blends are rounded to {:.2g}, {:.1g} of its size",
                                           spacing, spacing / size.norm()),
                               "move the character to the origin before you export it; the game can move it back"));
}

std::vector<FlatTriangle> find_flat_triangles(const MeshFile& mesh, const std::vector<Triangle>& triangles)
{
    const Positions positions = to_unit_box(mesh.positions);
    const double unit = half_size(mesh.positions);
    std::vector<double> areas(triangles.size());
    double mean_area = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        areas[t] = area_vector(positions, triangles[t]).norm();
        mean_area += areas[t] / static_cast<double>(triangles.size());
    }
    const double rounding = unit > 0 ? coordinate_rounding(mesh.positions) / unit : 0;
    std::vector<FlatTriangle> flat;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const double edge = longest_edge(positions, triangles[t]);
        const double height = edge > 0 ? 2 * areas[t] / edge : 0;
        if (height > std::max(height_limit * edge, rounding) && areas[t] > area_limit * mean_area) continue;
        flat.push_back({ t, height * unit, edge * unit });
    }
    return flat;
}

// A fan covers a polygon once only if the polygon is convex, or at least visible from its first corner.
void check_polygons(const MeshFile& mesh, const Triangulation& triangulation, DiagnosticList& diagnostics)
{
    const Positions positions = to_unit_box(mesh.positions);
    const std::vector<Triangle>& triangles = triangulation.triangles;
    for (std::size_t begin = 0, end = 0; begin < triangles.size(); begin = end) {
        const std::uint32_t face = triangulation.faces[begin];
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (; end < triangles.size() && triangulation.faces[end] == face; ++end)
            sum += area_vector(positions, triangles[end]);
        if (end - begin < 2) continue;
        for (std::size_t t = begin; t < end; ++t) {
            if (area_vector(positions, triangles[t]).dot(sum) > 0) continue;
            diagnostics.add(about_faces(
                warning_at(2210, where_is_face(mesh, face),
                           fmt::format("face {} is not convex: its triangles from the first corner overlap", face),
                           "triangulate it before you export it, the same way in all poses"),
                { face }));
            break;
        }
    }
}

void check_shape(const MeshFile& mesh, const Triangulation& triangulation, DiagnosticList& diagnostics)
{
    check_precision(mesh, diagnostics);
    check_polygons(mesh, triangulation, diagnostics);
}

std::string where_is_face(const MeshFile& mesh, std::size_t face)
{
    if (face >= mesh.face_lines.size()) return mesh.path;
    return mesh.path + ":" + std::to_string(mesh.face_lines[face]);
}

} // namespace pliant
