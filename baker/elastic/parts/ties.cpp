#include "elastic/parts/ties.h"

#include "elastic/parts/joints.h"
#include "elastic/parts/part_points.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace pliant {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// As stiff as a membrane of modulus 1 is to one of its vertices, times this, for a tie whose place hardly differs between the poses.
// Where places differ by more than this (units of the diagonal), the mean of the places means less, down to the least stiffness: an eye
// that turns would get dents from ties that pull its vertices from the arc to the chord. THEORY.md tells what other values do.
constexpr double tie_stiffness = 0.3, least_stiffness = 0.01, sure_place = 0.005;

// Lengths in units of the diagonal. Tied vertices of a part keep this distance, anchors lie about so far apart, vertices this much
// farther from the host than the nearest are tied as well, and faces longer than this are not only their corners.
constexpr double tie_spacing = 0.03, anchor_spread = 0.05, near_margin = 0.02, point_spacing = 0.01;

// A part has at least so many tied vertices if it has as many, so that it is held against turning with some to spare, and at most so
// many, so that what they cost stays small beside the part.
constexpr std::size_t least_ties = 12, most_ties = 400;

// At least this part of a part's vertices, the nearest ones, may be tied: a coat that hangs on the shoulders.
constexpr double near_share = 0.25;

// Anchors a b c should have at least this ratio of 4 area / (longest side)^2 in every pose; 1.7 is equilateral, below the ratio places
// are ill-defined.
constexpr double good_triangle = 0.2, poor_triangle = 1e-3;

// A border vertex lies on another border's edge if it is this near to it in every pose, in units of the edge's length there; and on the edge and not at its end if its foot is this far from the end.
constexpr double seam_width = 0.05;

// The smallest over the poses of the area of a triangle, and of its ratio to the longest side.
struct TriangleMeasure {
    double area, quality;
};

TriangleMeasure measure_triangle(const ShapeSet& set, std::uint32_t a, std::uint32_t b, std::uint32_t c)
{
    TriangleMeasure out = { infinity, infinity };
    for (const Shape& shape : set.shapes) {
        const Eigen::Vector3d ab = point(shape, b) - point(shape, a), ac = point(shape, c) - point(shape, a);
        const double twice_area = ab.cross(ac).norm();
        const double longest = std::max({ ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm() });
        out.area = std::min(out.area, 0.5 * twice_area);
        out.quality = std::min(out.quality, longest > 0 ? 2 * twice_area / longest : 0);
    }
    return out;
}

// Metric of two edges: first first, first second, second second.
Eigen::Matrix2d mean_metric(const ShapeSet& set, std::uint32_t a, std::uint32_t b, std::uint32_t c)
{
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (const Shape& shape : set.shapes) {
        Eigen::Matrix<double, 3, 2> edges;
        edges << point(shape, b) - point(shape, a), point(shape, c) - point(shape, a);
        sum += edges.transpose() * edges;
    }
    return sum / double(set.pose_count());
}

Tie make_tie(const ShapeSet& set, std::size_t part, const std::array<std::uint32_t, 4>& vertices)
{
    Tie tie;
    tie.vertices = vertices;
    tie.part = part;
    // With L L^T the metric of (b - a, c - a), that of the columns of (b - a, c - a) L^-T is the identity.
    const Eigen::Matrix2d lower = mean_metric(set, vertices[1], vertices[2], vertices[3]).llt().matrixL();
    tie.frame = lower.transpose().inverse();
    tie.frame(1, 0) = 0;
    tie.rest.resize(3, Eigen::Index(set.pose_count()));
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        const Shape& shape = set.shapes[k];
        tie.rest.col(Eigen::Index(k)) = tie_place(tie_vectors(tie, point(shape, vertices[0]), point(shape, vertices[1]),
                                                              point(shape, vertices[2]), point(shape, vertices[3])));
    }
    tie.stiffness = stiffness_of(tie.rest, set.diagonal);
    return tie;
}

// Of a part's vertices some that lie far apart: the first, and always the one farthest from those before.
std::vector<std::uint32_t> spread_vertices(const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                                           std::size_t most)
{
    std::vector<std::uint32_t> out = { vertices[0] };
    std::vector<double> gaps(vertices.size(), infinity);
    while (out.size() < most) {
        for (std::size_t i = 0; i < gaps.size(); ++i)
            gaps[i] = std::min(gaps[i], (columns.col(vertices[i]) - columns.col(out.back())).squaredNorm());
        const auto next = std::max_element(gaps.begin(), gaps.end());
        if (!(*next > 0)) break;
        out.push_back(vertices[std::size_t(next - gaps.begin())]);
    }
    return out;
}

