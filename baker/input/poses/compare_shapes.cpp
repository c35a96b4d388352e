#include "input/poses/compare_poses.h"

#include "base/common/union_find.h"
#include "base/mesh/align.h"
#include "input/poses/check_surface.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

// A factor between two poses above which they are taken to be in different units.
constexpr double unit_mismatch = 10;

// Median stretch of the edges above which vertices do not correspond, whatever their spread. In our data sets the median
// stays below 1.6; shuffled vertices give about the square root of the number of vertices.
constexpr double hopeless_stretch = 5;
// With few vertices a shuffle stretches less, but it also stretches very differently: the ratio of the ninth to the first
// decile is below 1.8 in our data sets and 2.2 to 32 in shuffled ones.
constexpr double suspicious_stretch = 2;
constexpr double suspicious_spread = 2.5;

// The pose in units of pose 0's box, around its own middle.
Shape to_shape(const Positions& positions, double unit)
{
    const Eigen::RowVector3d middle = 0.5 * positions.colwise().maxCoeff() + 0.5 * positions.colwise().minCoeff();
    const Positions centred = (positions.rowwise() - middle) / unit;
    return Eigen::Map<const Shape>(centred.data(), centred.size());
}

double box_size(const Positions& positions)
{
    return (0.5 * positions.colwise().maxCoeff() - 0.5 * positions.colwise().minCoeff()).maxCoeff();
}

double centred_norm(const Shape& shape)
{
    const Eigen::Map<const Positions> rows(shape.data(), shape.size() / 3, 3);
    return (rows.rowwise() - rows.colwise().mean()).norm();
}

// Value at the given part (0 .. 1) of the sorted numbers.
double quantile(std::vector<double>& numbers, double part)
{
    const auto nth = numbers.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(numbers.size() - 1));
    std::nth_element(numbers.begin(), nth, numbers.end());
    return *nth;
}

// Lengths of the edges in `other` over those in `first`, and the edge where they differ most. Interior edges come twice,
// which changes nothing.
struct EdgeRatios {
    std::vector<double> ratios;
    std::uint32_t from = 0, to = 0; // of the most changed edge
    double most = 1;                // its ratio
};

EdgeRatios edge_ratios(const Shape& first, const Shape& other, const std::vector<Triangle>& triangles)
{
    EdgeRatios edges;
    edges.ratios.reserve(3 * triangles.size());
    for (const Triangle& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = t[i], to = t[(i + 1) % 3];
            const double before = (point(first, to) - point(first, from)).norm();
            const double after = (point(other, to) - point(other, from)).norm();
            if (!(before > 0 && after > 0)) continue;
            const double ratio = after / before;
            edges.ratios.push_back(ratio);
            if (std::abs(std::log(ratio)) <= std::abs(std::log(edges.most))) continue;
            edges.from = from, edges.to = to, edges.most = ratio;
        }
    }
    return edges;
}

// Median of the stretch of the edges, relative to `scale`; a shrunk edge counts like a stretched one.
double median_stretch(const std::vector<double>& ratios, double scale)
{
    std::vector<double> stretches(ratios.size());
    std::transform(ratios.begin(), ratios.end(), stretches.begin(),
                   [scale](double ratio) { return std::max(ratio / scale, scale / ratio); });
    return quantile(stretches, 0.5);
}

// Vertices without faces and the fineness of the mesh do not move it.
Eigen::Vector3d surface_centroid(const Shape& shape, const std::vector<Triangle>& triangles)
{
    const Eigen::VectorXd masses = lumped_masses(shape, triangles);
    const Eigen::Map<const Positions> rows(shape.data(), shape.size() / 3, 3);
    return rows.transpose() * masses / masses.sum();
}

