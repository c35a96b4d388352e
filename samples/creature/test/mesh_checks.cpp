#include "mesh_checks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

namespace pliant::creature {
namespace {

using HalfEdges = std::map<std::pair<int, int>, int>; // (origin, target) -> opposite vertex

HalfEdges half_edges_of(const std::vector<Face>& faces)
{
    HalfEdges result;
    for (const Face& f : faces)
        for (int i = 0; i < 3; ++i) result.emplace(std::pair(f[i], f[(i + 1) % 3]), f[(i + 2) % 3]);
    return result;
}

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// The dihedral angle of Pliant's hinges: 0 when flat.
double dihedral(const Vec3& x0, const Vec3& x1, const Vec3& x2, const Vec3& x3)
{
    const Vec3 e = x1 - x0, n1 = e.cross(x2 - x0), n2 = (x3 - x0).cross(e);
    return std::atan2(e.dot(n1.cross(n2)) / e.norm(), n1.dot(n2));
}

// True if the open segment pq passes through the triangle (Moeller and Trumbore).
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c)
{
    const Vec3 d = q - p, e1 = b - a, e2 = c - a, h = d.cross(e2);
    const double det = e1.dot(h);
    if (det == 0.0) return false; // parallel: another edge shows the crossing
    const Vec3 s = p - a, k = s.cross(e1);
    const double u = s.dot(h) / det, v = d.dot(k) / det, t = e2.dot(k) / det;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 && t < 1.0;
}

// Edges that pierce faces, found with a grid whose cells are as large as the longest edge.
std::vector<std::array<int, 2>> find_crossings(const std::vector<Vec3>& points, const std::vector<Face>& faces,
                                               const HalfEdges& edges, double cell)
{
    using Cell = std::tuple<int, int, int>;
    const auto for_cells = [&](const Vec3& low, const Vec3& high, const std::function<void(const Cell&)>& visit) {
        const Eigen::Vector3i a = (low / cell).array().floor().cast<int>(), b = (high / cell).array().floor().cast<int>();
        for (int z = a.z(); z <= b.z(); ++z)
            for (int y = a.y(); y <= b.y(); ++y)
                for (int x = a.x(); x <= b.x(); ++x) visit({ x, y, z });
    };
    std::map<Cell, std::vector<int>> grid;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const Vec3 &a = points[faces[i][0]], &b = points[faces[i][1]], &c = points[faces[i][2]];
        for_cells(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c), [&](const Cell& at) { grid[at].push_back(int(i)); });
    }
    std::vector<std::array<int, 2>> crossings;
    for (const auto& [edge, opposite] : edges) {
        const auto [u, v] = edge;
        if (u > v) continue;
        std::set<int> candidates;
        for_cells(points[u].cwiseMin(points[v]), points[u].cwiseMax(points[v]), [&](const Cell& at) {
            const auto found = grid.find(at);
            if (found != grid.end()) candidates.insert(found->second.begin(), found->second.end());
        });
        for (int i : candidates) {
            const Face& f = faces[i];
            const bool touches = std::any_of(f.begin(), f.end(), [&](int w) { return w == edge.first || w == edge.second; });
            if (!touches && pierces(points[u], points[v], points[f[0]], points[f[1]], points[f[2]]))
                crossings.push_back({ u, f[0] });
        }
    }
    return crossings;
}

} // namespace

TopologyReport check_topology(int vertex_count, const std::vector<Face>& faces)
{
    TopologyReport report;
    const HalfEdges edges = half_edges_of(faces);
    report.closed_manifold = edges.size() == faces.size() * 3;
    for (const auto& [edge, opposite] : edges) report.closed_manifold &= edges.count({ edge.second, edge.first }) == 1;

    std::vector<int> degree(vertex_count, 0), parent(vertex_count);
    std::iota(parent.begin(), parent.end(), 0);
    const std::function<int(int)> root = [&](int v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    std::vector<std::pair<int, int>> leaving(vertex_count, { -1, -1 }); // one half-edge per vertex: (target, opposite)
    for (const auto& [edge, opposite] : edges) {
        ++degree[edge.first];
        leaving[edge.first] = { edge.second, opposite };
        parent[root(edge.first)] = root(edge.second);
    }
    report.all_vertices_used = std::all_of(degree.begin(), degree.end(), [](int d) { return d > 0; });
    for (int v = 0; v < vertex_count; ++v) report.components += root(v) == v;
    report.euler_characteristic = vertex_count - int(edges.size() / 2) + int(faces.size());
    // Each vertex has one fan: a walk around it visits all its half-edges.
    for (int v = 0; v < vertex_count && report.closed_manifold; ++v) {
        int steps = 0;
        for (int u = leaving[v].first; u >= 0 && (steps == 0 || u != leaving[v].first) && steps <= degree[v]; ++steps)
            u = edges.at({ v, u });
        report.closed_manifold &= steps == degree[v];
    }
    return report;
}

ShapeReport check_shape(const std::vector<Vec3>& points, const std::vector<Face>& faces)
{
    ShapeReport report;
    report.finite = std::all_of(points.begin(), points.end(), [](const Vec3& p) { return p.allFinite(); });
    if (!report.finite) return report;
    std::set<std::array<float, 3>> positions;
    for (const Vec3& p : points) positions.insert({ float(p.x()), float(p.y()), float(p.z()) });
    report.coincident_vertices = int(points.size() - positions.size());

    double smallest = 1e300;
    for (const Face& f : faces) {
        for (int i = 0; i < 3; ++i) {
            const Vec3 &a = points[f[i]], &b = points[f[(i + 1) % 3]], &c = points[f[(i + 2) % 3]];
            smallest = std::min(smallest, angle_between(b - a, c - a));
        }
        report.volume += points[f[0]].dot(points[f[1]].cross(points[f[2]])) / 6.0;
    }
    report.smallest_angle = smallest * 180.0 / 3.14159265358979323846;

    const HalfEdges edges = half_edges_of(faces);
    double shortest = 1e300, longest = 0.0;
    for (const auto& [edge, opposite] : edges) {
        const auto [u, v] = edge;
        const double length = (points[u] - points[v]).norm();
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
        const double theta = dihedral(points[u], points[v], points[opposite], points[edges.at({ v, u })]);
        report.largest_dihedral = std::max(report.largest_dihedral, std::abs(theta));
    }
    report.edge_ratio = longest / shortest;
    report.crossings = find_crossings(points, faces, edges, longest);
    return report;
}

StretchReport check_stretch(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const std::vector<Face>& faces)
{
    StretchReport report { 0.0, 1e300, 0.0 };
    std::size_t outside = 0;
    for (const Face& f : faces)
        for (int i = 0; i < 3; ++i) { // every edge is counted twice, which does not change the share
            const int u = f[i], v = f[(i + 1) % 3];
            const double ratio = (to[u] - to[v]).norm() / (from[u] - from[v]).norm();
            outside += ratio < 0.6 || ratio > 1.7;
            report.least = std::min(report.least, ratio);
            report.most = std::max(report.most, ratio);
        }
    report.share_outside = double(outside) / double(3 * faces.size());
    return report;
}

} // namespace pliant::creature