// Whether places can be told from some of these vertices: three are a triangle of this quality in every pose.
bool have_triangle(const ShapeSet& set, const std::vector<std::uint32_t>& vertices, const Eigen::MatrixXd& columns,
                   double quality)
{
    constexpr std::size_t most = 10; // of a line all triangles are poor, of anything else few among so many are
    const std::vector<std::uint32_t> points = spread_vertices(vertices, columns, most);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = i + 1; j < points.size(); ++j)
            for (std::size_t k = j + 1; k < points.size(); ++k)
                if (measure_triangle(set, points[i], points[j], points[k]).quality >= quality) return true;
    return false;
}

// The parts that others may hang on. If places can be told from none, all with faces.
std::vector<bool> find_holders(const ShapeSet& set, const Parts& parts, const Eigen::MatrixXd& columns)
{
    std::vector<bool> out(parts.count(), false);
    for (std::size_t p = 0; p < parts.surface_count; ++p)
        out[p] = have_triangle(set, parts.vertices[p], columns, poor_triangle);
    if (std::find(out.begin(), out.end(), true) == out.end())
        std::fill(out.begin(), out.begin() + std::ptrdiff_t(parts.surface_count), true);
    return out;
}

// The points of a part to look among.
struct HostTrees {
    PointTree surface, vertices;
    double size; // diagonal of the box of its vertices in pose space
};

// Ties parts to their hosts.
class Binder {
public:
    Binder(const ShapeSet& set, const PartPoints& points, TieSet& out)
        : set_(set)
        , points_(points)
        , columns_(points.columns)
        , out_(out)
        , trees_(out.parts.surface_count)
    {
    }

    void bind(std::size_t part)
    {
        if (out_.tree.hosts[part] == no_part) return;
        const HostTrees& host = trees(out_.tree.hosts[part]);
        const Nearby mine = vertices_near(host, part);
        out_.distances[part] = mine.nearest(0);
        // A plate under a small post touches it far from all its own corners: then the post's vertices are tied to the plate.
        const double margin = near_margin * set_.diagonal;
        if (part < out_.parts.surface_count && mine.nearest(2) > margin) {
            const Nearby theirs = vertices_near_points(host, part);
            out_.distances[part] = std::min(mine.nearest(0), theirs.nearest(0));
            const std::vector<std::uint32_t> chosen = choose(theirs);
            if (theirs.nearest(2) + margin < mine.nearest(2) && have_triangle(set_, chosen, columns_, good_triangle)
                && bind_vertices(part, chosen, trees(part)))
                return;
        }
        bind_vertices(part, choose(mine), host);
    }

private:
    // Vertices of one part and how far they are from another.
    struct Nearby {
        std::vector<std::uint32_t> vertices;
        std::vector<double> distances;

        // The distance of the i-th nearest, or of the farthest if there are not so many.
        double nearest(std::size_t i) const
        {
            std::vector<double> sorted = distances;
            std::sort(sorted.begin(), sorted.end());
            return sorted[std::min(i, sorted.size() - 1)];
        }
    };

    Nearby vertices_near(const HostTrees& host, std::size_t part) const
    {
        Nearby out = { out_.parts.vertices[part], {} };
        for (const std::uint32_t v : out.vertices)
            out.distances.push_back(std::sqrt(host.surface.nearest(v, 1, infinity).squared_distance));
        return out;
    }

    // Of the host those next to points of the part: no more than that has points, so that many parts on one host cost no more than they are.
    Nearby vertices_near_points(const HostTrees& host, std::size_t part) const
    {
        std::vector<std::pair<std::uint32_t, double>> found;
        for (const std::uint32_t column : points_.of_part[part]) {
            const Neighbour nearest = host.vertices.nearest(column, 1, infinity);
            found.emplace_back(host.vertices.points()[nearest.point].vertex, std::sqrt(nearest.squared_distance));
        }
        std::sort(found.begin(), found.end());
        Nearby out;
        for (const auto& [vertex, distance] : found) {
            if (!out.vertices.empty() && out.vertices.back() == vertex) continue;
            out.vertices.push_back(vertex);
            out.distances.push_back(distance);
        }
        return out;
    }