// The triangles in patches of one orientation, each turned so that the volume under it in this pose is positive as seen
// from the middle. Faces of files may be turned over: a signed volume over both orientations would say nothing.
std::vector<Triangle> oriented_triangles(const Shape& shape, std::vector<Triangle> triangles)
{
    struct Side {
        std::uint64_t edge;
        std::uint32_t face;
        bool is_forward;
    };
    std::vector<Side> sides;
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = triangles[f][i], to = triangles[f][(i + 1) % 3];
            sides.push_back({ std::uint64_t(std::min(from, to)) << 32 | std::max(from, to), f, from < to });
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.edge < b.edge; });
    UnionFind patches(triangles.size());
    for (std::size_t i = 1; i < sides.size(); ++i)
        if (sides[i].edge == sides[i - 1].edge && sides[i].is_forward != sides[i - 1].is_forward)
            patches.join(sides[i].face, sides[i - 1].face);

    const Eigen::Vector3d middle = surface_centroid(shape, triangles);
    std::vector<double> volumes(triangles.size());
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
        volumes[patches.find(f)] += double_area_vector(shape, triangles[f]).dot(point(shape, triangles[f][0]) - middle);
    for (std::uint32_t f = 0; f < triangles.size(); ++f)
        if (volumes[patches.find(f)] < 0) std::swap(triangles[f][1], triangles[f][2]);
    return triangles;
}

// The vertex around which the signed volume under the surface, as seen from the middle, falls most.
std::uint32_t most_turned_vertex(const Shape& first, const Shape& other, const std::vector<Triangle>& triangles)
{
    const auto volumes_of = [&](const Shape& shape) {
        const Eigen::Vector3d middle = surface_centroid(shape, triangles);
        Eigen::VectorXd volumes = Eigen::VectorXd::Zero(shape.size() / 3); // under the faces around each vertex
        for (const Triangle& t : triangles) {
            const double volume = double_area_vector(shape, t).dot(point(shape, t[0]) - middle) / 6;
            for (const std::uint32_t v : t) volumes[v] += volume;
        }
        return volumes;
    };
    const Eigen::VectorXd before = volumes_of(first);
    const double sign = before.sum() < 0 ? -1 : 1;
    Eigen::Index vertex = 0;
    (sign * (before - volumes_of(other))).maxCoeff(&vertex);
    return std::uint32_t(vertex);
}

// What tells whether a surface was turned inside out: the volume under it as seen from its middle, in units of the volume
// that a surface of this area can have at most (a sphere, 1), and how open it is: length of its border in units of the
// border of a flat disc of this area.
struct Enclosure {
    double volume = 0;
    double openness = 0;
};

Enclosure enclosure(const Shape& shape, const std::vector<Triangle>& triangles)
{
    const Eigen::Vector3d middle = surface_centroid(shape, triangles);
    std::vector<std::pair<std::uint64_t, double>> edges; // vertex pair and length
    double volume = 0, area = 0, border = 0;
    for (const Triangle& t : triangles) {
        const Eigen::Vector3d a = point(shape, t[0]) - middle, b = point(shape, t[1]) - middle,
                              c = point(shape, t[2]) - middle;
        volume += a.dot(b.cross(c)) / 6;
        area += 0.5 * (b - a).cross(c - a).norm();
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t from = t[i], to = t[(i + 1) % 3];
            edges.emplace_back(std::uint64_t(std::min(from, to)) << 32 | std::max(from, to),
                               (point(shape, to) - point(shape, from)).norm());
        }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool has_neighbour = (i > 0 && edges[i - 1].first == edges[i].first)
            || (i + 1 < edges.size() && edges[i + 1].first == edges[i].first);
        if (!has_neighbour) border += edges[i].second;
    }
    constexpr double pi = 3.14159265358979323846;
    return { 6 * std::sqrt(pi) * volume / std::pow(area, 1.5), border / (2 * std::sqrt(pi * area)) };
}

// Squared distance of the best proper and the best improper fit, in units of the mean squared size.
struct MirrorFit {
    double proper = 0;
    double improper = 0;
};

