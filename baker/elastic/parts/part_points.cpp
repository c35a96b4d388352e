#include "elastic/parts/part_points.h"

#include <algorithm>
#include <cmath>

namespace pliant {
namespace {

// Largest number of sample points: so many per vertex, plus a constant that leaves room on small meshes.
constexpr double max_per_vertex = 2;
constexpr double max_constant = 20000;

double longest_edge(const Eigen::MatrixXd& columns, const Triangle& face)
{
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i)
        squared = std::max(squared, (columns.col(face[i]) - columns.col(face[(i + 1) % 3])).squaredNorm());
    return std::sqrt(squared);
}

// The number of steps into which an edge of this length is divided.
double steps_of(double length, double spacing) { return std::max(1.0, std::ceil(length / spacing)); }

// The points of the triangular lattices on all faces, without the corners.
double point_count(const std::vector<double>& lengths, double spacing)
{
    double count = 0;
    for (const double length : lengths) {
        const double steps = steps_of(length, spacing);
        count += (steps + 1) * (steps + 2) / 2 - 3;
    }
    return count;
}

// The smallest tried spacing that respects the limit on the number of points.
double allowed_spacing(const std::vector<double>& lengths, double vertex_count, double spacing)
{
    const double most = max_constant + max_per_vertex * vertex_count;
    constexpr double step = 1.25;
    while (point_count(lengths, spacing) > most) spacing *= step;
    return spacing;
}

// Calls visit(i, j, k) with i + j + k = steps for every lattice point but the corners.
template <class Visit> void visit_lattice(int steps, Visit visit)
{
    for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j)
            if (const int k = steps - i - j; std::max({ i, j, k }) != steps) visit(i, j, k);
}

} // namespace

PartPoints sample_parts(const Eigen::MatrixXd& vertices, const std::vector<Triangle>& faces, const Parts& parts,
                        double spacing)
{
    PartPoints out;
    out.of_part = parts.vertices;
    const Eigen::Index vertex_count = vertices.cols();
    std::vector<double> lengths;
    for (const Triangle& face : faces) lengths.push_back(longest_edge(vertices, face));
    spacing = allowed_spacing(lengths, double(vertex_count), spacing);
    out.columns.resize(vertices.rows(), vertex_count + Eigen::Index(point_count(lengths, spacing)));
    out.columns.leftCols(vertex_count) = vertices;
    out.faces.assign(std::size_t(vertex_count), no_face);
    for (std::uint32_t f = 0; f < lengths.size(); ++f) {
        const Triangle& face = faces[f];
        const int steps = int(steps_of(lengths[f], spacing));
        visit_lattice(steps, [&](int i, int j, int k) {
            const std::uint32_t column = std::uint32_t(out.faces.size());
            out.columns.col(column)
                = (double(k) * vertices.col(face[0]) + double(i) * vertices.col(face[1]) + double(j) * vertices.col(face[2]))
                / double(steps);
            out.of_part[parts.of_face[f]].push_back(column);
            out.faces.push_back(f);
        });
    }
    return out;
}

} // namespace pliant
