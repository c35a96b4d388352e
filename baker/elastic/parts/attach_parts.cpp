#include "elastic/parts/attach_parts.h"

#include "elastic/parts/anchors.h"
#include "elastic/parts/part_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace pliant {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Lengths in units of the diagonal. Tied vertices of a part keep this distance, vertices this much farther from the parent than the
// nearest are tied as well, and faces longer than this are not only their corners.
constexpr double tie_spacing = 0.03, near_margin = 0.02, point_spacing = 0.01;

// A part has at least so many tied vertices if it has as many, so that it is held against turning with some to spare, and at most so
// many, so that what they cost stays small beside the part.
constexpr std::size_t min_ties = 12, max_ties = 400;

// At least this part of a part's vertices, the nearest ones, may be tied: a coat that hangs on the shoulders.
constexpr double near_share = 0.25;

// The parts that others may hang on. If places can be told from none, all with faces.
std::vector<bool> find_possible_parents(const ShapeSet& set, const Parts& parts, const Eigen::MatrixXd& columns)
{
    std::vector<bool> out(parts.count(), false);
    for (std::size_t p = 0; p < parts.surface_count; ++p)
        out[p] = can_anchor(set, parts.vertices[p], columns, poor_triangle);
    if (std::find(out.begin(), out.end(), true) == out.end())
        std::fill(out.begin(), out.begin() + std::ptrdiff_t(parts.surface_count), true);
    return out;
}

// Ties parts to their parents.
class PartAttacher {
public:
    PartAttacher(const ShapeSet& set, const PartPoints& points, TieSet& out)
        : set_(set)
        , points_(points)
        , columns_(points.columns)
        , out_(out)
        , trees_(out.parts.surface_count)
    {
    }

    void attach(std::size_t part)
    {
        if (out_.tree.parents[part] == no_part) return;
        const PartTrees& parent = trees(out_.tree.parents[part]);
        const Nearby mine = vertices_near(parent, part);
        out_.distances[part] = mine.nearest(0);
        // A plate under a small post touches it far from all its own corners: then the post's vertices are tied to the plate.
        const double margin = near_margin * set_.diagonal;
        if (part < out_.parts.surface_count && mine.nearest(2) > margin) {
            const Nearby theirs = vertices_near_points(parent, part);
            out_.distances[part] = std::min(mine.nearest(0), theirs.nearest(0));
            const std::vector<std::uint32_t> chosen = choose(theirs);
            if (theirs.nearest(2) + margin < mine.nearest(2) && can_anchor(set_, chosen, columns_, good_triangle)
                && tie_vertices(part, chosen, trees(part)))
                return;
        }
        tie_vertices(part, choose(mine), parent);
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

    Nearby vertices_near(const PartTrees& parent, std::size_t part) const
    {
        Nearby out = { out_.parts.vertices[part], {} };
        for (const std::uint32_t v : out.vertices)
            out.distances.push_back(std::sqrt(parent.surface.nearest(v, 1, infinity).squared_distance));
        return out;
    }

    // Of the parent those next to points of the part: no more than that has points, so that many parts on one parent cost no more than they are.
    Nearby vertices_near_points(const PartTrees& parent, std::size_t part) const
    {
        std::vector<std::pair<std::uint32_t, double>> found;
        for (const std::uint32_t column : points_.of_part[part]) {
            const Neighbour nearest = parent.vertices.nearest(column, 1, infinity);
            found.emplace_back(parent.vertices.points()[nearest.point].vertex, std::sqrt(nearest.squared_distance));
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
    bool tie_vertices(std::size_t part, const std::vector<std::uint32_t>& vertices, const PartTrees& anchors)
    {
        const std::size_t before = out_.ties.size();
        for (const std::uint32_t v : vertices)
            if (const std::optional<Tie> tie = tie_vertex(set_, columns_, part, v, anchors)) out_.ties.push_back(*tie);
        return out_.ties.size() > before;
    }

    const PartTrees& trees(std::size_t part)
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
            trees_[part] = std::make_unique<PartTrees>(PartTrees { { columns_, tree_points(points_.of_part[part]) },
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
            { nearby.nearest(0) + near_margin * set_.diagonal, nearby.nearest(quarter), nearby.nearest(min_ties) });
        std::vector<double> gaps(count); // to the nearest chosen one; negative: out of reach
        for (std::size_t i = 0; i < count; ++i) gaps[i] = nearby.distances[i] <= reach ? infinity : -1;
        std::vector<std::uint32_t> chosen;
        std::size_t next
            = std::size_t(std::min_element(nearby.distances.begin(), nearby.distances.end()) - nearby.distances.begin());
        while (chosen.size() < max_ties) {
            chosen.push_back(nearby.vertices[next]);
            for (std::size_t i = 0; i < count; ++i)
                if (gaps[i] > 0)
                    gaps[i] = std::min(gaps[i], (columns_.col(nearby.vertices[i]) - columns_.col(chosen.back())).norm());
            next = std::size_t(std::max_element(gaps.begin(), gaps.end()) - gaps.begin());
            if (!(gaps[next] > 0) || (chosen.size() >= min_ties && gaps[next] < tie_spacing * set_.diagonal)) break;
        }
        return chosen;
    }

    const ShapeSet& set_;
    const PartPoints& points_;
    const Eigen::MatrixXd& columns_;
    TieSet& out_;
    std::vector<std::unique_ptr<PartTrees>> trees_;
};

} // namespace

void attach_parts(const ShapeSet& set, const Eigen::MatrixXd& columns, TieSet& out)
{
    const PartPoints points = sample_parts(columns, set.triangles, out.parts, point_spacing * set.diagonal);
    out.tree = connect_parts(out.parts, find_possible_parents(set, out.parts, columns), points, set.masses);
    PartAttacher attacher(set, points, out);
    for (const std::size_t part : out.tree.order) attacher.attach(part);
}

} // namespace pliant