MirrorFit mirror_fit(const Shape& first, const Shape& other, const Eigen::VectorXd& masses)
{
    const auto centred = [&](const Shape& shape) {
        const Eigen::Map<const Positions> rows(shape.data(), shape.size() / 3, 3);
        const Eigen::RowVector3d centroid = (masses.transpose() * rows) / masses.sum();
        Positions result = rows.rowwise() - centroid;
        result /= std::sqrt((masses.array() * result.rowwise().squaredNorm().array()).sum());
        return result;
    };
    const Eigen::Matrix3d covariance = centred(other).transpose() * masses.asDiagonal() * centred(first);
    const Eigen::Vector3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(covariance).singularValues();
    const double sign = covariance.determinant() < 0 ? -1 : 1;
    return { 2 - 2 * (s[0] + s[1] + sign * s[2]), 2 - 2 * (s[0] + s[1] - sign * s[2]) };
}

// The best orthogonal fit alone cannot tell: legitimate poses of real bodies fit their mirror image up to three times better
// (a walk seen half a step later is nearly one), and a sheet that bends the other way is exactly one. But an enclosing
// surface would have to be turned inside out. So that is the error; a nearly exact mirror image of a sheet is a warning.
void check_mirrored(const MeshFile& first, const MeshFile& other, const Shape& a, const Shape& b,
                    const std::vector<Triangle>& given, DiagnosticList& diagnostics)
{
    const std::vector<Triangle> triangles = oriented_triangles(a, given);
    constexpr double open = 0.5;        // a hemisphere has 0.7, a face with its neck 0.2, a closed surface 0
    constexpr double enclosing = 0.005; // a human body has 0.1 to 0.2, a pillow ten times as wide as high 0.15
    constexpr double exact = 0.02, distinct = 0.01;
    // a mirror image has the same volume, and poses of one body hardly differ by more than half
    constexpr double alike = 0.25;
    const Enclosure ea = enclosure(a, triangles), eb = enclosure(b, triangles);
    const bool is_enclosing
        = std::max(ea.openness, eb.openness) < open && std::min(std::abs(ea.volume), std::abs(eb.volume)) > enclosing;
    if (is_enclosing && ea.volume * eb.volume < 0) {
        const double smaller = std::min(std::abs(ea.volume), std::abs(eb.volume));
        if (smaller < alike * std::max(std::abs(ea.volume), std::abs(eb.volume))) {
            const std::uint32_t vertex = most_turned_vertex(a, b, triangles);
            diagnostics.add(about_vertices(
                warning_at(3014, other.path,
                           fmt::format("a large part is inside out (signed volume {:.3g}, {} has {:.3g}), most of all at "
                                       "vertex {}",
                                       eb.volume, first.path, ea.volume, vertex),
                           "correct if it is meant to fold through itself; its blends may do so, too"),
                { vertex }));
            return;
        }
        diagnostics.add(error_at(
            3007, other.path,
            fmt::format("is mirrored relative to {}: its surface is inside out (signed volume {:.3g} against {:.3g})",
                        first.path, eb.volume, ea.volume),
            "the export flipped an axis of one of the two: export both in the same way"));
        return;
    }
    if (is_enclosing) return;
    const MirrorFit fit = mirror_fit(a, b, lumped_masses(a, triangles));
    if (fit.proper < distinct || fit.improper > exact * fit.proper) return;
    diagnostics.add(warning_at(3011, other.path, fmt::format("is nearly a mirror image of {}", first.path),
                               "correct if the sheet bends the other way; otherwise the export flipped an axis"));
}

} // namespace