    // Whether a tie came of it.
    bool bind_vertices(std::size_t part, const std::vector<std::uint32_t>& vertices, const HostTrees& anchors)
    {
        const std::size_t before = out_.ties.size();
        for (const std::uint32_t v : vertices) bind_vertex(part, v, anchors);
        return out_.ties.size() > before;
    }

    const HostTrees& trees(std::size_t part)
    {
        if (!trees_[part]) {
            const auto tree_points = [](const std::vector<std::uint32_t>& columns) {
                std::vector<TreePoint> out;
                for (const std::uint32_t column : columns) out.push_back({ column, 0 });
                return out;
            };
            const std::vector<std::uint32_t>& vertices = out_.parts.vertices[part];
            Eigen::VectorXd low = columns_.col(vertices[0]), high = low;
            for (const std::uint32_t v : vertices)
                low = low.cwiseMin(columns_.col(v)), high = high.cwiseMax(columns_.col(v));
            trees_[part] = std::make_unique<HostTrees>(HostTrees { { columns_, tree_points(points_.of_part[part]) },
                                                                   { columns_, tree_points(vertices) },
                                                                   (high - low).norm() });
        }
        return *trees_[part];
    }

    // Which are tied: from the nearest one onwards always the one farthest from those before.
    std::vector<std::uint32_t> choose(const Nearby& nearby) const
    {
        const std::size_t count = nearby.vertices.size();
        const std::size_t quarter = std::size_t(near_share * double(count));
        const double reach = std::max(
            { nearby.nearest(0) + near_margin * set_.diagonal, nearby.nearest(quarter), nearby.nearest(least_ties) });
        std::vector<double> gaps(count); // to the nearest chosen one; negative: out of reach
        for (std::size_t i = 0; i < count; ++i) gaps[i] = nearby.distances[i] <= reach ? infinity : -1;
        std::vector<std::uint32_t> chosen;
        std::size_t next
            = std::size_t(std::min_element(nearby.distances.begin(), nearby.distances.end()) - nearby.distances.begin());
        while (chosen.size() < most_ties) {
            chosen.push_back(nearby.vertices[next]);
            for (std::size_t i = 0; i < count; ++i)
                if (gaps[i] > 0)
                    gaps[i] = std::min(gaps[i], (columns_.col(nearby.vertices[i]) - columns_.col(chosen.back())).norm());
            next = std::size_t(std::max_element(gaps.begin(), gaps.end()) - gaps.begin());
            if (!(gaps[next] > 0) || (chosen.size() >= least_ties && gaps[next] < tie_spacing * set_.diagonal)) break;
        }
        return chosen;
    }

    // Anchors: the nearest vertex of the host, and two around it that make a large triangle in every pose, among which the vertex keeps its
    // place. The farther the vertex, the larger, so that a small turn of the triangle is not a large way of the vertex.
    void bind_vertex(std::size_t part, std::uint32_t v, const HostTrees& host)
    {
        const Neighbour nearest = host.vertices.nearest(v, 1, infinity);
        const std::uint32_t a = host.vertices.points()[nearest.point].vertex;
        const double wanted = std::max(anchor_spread * set_.diagonal, 1.5 * std::sqrt(nearest.squared_distance));
        double best_quality = 0;
        std::array<std::uint32_t, 4> best = { v, a, a, a };
        // Of a host that is smaller than the ball, half of it comes first: the ball sees no more than a few points at each distance.
        for (double reach = std::min(wanted, host.size / 2); best_quality < good_triangle; reach *= 2) {
            const std::vector<std::uint32_t> around = host.vertices.ball(columns_.col(a), reach, reach / 4);
            double best_worth = 0;
            for (std::size_t i = 0; i < around.size(); ++i)
                for (std::size_t j = i + 1; j < around.size(); ++j) {
                    if (around[i] == v || around[j] == v || around[i] == a || around[j] == a) continue;
                    const std::array<std::uint32_t, 4> vertices = { v, a, around[i], around[j] };
                    const TriangleMeasure found = measure_triangle(set_, a, around[i], around[j]);
                    const bool is_good = found.quality >= good_triangle;
                    if (!is_good && (best_worth > 0 || found.quality <= best_quality)) continue;
                    if (is_good) {
                        if (found.area * tie_stiffness <= best_worth) continue; // the most that it may be worth
                        const double worth = found.area * make_tie(set_, part, vertices).stiffness;
                        if (worth <= best_worth) continue;
                        best_worth = worth;
                    }
                    best_quality = found.quality;
                    best = vertices;
                }
            if (reach >= host.size) break; // that was all of it
        }
        if (best_quality >= poor_triangle) out_.ties.push_back(make_tie(set_, part, best));
    }

