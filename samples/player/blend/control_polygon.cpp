#include "blend/control_polygon.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant::player {
namespace {

constexpr double pi = 3.14159265358979323846;

// Smaller weights are rounding errors of the products on the boundary (1e-16 each), far below the resolution of a float.
constexpr double smallest_weight = 1e-12;

double cross(glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; }

glm::dvec2 nearest_on_segment(glm::dvec2 a, glm::dvec2 b, glm::dvec2 point)
{
    const glm::dvec2 direction = b - a;
    const double t = std::clamp(glm::dot(point - a, direction) / glm::dot(direction, direction), 0.0, 1.0);
    return (1.0 - t) * a + t * b; // exact at both ends
}

} // namespace

ControlPolygon::ControlPolygon(std::uint32_t corner_count)
{
    if (corner_count <= 2) {
        corners_ = { { -1.0, 0.0 }, { 1.0, 0.0 } };
        return;
    }
    // Four corners form an upright square, not a diamond: it leaves more room for labels.
    const double first = corner_count == 4 ? 0.75 * pi : 0.5 * pi;
    for (std::uint32_t k = 0; k < corner_count; ++k) {
        const double angle = first + 2.0 * pi * k / corner_count;
        corners_.emplace_back(std::cos(angle), std::sin(angle));
    }
}

double ControlPolygon::side(std::uint32_t edge, glm::dvec2 point) const
{
    const glm::dvec2 start = corners_[edge];
    return cross(corners_[(edge + 1) % corner_count()] - start, point - start);
}

std::vector<double> ControlPolygon::weights(glm::dvec2 point) const
{
    point = nearest_inside(point);
    const std::uint32_t count = corner_count();
    if (count == 2) {
        const double t = (point.x + 1.0) / 2.0;
        return { 1.0 - t, t };
    }
    std::vector<double> sides(count), weights(count, 1.0);
    double longest = 0.0;
    for (std::uint32_t edge = 0; edge < count; ++edge) {
        sides[edge] = std::max(side(edge, point), 0.0);
        longest = std::max(longest, sides[edge]);
    }
    double sum = 0.0;
    for (std::uint32_t k = 0; k < count; ++k) {
        for (std::uint32_t edge = 0; edge < count; ++edge) {
            const bool touches_corner = edge == k || (edge + 1) % count == k;
            if (!touches_corner) weights[k] *= sides[edge] / longest; // scaled, so that 64 small factors do not underflow
        }
        sum += weights[k];
    }
    double kept = 0.0;
    for (double& weight : weights) {
        if (weight < smallest_weight * sum) weight = 0.0;
        kept += weight;
    }
    for (double& weight : weights) weight /= kept;
    return weights;
}

glm::dvec2 ControlPolygon::point(const std::vector<double>& weights) const
{
    glm::dvec2 sum { 0.0 };
    double total = 0.0;
    for (std::uint32_t k = 0; k < corner_count() && k < weights.size(); ++k) {
        sum += weights[k] * corners_[k];
        total += weights[k];
    }
    return total > 0.0 ? sum / total : sum;
}

glm::dvec2 ControlPolygon::nearest_inside(glm::dvec2 point) const
{
    const std::uint32_t count = corner_count();
    if (count == 2) return nearest_on_segment(corners_[0], corners_[1], point);
    bool inside = true;
    for (std::uint32_t edge = 0; edge < count; ++edge) inside = inside && side(edge, point) >= 0.0;
    if (inside) return point;
    glm::dvec2 best = corners_[0];
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::uint32_t edge = 0; edge < count; ++edge) {
        const glm::dvec2 candidate = nearest_on_segment(corners_[edge], corners_[(edge + 1) % count], point);
        const double distance = glm::distance(candidate, point);
        if (distance < best_distance) {
            best_distance = distance;
            best = candidate;
        }
    }
    return best;
}

glm::dvec2 ControlPolygon::idle_point(double phase) const
{
    const std::uint32_t count = corner_count();
    const double along = (phase - std::floor(phase)) * count;
    const std::uint32_t from = std::min(static_cast<std::uint32_t>(along), count - 1);
    const double s = along - from;
    const double t = s * s * s * (s * (s * 6.0 - 15.0) + 10.0); // first and second derivatives vanish at the corners
    // A cubic Bezier curve whose inner control points lie between corner and centre. It stays in the convex hull of its
    // control points, so inside the polygon.
    constexpr double pull = 0.25;
    const glm::dvec2 a = corners_[from], b = corners_[(from + 1) % count];
    const double u = 1.0 - t;
    return u * u * u * a + 3.0 * u * u * t * (pull * a) + 3.0 * u * t * t * (pull * b) + t * t * t * b;
}

double ControlPolygon::idle_phase_near(glm::dvec2 point) const
{
    const int samples = 64 * static_cast<int>(corner_count()); // a finer step is not visible
    double best = 0.0, best_distance = std::numeric_limits<double>::infinity();
    for (int i = 0; i < samples; ++i) {
        const double phase = static_cast<double>(i) / samples;
        const double distance = glm::distance(idle_point(phase), point);
        if (distance < best_distance) {
            best_distance = distance;
            best = phase;
        }
    }
    return best;
}

} // namespace pliant::player
