#include "quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>

namespace pliant {

namespace {

using Eigen::Index;
using Path = std::vector<std::uint32_t>;

constexpr std::size_t landmark_count = 8;
constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

// Distances along edges from some vertices, and the vertex before each on the way.
struct Distances {
    std::vector<double> distance;
    std::vector<std::uint32_t> before;
};

Distances distances_from(const Path& sources, const std::vector<Path>& neighbours, const Shape& shape)
{
    Distances out { std::vector<double>(neighbours.size(), std::numeric_limits<double>::infinity()),
                    Path(neighbours.size(), nobody) };
    using Entry = std::pair<double, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (std::uint32_t v : sources) {
        out.distance[v] = 0;
        open.emplace(0, v);
    }
    while (!open.empty()) {
        const auto [distance, v] = open.top();
        open.pop();
        if (distance > out.distance[v]) continue;
        for (std::uint32_t next : neighbours[v]) {
            const double longer = distance + (point(shape, next) - point(shape, v)).norm();
            if (longer >= out.distance[next]) continue;
            out.distance[next] = longer;
            out.before[next] = v;
            open.emplace(longer, next);
        }
    }
    return out;
}

std::uint32_t farthest(const Distances& distances)
{
    std::uint32_t found = 0;
    double most = -1;
    for (std::uint32_t v = 0; v < distances.distance.size(); ++v)
        if (std::isfinite(distances.distance[v]) && distances.distance[v] > most) most = distances.distance[found = v];
    return found;
}

double length_of(const Shape& shape, const Path& path)
{
    double length = 0;
    for (std::size_t i = 1; i < path.size(); ++i) length += (point(shape, path[i]) - point(shape, path[i - 1])).norm();
    return length;
}

double volume_of(const Shape& shape, const std::vector<Triangle>& triangles)
{
    double volume = 0;
    for (const Triangle& t : triangles) volume += point(shape, t[0]).cross(point(shape, t[1])).dot(point(shape, t[2])) / 6;
    return volume;
}

// The weighted mean over the poses.
template <class Measure> double blended(const NormalizedPoses& set, const Weights& w, const Measure& measure)
{
    double sum = 0;
    for (std::size_t k = 0; k < set.pose_count(); ++k) sum += w[Index(k)] * measure(set.shapes[k]);
    return sum;
}

} // namespace

QualityMeter::QualityMeter(const NormalizedPoses& set)
    : set_(set)
{
    std::map<std::array<std::uint32_t, 2>, int> face_counts;
    for (const Triangle& t : set.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            ++face_counts[{ std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3]) }];
    std::vector<Path> neighbours(std::size_t(set.dof_count() / 3));
    is_closed_ = true;
    for (const auto& [edge, count] : face_counts) {
        edges_.push_back(edge);
        neighbours[edge[0]].push_back(edge[1]);
        neighbours[edge[1]].push_back(edge[0]);
        is_closed_ = is_closed_ && count == 2;
    }
    Path landmarks { farthest(distances_from({ set.triangles[0][0] }, neighbours, set.shapes[0])) };
    while (landmarks.size() < landmark_count)
        landmarks.push_back(farthest(distances_from(landmarks, neighbours, set.shapes[0])));
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
        const Distances from = distances_from({ landmarks[i] }, neighbours, set.shapes[0]);
        for (std::size_t j = 0; j < i; ++j) {
            Path path;
            for (std::uint32_t v = landmarks[j]; v != nobody; v = from.before[v]) path.push_back(v);
            if (path.size() > 2) limbs_.push_back(std::move(path));
        }
    }
}

BlendQuality QualityMeter::measure(const Weights& w, const Shape& blend) const
{
    BlendQuality quality;
    double squares = 0, lengths = 0;
    for (const auto& edge : edges_) {
        const Path path { edge[0], edge[1] };
        const double wanted = blended(set_, w, [&](const Shape& x) { return length_of(x, path); });
        squares += std::pow(length_of(blend, path) / wanted - 1, 2) * wanted;
        lengths += wanted;
    }
    quality.strain = std::sqrt(squares / lengths);
    for (const Path& limb : limbs_) {
        const double wanted = blended(set_, w, [&](const Shape& x) { return length_of(x, limb); });
        quality.limb_length = std::max(quality.limb_length, std::abs(length_of(blend, limb) / wanted - 1));
    }
    const auto volume = [&](const Shape& x) { return volume_of(x, set_.triangles); };
    quality.volume = is_closed_ ? volume(blend) / blended(set_, w, volume) - 1 : std::nan("");
    Eigen::VectorXd least = triangle_areas(set_.shapes[0], set_.triangles);
    for (const Shape& x : set_.shapes) least = least.cwiseMin(triangle_areas(x, set_.triangles)).eval();
    quality.worst_triangle = triangle_areas(blend, set_.triangles).cwiseQuotient(least).minCoeff();
    return quality;
}

} // namespace pliant