    const ShapeSet& set_;
    const PartPoints& points_;
    const Eigen::MatrixXd& columns_;
    TieSet& out_;
    std::vector<std::unique_ptr<HostTrees>> trees_;
};

// An edge of one triangle only, and the corner opposite.
struct BorderEdge {
    std::uint32_t a, b, c;
};

std::vector<BorderEdge> find_border(const std::vector<Triangle>& triangles, const std::vector<Hinge>& hinges)
{
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    std::vector<Edge> inner;
    for (const Hinge& hinge : hinges) inner.push_back(std::minmax(hinge.vertices[0], hinge.vertices[1]));
    std::sort(inner.begin(), inner.end());
    std::vector<BorderEdge> border;
    for (const Triangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const BorderEdge edge = { t[i], t[(i + 1) % 3], t[(i + 2) % 3] };
            if (!std::binary_search(inner.begin(), inner.end(), Edge(std::minmax(edge.a, edge.b)))) border.push_back(edge);
        }
    return border;
}

// Ties border vertices to the borders they lie on, so that cracks stay shut.
class SeamBinder {
public:
    SeamBinder(const ShapeSet& set, const Eigen::MatrixXd& columns, std::vector<BorderEdge> border)
        : set_(set)
        , columns_(columns)
        , border_(std::move(border))
        , found_(std::size_t(columns.cols()))
    {
        for (const BorderEdge& edge : border_) {
            neighbours_.emplace_back(edge.a, edge.b);
            neighbours_.emplace_back(edge.b, edge.a);
        }
        std::sort(neighbours_.begin(), neighbours_.end());
    }

    // Calls tie(vertices) for each, by ascending vertex.
    template <class Visit> void bind(Visit tie)
    {
        std::vector<TreePoint> points;
        for (std::size_t i = 0; i < neighbours_.size(); ++i)
            if (i == 0 || neighbours_[i].first != neighbours_[i - 1].first) points.push_back({ neighbours_[i].first, 0 });
        const PointTree tree(columns_, points);
        for (const BorderEdge& edge : border_) {
            const Eigen::VectorXd along = columns_.col(edge.b) - columns_.col(edge.a);
            const Eigen::VectorXd middle = columns_.col(edge.a) + 0.5 * along;
            for (const std::uint32_t v : tree.ball(middle, (0.5 + seam_width) * along.norm(), 0)) consider(v, edge, along);
        }
        for (const TreePoint& point : points)
            if (const BorderEdge* edge = found_[point.vertex].edge) tie({ point.vertex, edge->a, edge->b, edge->c });
    }

private:
    struct Nearest {
        double squared_distance = infinity;
        const BorderEdge* edge = nullptr;
    };

    void consider(std::uint32_t v, const BorderEdge& edge, const Eigen::VectorXd& along)
    {
        if (v == edge.a || v == edge.b || v == edge.c) return;
        const double length2 = along.squaredNorm();
        const Eigen::VectorXd off = columns_.col(v) - columns_.col(edge.a);
        const double foot = std::clamp(off.dot(along) / length2, 0.0, 1.0);
        const double distance2 = (off - foot * along).squaredNorm();
        if (distance2 > seam_width * seam_width * length2 || distance2 >= found_[v].squared_distance) return;
        if (!is_shut(v, edge, foot)) return;
        // Around a corner of its own border every vertex is near the end of the next edge.
        const std::uint32_t end = foot < seam_width ? edge.a : edge.b;
        const bool is_inside = foot >= seam_width && foot <= 1 - seam_width;
        if (!is_inside && std::binary_search(neighbours_.begin(), neighbours_.end(), std::make_pair(v, end))) return;
        if (measure_triangle(set_, edge.a, edge.b, edge.c).quality < poor_triangle) return;
        found_[v] = { distance2, &edge };
    }

    // In every pose: lips and eyelids that open in one of many poses are near in the mean of all.
    bool is_shut(std::uint32_t v, const BorderEdge& edge, double foot) const
    {
        return std::all_of(set_.shapes.begin(), set_.shapes.end(), [&](const Shape& shape) {
            const Eigen::Vector3d a = point(shape, edge.a), along = point(shape, edge.b) - a;
            return (point(shape, v) - a - foot * along).norm() <= seam_width * along.norm();
        });
    }

    const ShapeSet& set_;
    const Eigen::MatrixXd& columns_;
    std::vector<BorderEdge> border_;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours_; // along border edges, both ways, sorted
    std::vector<Nearest> found_;                                      // per vertex
};

