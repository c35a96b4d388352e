#include "elastic/energy/contradictions.h"

#include "base/mesh/surface.h"
#include "elastic/energy/hinge.h"
#include "elastic/energy/metric_logarithm.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

constexpr double half_turn = 3.14159265358979323846;
constexpr double most_stretch = 2.302585092994046; // logarithm of 10

// Of an angle, or of the logarithm of a stretch squared: with less a layer does not change an element.
constexpr double least_change = 0.02;

// Of the elements that both layers change: so many always do it, slivers at lips and eyelids most.
constexpr double few = 0.02;

// The rest quantities of all layers that are added up: columns for layers.
struct LayerChanges {
    std::vector<Hinge> hinges;
    Eigen::VectorXd angles;        // of pose 0
    Eigen::MatrixXd angle_changes; // hinges x layers
    Eigen::MatrixXd logarithms;    // 3 faces x layers
};

double rest_angle(const Shape& shape, const Hinge& hinge)
{
    const auto& v = hinge.vertices;
    return hinge_angle(point(shape, v[0]), point(shape, v[1]), point(shape, v[2]), point(shape, v[3]));
}

Metric rest_metric(const Shape& shape, const Triangle& t)
{
    const Eigen::Vector3d e = point(shape, t[1]) - point(shape, t[0]), a = point(shape, t[2]) - point(shape, t[0]);
    return { e.squaredNorm(), e.dot(a), a.squaredNorm() };
}

LayerChanges changes_of(const NormalizedPoses& set)
{
    LayerChanges out;
    out.hinges = find_hinges(set.triangles, set.shapes[0]);
    const Eigen::Index layers = Eigen::Index(set.pose_count()) - 1, hinges = Eigen::Index(out.hinges.size());
    out.angles.resize(hinges);
    out.angle_changes.resize(hinges, layers);
    out.logarithms.resize(3 * Eigen::Index(set.triangles.size()), layers);
    for (Eigen::Index i = 0; i < hinges; ++i) out.angles[i] = rest_angle(set.shapes[0], out.hinges[std::size_t(i)]);
    for (Eigen::Index k = 0; k < layers; ++k) {
        const Shape& shape = set.shapes[std::size_t(k) + 1];
        for (Eigen::Index i = 0; i < hinges; ++i)
            out.angle_changes(i, k)
                = std::remainder(rest_angle(shape, out.hinges[std::size_t(i)]) - out.angles[i], 2 * half_turn);
        for (std::size_t f = 0; f < set.triangles.size(); ++f)
            out.logarithms.block<3, 1>(3 * Eigen::Index(f), k)
                = metric_logarithm(rest_metric(set.shapes[0], set.triangles[f]), rest_metric(shape, set.triangles[f]));
    }
    return out;
}

// Logarithm of the larger of both principal stretches, or of their inverses.
double stretch_of(const Metric& logarithm)
{
    const double mean = (logarithm[0] + logarithm[2]) / 2, half = (logarithm[0] - logarithm[2]) / 2;
    return (std::abs(mean) + std::sqrt(half * half + logarithm[1] * logarithm[1])) / 2;
}

// Of the edges, or faces, that both layers change: those that contradict each other, and the first of them.
struct Counted {
    std::size_t changed = 0, contradicting = 0, first = 0;
    std::size_t violent() const { return double(contradicting) > few * double(changed) ? contradicting : 0; }
    void add(std::size_t element, bool contradicts)
    {
        ++changed;
        if (contradicts && contradicting++ == 0) first = element;
    }
};

Counted folded_edges(const LayerChanges& changes, Eigen::Index a, Eigen::Index b)
{
    Counted out;
    for (Eigen::Index i = 0; i < changes.angles.size(); ++i) {
        const double rest = changes.angles[i], of_a = changes.angle_changes(i, a), of_b = changes.angle_changes(i, b);
        if (std::min(std::abs(of_a), std::abs(of_b)) < least_change) continue;
        const double largest_alone = std::max(std::abs(rest + of_a), std::abs(rest + of_b));
        out.add(std::size_t(i), std::abs(rest + of_a + of_b) > half_turn && largest_alone <= half_turn);
    }
    return out;
}

Counted stretched_faces(const LayerChanges& changes, Eigen::Index a, Eigen::Index b)
{
    Counted out;
    for (Eigen::Index f = 0; f < changes.logarithms.rows() / 3; ++f) {
        const Metric of_a = changes.logarithms.block<3, 1>(3 * f, a), of_b = changes.logarithms.block<3, 1>(3 * f, b);
        if (std::min(of_a.squaredNorm(), of_b.squaredNorm()) < least_change * least_change) continue;
        const double largest_alone = std::max(stretch_of(of_a), stretch_of(of_b));
        out.add(std::size_t(f), stretch_of(of_a + of_b) > most_stretch && largest_alone <= most_stretch);
    }
    return out;
}

} // namespace

std::vector<Contradiction> find_contradictions(const NormalizedPoses& set)
{
    std::vector<Contradiction> out;
    if (set.is_solid()) return out;
    const LayerChanges changes = changes_of(set);
    for (Eigen::Index b = 1; b < changes.logarithms.cols(); ++b)
        for (Eigen::Index a = 0; a < b; ++a) {
            const Counted edges = folded_edges(changes, a, b), faces = stretched_faces(changes, a, b);
            const std::size_t edge_count = edges.violent(), face_count = faces.violent();
            if (edge_count + face_count == 0) continue;
            const std::uint32_t vertex
                = edge_count > 0 ? changes.hinges[edges.first].vertices[0] : set.triangles[faces.first][0];
            out.push_back({ std::size_t(a) + 1, std::size_t(b) + 1, edge_count, face_count, vertex });
        }
    const auto size = [](const Contradiction& c) { return c.folded_edge_count + c.stretched_face_count; };
    std::stable_sort(out.begin(), out.end(),
                     [&](const Contradiction& a, const Contradiction& b) { return size(a) > size(b); });
    return out;
}

} // namespace pliant
