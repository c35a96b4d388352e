#include "mesh/part_points.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Points of faces there may be: a share of the vertices, and some for the smallest mesh.
constexpr double most_per_vertex = 2;
constexpr double most_beside = 20000;

double longest_edge(const Eigen::MatrixXd& columns, const Triangle& face)
{
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i)
        squared = std::max(squared, (columns.col(face[i]) - columns.col(face[(i + 1) % 3])).squaredNorm());
    return std::sqrt(squared);
}

// Into how many steps an edge of this length is cut.
double steps_of(double length, double spacing) { return std::max(1.0, std::ceil(length / spacing)); }

// Of a lattice over a triangle, `steps` to each edge, all but the corners.
double points_of(double steps) { return (steps + 1) * (steps + 2) / 2 - 3; }

// The spacing with which the points do not become too many.
double allowed_spacing(const std::vector<double>& lengths, double vertex_count, double spacing)
{
    const double most = most_beside + most_per_vertex * vertex_count;
    constexpr double step = 1.25;
    for (;; spacing *= step) {
        double count = 0;
        for (const double length : lengths) count += points_of(steps_of(length, spacing));
        if (count <= most) return spacing;
    }
}

} // namespace

PartPoints sample_parts(const ShapeSet& set, const Parts& parts, double spacing)
{
    PartPoints out;
    out.columns = pose_space(set);
    out.of_part = parts.vertices;
    const Eigen::Index vertex_count = out.columns.cols();
    std::vector<double> lengths;
    for (const Triangle& face : set.triangles) lengths.push_back(longest_edge(out.columns, face));
    spacing = allowed_spacing(lengths, double(vertex_count), spacing);
    double count = 0;
    for (const double length : lengths) count += points_of(steps_of(length, spacing));
    out.columns.conservativeResize(Eigen::NoChange, vertex_count + Eigen::Index(count));
    out.faces.assign(std::size_t(vertex_count), no_face);
    for (std::uint32_t f = 0; f < lengths.size(); ++f) {
        const Triangle& face = set.triangles[f];
        const int steps = int(steps_of(lengths[f], spacing));
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                if (std::max({ i, j, steps - i - j }) == steps) continue;
                const std::uint32_t column = std::uint32_t(out.faces.size());
                out.columns.col(column) = (double(steps - i - j) * out.columns.col(face[0])
                                           + double(i) * out.columns.col(face[1]) + double(j) * out.columns.col(face[2]))
                    / double(steps);
                out.of_part[parts.of_face[f]].push_back(column);
                out.faces.push_back(f);
            }
    }
    return out;
}

} // namespace pliant