// The end of the ties of a part that begin at `first`.
std::size_t end_of_part(const TieSet& ties, std::size_t first)
{
    std::size_t end = first;
    while (end < ties.ties.size() && ties.ties[end].part == ties.ties[first].part) ++end;
    return end;
}

void find_joints(const ShapeSet& set, TieSet& out)
{
    for (std::size_t first = 0, last = 0; first < out.ties.size(); first = last) {
        last = end_of_part(out, first);
        std::vector<Pull> pulls = find_joint(set, out.ties.data() + first, out.ties.data() + last);
        if (!pulls.empty()) out.joints.push_back({ first, last - first, std::move(pulls) });
    }
}

} // namespace

double stiffness_of(const Eigen::Matrix3Xd& rest, double diagonal)
{
    const Eigen::Vector3d mean = rest.rowwise().mean();
    const double spread2 = (rest.colwise() - mean).squaredNorm() / double(rest.cols());
    const double softening = 1 + spread2 / std::pow(sure_place * diagonal, 2);
    return std::max(tie_stiffness / softening, least_stiffness);
}

Pull pull_of(const Tie& tie)
{
    const Eigen::Matrix2d& f = tie.frame;
    Pull pull = { { tie.vertices.begin(), tie.vertices.end() }, Eigen::Matrix3Xd(3, 4), tie.stiffness, tie.rest, tie.part };
    pull.factors << 1, -1, 0, 0, //
        0, -f(0, 0), f(0, 0), 0, //
        0, -f(0, 1) - f(1, 1), f(0, 1), f(1, 1);
    return pull;
}

Eigen::Matrix3d tie_vectors(const Tie& tie, const Eigen::Vector3d& vertex, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
    Eigen::Matrix3d out;
    out.col(0) = vertex - a;
    out.col(1) = tie.frame(0, 0) * (b - a);
    out.col(2) = tie.frame(0, 1) * (b - a) + tie.frame(1, 1) * (c - a);
    return out;
}

Eigen::Vector3d tie_place(const Eigen::Matrix3d& vectors)
{
    const Eigen::Vector3d r = vectors.col(0), e1 = vectors.col(1), e2 = vectors.col(2);
    return { r.dot(e1), r.dot(e2), r.dot(e1.cross(e2)) };
}

TieSet find_ties(const ShapeSet& set)
{
    TieSet out;
    if (set.is_solid()) return out;
    out.parts = find_parts(set);
    std::vector<BorderEdge> border = find_border(set.triangles, find_hinges(set.triangles, set.shapes[0]));
    out.distances.assign(out.parts.count(), 0);
    out.tree.hosts.assign(out.parts.count(), no_part);
    if (out.parts.count() < 2 && border.empty()) return out;
    const Eigen::MatrixXd columns = pose_space(set);
    if (out.parts.count() > 1) {
        const PartPoints points = sample_parts(columns, set.triangles, out.parts, point_spacing * set.diagonal);
        out.tree = connect_parts(out.parts, find_holders(set, out.parts, columns), points, set.masses);
        Binder binder(set, points, out);
        for (const std::size_t part : out.tree.order) binder.bind(part);
    }
    find_joints(set, out);
    const std::size_t part_tie_count = out.ties.size();
    std::vector<std::size_t> part_of(std::size_t(columns.cols()), 0);
    for (std::size_t p = 0; p < out.parts.count(); ++p)
        for (const std::uint32_t v : out.parts.vertices[p]) part_of[v] = p;
    SeamBinder(set, columns, std::move(border)).bind([&](const std::array<std::uint32_t, 4>& vertices) {
        out.ties.push_back(make_tie(set, part_of[vertices[0]], vertices));
    });
    out.seam_count = out.ties.size() - part_tie_count;
    return out;
}

std::vector<TiePart> describe_parts(const TieSet& ties, const ShapeSet& set)
{
    std::vector<TiePart> out;
    for (std::size_t p = 0; p < ties.parts.count(); ++p) {
        const std::size_t host = ties.tree.hosts[p] == no_part ? p : ties.tree.hosts[p];
        out.push_back({ ties.parts.vertices[p][0], ties.parts.vertices[host][0], ties.parts.vertices[p].size(), 0,
                        ties.distances[p] / set.diagonal });
    }
    for (std::size_t i = 0; i + ties.seam_count < ties.ties.size(); ++i) ++out[ties.ties[i].part].tie_count;
    return out;
}