void check_correspondence(const MeshFile& first, const MeshFile& other, const Triangulation& triangulation,
                          DiagnosticList& diagnostics)
{
    const double unit = box_size(first.positions);
    if (!(unit > 0) || !(box_size(other.positions) > 0)) return; // without areas: P2202
    const Shape a = to_shape(first.positions, unit), b = to_shape(other.positions, unit);
    EdgeRatios edges = edge_ratios(a, b, triangulation.triangles);
    std::vector<double>& ratios = edges.ratios;
    if (ratios.empty()) return;

    // Crumpling makes a shape smaller but not its edges, so a unit of length must show in both.
    const double size_ratio = centred_norm(b) / centred_norm(a);
    const double edge_ratio = quantile(ratios, 0.5);
    const bool is_larger = std::min(size_ratio, edge_ratio) > unit_mismatch;
    const bool is_smaller = std::max(size_ratio, edge_ratio) < 1 / unit_mismatch;
    if (is_larger || is_smaller) {
        diagnostics.add(error_at(3008, other.path,
                                 fmt::format("scale {:.4g} relative to {}: unit mismatch?", size_ratio, first.path),
                                 "export all poses in the same unit of length"));
    }

    const double stretch = std::min(median_stretch(ratios, size_ratio), median_stretch(ratios, 1));
    const double spread = quantile(ratios, 0.9) / quantile(ratios, 0.1);
    if (stretch > hopeless_stretch || (stretch > suspicious_stretch && spread > suspicious_spread)) {
        diagnostics.add(about_vertices(
            error_at(3006, other.path,
                     fmt::format("does not seem to correspond to {}: median edge stretch {:.3g}x, spread {:.3g}x; most "
                                 "changed is edge {} {} ({:.3g}x)",
                                 first.path, stretch, spread, edges.from, edges.to, edges.most),
                     "vertices must come in the same order in all poses: export with 'keep vertex order'"),
            { edges.from, edges.to }));
        return; // the rest would be nonsense
    }
    // A mirrored solid has negative volumes, which is proof; a thin one fits its mirror image as well as a sheet does.
    if (first.tets.empty()) check_mirrored(first, other, a, b, triangulation.triangles, diagnostics);
}

void check_distinct(const std::vector<MeshFile>& poses, const Triangulation& triangulation, bool align,
                    DiagnosticList& diagnostics)
{
    const double unit = box_size(poses[0].positions);
    if (!(unit > 0)) return;
    const Eigen::RowVector3d middle
        = 0.5 * poses[0].positions.colwise().maxCoeff() + 0.5 * poses[0].positions.colwise().minCoeff();
    std::vector<Shape> shapes;
    double rounding = 0;
    for (const MeshFile& pose : poses) {
        const Positions placed = (pose.positions.rowwise() - middle) / unit;
        shapes.push_back(align ? to_shape(pose.positions, unit)
                               : Shape(Eigen::Map<const Shape>(placed.data(), placed.size())));
        rounding = std::max(rounding, coordinate_rounding(pose.positions) / unit);
    }
    // A rigid motion in the files' precision moves every coordinate by a few roundings; below 1e-9 no pose is worth its
    // name.
    const double tolerance = 1e-9 + 8 * rounding;
    const Eigen::VectorXd masses = lumped_masses(shapes[0], triangulation.triangles);
    const auto is_same = [&](std::size_t i, std::size_t k) {
        Shape moved = shapes[k];
        if (align) apply(best_rigid_motion(moved, shapes[i], masses), moved);
        return (moved - shapes[i]).cwiseAbs().maxCoeff() <= tolerance;
    };
    std::vector<std::pair<std::size_t, std::size_t>> repeats; // pose and the earlier one that it repeats
    for (std::size_t k = 1; k < shapes.size(); ++k) {
        for (std::size_t i = 0; i < k; ++i) {
            if (!is_same(i, k)) continue;
            repeats.emplace_back(k, i);
            break;
        }
    }
    const char* meaning = align ? "is the same pose as" : "is the same pose, in the same place, as";
    const bool is_hopeless = repeats.size() + 1 == poses.size();
    for (const auto& [k, i] : repeats) {
        const std::string what = fmt::format("{} {}", meaning, poses[i].path);
        if (is_hopeless)
            diagnostics.add(error_at(3009, poses[k].path, what + ": nothing to blend", "give at least two different poses"));
        else
            diagnostics.add(warning_at(3010, poses[k].path, what, "it has a weight of its own but adds no shape"));
    }
}

} // namespace pliant
