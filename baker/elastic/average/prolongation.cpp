#include "elastic/average/prolongation.h"

#include "base/mesh/align.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <queue>

namespace pliant {

namespace {

using Eigen::Vector3d;

constexpr std::uint32_t nowhere = std::numeric_limits<std::uint32_t>::max();

std::vector<std::vector<std::uint32_t>> vertex_neighbours(const NormalizedPoses& set)
{
    std::vector<std::vector<std::uint32_t>> out(std::size_t(set.dof_count() / 3));
    for (const Triangle& t : set.triangles)
        for (std::size_t c = 0; c < 3; ++c) {
            out[t[c]].push_back(t[(c + 1) % 3]);
            out[t[(c + 1) % 3]].push_back(t[c]);
        }
    return out;
}

// Per vertex of the fine mesh the coarse vertex next to it along edges (Dijkstra 1959).
std::vector<std::uint32_t> nearest_coarse_vertices(const NormalizedPoses& fine, const std::vector<std::uint32_t>& kept)
{
    struct Visit {
        double distance;
        std::uint32_t vertex, coarse;
        bool operator<(const Visit& other) const // the least distance first
        {
            return std::tie(other.distance, other.vertex, other.coarse) < std::tie(distance, vertex, coarse);
        }
    };
    const std::vector<std::vector<std::uint32_t>> neighbours = vertex_neighbours(fine);
    std::vector<std::uint32_t> nearest(neighbours.size(), nowhere);
    std::priority_queue<Visit> queue;
    for (std::uint32_t c = 0; c < kept.size(); ++c) queue.push({ 0, kept[c], c });
    while (!queue.empty()) {
        const Visit visit = queue.top();
        queue.pop();
        if (nearest[visit.vertex] != nowhere) continue;
        nearest[visit.vertex] = visit.coarse;
        const Vector3d here = point(fine.shapes[0], visit.vertex);
        for (std::uint32_t v : neighbours[visit.vertex])
            if (nearest[v] == nowhere)
                queue.push({ visit.distance + (point(fine.shapes[0], v) - here).norm(), v, visit.coarse });
    }
    return nearest;
}

// Barycentric coordinates of the point of the triangle next to x; sets its squared distance.
Vector3d nearest_in_triangle(const Vector3d& x, const std::array<Vector3d, 3>& t, double& squared_distance)
{
    const auto on_segment = [&](int i, int j) {
        const Vector3d along = t[std::size_t(j)] - t[std::size_t(i)];
        const double length2 = along.squaredNorm();
        const double share = length2 > 0 ? std::clamp((x - t[std::size_t(i)]).dot(along) / length2, 0.0, 1.0) : 0;
        Vector3d weights = Vector3d::Zero();
        weights[i] = 1 - share;
        weights[j] = share;
        return weights;
    };
    const auto distance2 = [&](const Vector3d& w) { return (w[0] * t[0] + w[1] * t[1] + w[2] * t[2] - x).squaredNorm(); };
    const Vector3d e = t[1] - t[0], a = t[2] - t[0], normal = e.cross(a);
    Vector3d best = on_segment(0, 1);
    for (const Vector3d& other : { on_segment(1, 2), on_segment(2, 0) })
        if (distance2(other) < distance2(best)) best = other;
    if (const double area2 = normal.squaredNorm(); area2 > 0) {
        const Vector3d off = x - t[0];
        const double second = off.cross(a).dot(normal) / area2, third = e.cross(off).dot(normal) / area2;
        if (second >= 0 && third >= 0 && second + third <= 1) best = Vector3d(1 - second - third, second, third);
    }
    squared_distance = distance2(best);
    return best;
}

} // namespace

std::vector<CoarsePlace> find_coarse_places(const NormalizedPoses& fine, const DecimatedPoses& coarse)
{
    const std::vector<std::uint32_t> nearest = nearest_coarse_vertices(fine, coarse.vertices);
    const std::vector<std::vector<std::uint32_t>> neighbours = vertex_neighbours(coarse.set);
    std::vector<std::vector<std::uint32_t>> faces(coarse.vertices.size());
    for (std::uint32_t f = 0; f < coarse.set.triangles.size(); ++f)
        for (std::uint32_t v : coarse.set.triangles[f]) faces[v].push_back(f);
    std::vector<CoarsePlace> places(nearest.size());
    for (std::uint32_t v = 0; v < places.size(); ++v) {
        const std::uint32_t centre = nearest[v] == nowhere ? 0 : nearest[v];
        CoarsePlace& place = places[v] = { { centre, centre, centre }, Vector3d(1, 0, 0) };
        double least = std::numeric_limits<double>::infinity();
        const auto try_faces = [&](std::uint32_t vertex) {
            for (std::uint32_t f : faces[vertex]) {
                const Triangle& t = coarse.set.triangles[f];
                const Shape& rest = coarse.set.shapes[0];
                double distance = 0;
                const Vector3d weights = nearest_in_triangle(
                    point(fine.shapes[0], v), { point(rest, t[0]), point(rest, t[1]), point(rest, t[2]) }, distance);
                if (distance < least) {
                    least = distance;
                    place = { t, weights };
                }
            }
        };
        try_faces(centre);
        for (std::uint32_t other : neighbours[centre]) try_faces(other);
    }
    return places;
}

namespace {

Eigen::VectorXd blend_of_poses(const RotationStrain& coordinates, const NormalizedPoses& set, const Weights& w)
{
    Eigen::VectorXd out = w[0] * coordinates.coordinates(set.shapes[0]);
    for (std::size_t k = 1; k < set.pose_count(); ++k) out += w[Eigen::Index(k)] * coordinates.coordinates(set.shapes[k]);
    return out;
}

} // namespace

Shape prolong(const NormalizedPoses& fine, const DecimatedPoses& coarse, std::size_t base, const Weights& w,
              const Shape& coarse_average, SolverKind kind)
{
    const RotationStrain of_fine(fine, fine.shapes[base]), of_coarse(coarse.set, coarse.set.shapes[base]);
    const Eigen::VectorXd difference = of_coarse.coordinates(coarse_average) - blend_of_poses(of_coarse, coarse.set, w);
    const Eigen::MatrixXd at_coarse = of_coarse.at_vertices(difference);
    const std::vector<CoarsePlace> places = find_coarse_places(fine, coarse);
    Eigen::MatrixXd at_fine(at_coarse.rows(), Eigen::Index(places.size()));
    for (std::size_t v = 0; v < places.size(); ++v) {
        const CoarsePlace& place = places[v];
        at_fine.col(Eigen::Index(v)) = place.weights[0] * at_coarse.col(place.corners[0])
            + place.weights[1] * at_coarse.col(place.corners[1]) + place.weights[2] * at_coarse.col(place.corners[2]);
    }
    Eigen::VectorXd sum = blend_of_poses(of_fine, fine, w);
    of_fine.add_at_vertices(at_fine, sum);
    return of_fine.shape(sum, CellFit(fine, kind, sliver_weight));
}

} // namespace pliant