namespace {

// Where the anchors of a tie, as they are in y, would have the tied vertex: in pose k (columns of the first), and where it is.
struct Places {
    Eigen::Matrix3Xd wanted;
    Eigen::Vector3d found;
};

Places places_of(const Tie& tie, const Shape& y)
{
    const auto& v = tie.vertices;
    const Eigen::Matrix3d vectors = tie_vectors(tie, point(y, v[0]), point(y, v[1]), point(y, v[2]), point(y, v[3]));
    Eigen::Matrix3d frame; // rows e1, e2, n
    frame << vectors.col(1).transpose(), vectors.col(2).transpose(), vectors.col(1).cross(vectors.col(2)).transpose();
    return { (frame.inverse() * tie.rest).colwise() + point(y, v[1]), point(y, v[0]) };
}

// The weighted mean of clouds of points (3 x count each) that does not shrink where they are turned against each other: of their shapes, as
// the plain mean is turned, or, of rigid ones, in the mean of their turns; it lies where the weighted mean of its steadiest point does.
Eigen::Matrix3Xd mean_cloud(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::VectorXd& weights, bool is_rigid)
{
    const Eigen::Index count = clouds[0].cols();
    const Eigen::VectorXd shares = weights / weights.sum();
    Eigen::Matrix3Xd plain = Eigen::Matrix3Xd::Zero(3, count);
    for (std::size_t k = 0; k < clouds.size(); ++k) plain += shares[Eigen::Index(k)] * clouds[k];
    if (count < 3) return plain;        // nothing that could be seen to turn
    std::vector<Eigen::Matrix3d> turns; // from the mean shape
    Eigen::Matrix3d mean_turn = Eigen::Matrix3d::Zero();
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, count), centres(3, Eigen::Index(clouds.size()));
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const double share = shares[Eigen::Index(k)];
        turns.push_back(turn_between(plain, clouds[k]));
        centres.col(Eigen::Index(k)) = clouds[k].rowwise().mean();
        mean += share * (turns[k].transpose() * (clouds[k].colwise() - centres.col(Eigen::Index(k))));
        mean_turn += share * turns[k];
    }
    const Eigen::Vector3d steadiest = steadiest_point(turns, centres, mean.colwise().norm().maxCoeff());
    Eigen::Vector3d place = centres * shares;
    for (std::size_t k = 0; k < clouds.size(); ++k) place += shares[Eigen::Index(k)] * (turns[k] * steadiest);
    const Eigen::Matrix3d turn = is_rigid ? nearest_rotation(mean_turn) : Eigen::Matrix3d::Identity();
    return (turn * (mean.colwise() - steadiest)).colwise() + place;
}

} // namespace

const Joint* joint_of(const TieSet& ties, std::size_t first_tie)
{
    for (const Joint& joint : ties.joints)
        if (joint.first_tie == first_tie) return &joint;
    return nullptr;
}

std::vector<PartPlaces> place_parts(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y)
{
    std::vector<PartPlaces> out;
    for (std::size_t first = 0, last = 0; first < ties.ties.size(); first = last) {
        last = end_of_part(ties, first);
        const Eigen::Index count = Eigen::Index(last - first);
        PartPlaces places = { ties.ties[first].part, first, Eigen::Matrix3Xd(3, count), {}, Eigen::Matrix3Xd(3, count) };
        std::vector<Eigen::Matrix3Xd> clouds(set.pose_count(), Eigen::Matrix3Xd(3, count));
        for (Eigen::Index i = 0; i < count; ++i) {
            const Places one = places_of(ties.ties[first + std::size_t(i)], y);
            for (std::size_t k = 0; k < clouds.size(); ++k) clouds[k].col(i) = one.wanted.col(Eigen::Index(k));
            places.found.col(i) = one.found;
            places.pulled.col(i) = one.wanted * weights / weights.sum();
        }
        places.wanted = mean_cloud(clouds, weights, joint_of(ties, first) != nullptr);
        out.push_back(std::move(places));
    }
    return out;
}

TieDrift measure_drift(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y)
{
    TieDrift out;
    for (const PartPlaces& places : place_parts(ties, set, weights, y))
        for (std::size_t i = 0; i < std::size_t(places.found.cols()); ++i) {
            const double drift = places.drift(i) / set.diagonal;
            if (!(drift <= out.largest)) out = { drift, places.part, ties.ties[places.first + i].vertices[0] };
        }
    return out;
}

} // namespace pliant
