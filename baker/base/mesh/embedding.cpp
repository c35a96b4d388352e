#include "base/mesh/embedding.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pliant {
namespace {

using Point = Eigen::Vector3d;

constexpr double weight_rounding = 1e-12; // of barycentric coordinates
constexpr double tie = 1e-9;              // relative difference of squared distances that are the same
constexpr std::size_t tets_of_leaf = 4;

// Of tetrahedra at one distance no more are compared: a vertex of a good mesh has some dozens.
constexpr std::size_t most_ties = 256;

// The point of triangle a b c next to p (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
Point closest_in_triangle(const Point& p, const Point& a, const Point& b, const Point& c)
{
    const Point ab = b - a, ac = c - a;
    const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
    if (d1 <= 0 && d2 <= 0) return a;
    const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
    if (d3 >= 0 && d4 <= d3) return b;
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
    if (d6 >= 0 && d5 <= d6) return c;
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    return a + (vb * ab + vc * ac) / (va + vb + vc);
}

struct Hit {
    std::size_t tet = 0;
    Eigen::Vector4d weights = Eigen::Vector4d::Zero();
    double squared_distance = std::numeric_limits<double>::infinity();
};

// Boxes around boxes around a few tetrahedra each.
class TetTree {
public:
    TetTree(const Positions& vertices, const std::vector<Tetrahedron>& tets)
        : order_(tets.size())
    {
        for (std::size_t t = 0; t < tets.size(); ++t) {
            Eigen::Matrix3d edges;
            Eigen::AlignedBox3d box;
            for (std::size_t i = 0; i < 4; ++i) {
                const Point corner = vertices.row(tets[t][i]);
                points_.push_back(corner);
                box.extend(corner);
                if (i > 0) edges.col(Eigen::Index(i) - 1) = corner - points_[4 * t];
            }
            inverses_.push_back(edges.inverse());
            boxes_.push_back(box);
        }
        std::iota(order_.begin(), order_.end(), std::size_t(0));
        build(0, tets.size());
    }

    // The tetrahedron next to p, if it is within the reach; else the hit's distance is infinite.
    Hit nearest(const Point& p, double reach) const
    {
        Hit best;
        double limit = reach * reach;
        std::size_t tie_count = 0;
        std::vector<std::size_t> open = { 0 };
        while (!open.empty()) {
            const std::size_t index = open.back();
            open.pop_back();
            const Node& node = nodes_[index];
            if (!(node.box.squaredExteriorDistance(p) <= limit * (1 + tie))) continue;
            if (node.right == 0) {
                for (std::size_t i = node.first; i < node.last; ++i) improve(p, order_[i], best, limit, tie_count);
                if (best.squared_distance == 0 || tie_count > most_ties) return best;
                continue;
            }
            const std::size_t left = index + 1, right = node.right;
            const bool left_first
                = nodes_[left].box.squaredExteriorDistance(p) <= nodes_[right].box.squaredExteriorDistance(p);
            open.push_back(left_first ? right : left);
            open.push_back(left_first ? left : right);
        }
        return best;
    }

private:
    struct Node {
        Eigen::AlignedBox3d box;
        std::size_t first, last; // of order_
        std::size_t right = 0;   // the left child stands behind its parent; 0: a leaf
    };

    void build(std::size_t first, std::size_t last)
    {
        const std::size_t index = nodes_.size();
        Node node { {}, first, last };
        Eigen::AlignedBox3d centres;
        for (std::size_t i = first; i < last; ++i) {
            node.box.extend(boxes_[order_[i]]);
            centres.extend(boxes_[order_[i]].center());
        }
        nodes_.push_back(node);
        if (last - first <= tets_of_leaf) return;
        Eigen::Index axis = 0;
        centres.sizes().maxCoeff(&axis);
        const std::size_t middle = first + (last - first) / 2;
        const auto at = [this](std::size_t i) { return order_.begin() + std::ptrdiff_t(i); };
        std::nth_element(at(first), at(middle), at(last), [this, axis](std::size_t a, std::size_t b) {
            const double x = boxes_[a].center()[axis], y = boxes_[b].center()[axis];
            return x != y ? x < y : a < b;
        });
        build(first, middle);
        nodes_[index].right = nodes_.size();
        build(middle, last);
    }

    // Takes the tetrahedron if it is nearer than the best, or as near with smaller coordinates.
    // Counts the tetrahedra that are as near as the best.
    void improve(const Point& p, std::size_t tet, Hit& best, double& limit, std::size_t& tie_count) const
    {
        if (!(boxes_[tet].squaredExteriorDistance(p) <= limit * (1 + tie))) return;
        const Point* corners = &points_[4 * tet];
        Hit hit;
        hit.tet = tet;
        hit.weights.tail<3>() = inverses_[tet] * (p - corners[0]);
        hit.weights[0] = 1 - hit.weights.tail<3>().sum();
        if (hit.weights.minCoeff() >= -weight_rounding) hit.squared_distance = 0;
        // What is nearest of a convex body lies in a face that p is in front of.
        for (std::size_t i = 0; i < 4 && hit.squared_distance > 0; ++i)
            if (hit.weights[Eigen::Index(i)] < 0) {
                const Point next = closest_in_triangle(p, corners[(i + 1) % 4], corners[(i + 2) % 4], corners[(i + 3) % 4]);
                hit.squared_distance = std::min(hit.squared_distance, (p - next).squaredNorm());
            }
        if (!(hit.squared_distance <= limit * (1 + tie))) return;
        const bool is_nearer = hit.squared_distance < limit * (1 - tie);
        tie_count = is_nearer ? 0 : tie_count + 1;
        if (!is_nearer && hit.weights.lpNorm<1>() >= best.weights.lpNorm<1>() && std::isfinite(best.squared_distance))
            return;
        limit = std::min(limit, hit.squared_distance);
        best = hit;
    }

    std::vector<Point> points_; // four per tetrahedron
    std::vector<Eigen::Matrix3d> inverses_;
    std::vector<Eigen::AlignedBox3d> boxes_;
    std::vector<std::size_t> order_;
    std::vector<Node> nodes_;
};

// Without rounding: a point in a face or at a vertex moves exactly with it.
Eigen::Vector4d clean(const Hit& hit)
{
    Eigen::Vector4d weights = hit.weights;
    for (double& w : weights)
        if (std::abs(w) < weight_rounding || (hit.squared_distance == 0 && w < 0)) w = 0;
    return weights / weights.sum();
}

} // namespace

Embedding embed(const Positions& points, const Positions& vertices, const std::vector<Tetrahedron>& tets, double reach)
{
    // Around the solid and in units of its size, so that nothing overflows and no digits are lost far from the origin.
    const Eigen::RowVector3d low = vertices.colwise().minCoeff(), high = vertices.colwise().maxCoeff();
    const Eigen::RowVector3d middle = 0.5 * low + 0.5 * high;
    const double size = (high - low).maxCoeff();
    const TetTree tree((vertices.rowwise() - middle) / size, tets);
    Embedding out;
    out.corners.resize(std::size_t(points.rows()));
    out.weights.setZero(4, points.rows());
    out.distances.resize(points.rows());
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
        const Hit hit = tree.nearest((points.row(v) - middle).transpose() / size, reach / size);
        out.distances[v] = size * std::sqrt(hit.squared_distance);
        out.corners[std::size_t(v)] = tets[hit.tet];
        if (std::isfinite(hit.squared_distance)) out.weights.col(v) = clean(hit);
    }
    return out;
}

Eigen::MatrixXd apply(const Embedding& embedding, const Eigen::Ref<const Eigen::MatrixXd>& columns)
{
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(3 * Eigen::Index(embedding.count()), columns.cols());
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
        for (std::size_t v = 0; v < embedding.count(); ++v)
            for (Eigen::Index i = 0; i < 4; ++i)
                out.col(j).segment<3>(3 * Eigen::Index(v)) += embedding.weights(i, Eigen::Index(v))
                    * columns.col(j).segment<3>(3 * Eigen::Index(embedding.corners[v][std::size_t(i)]));
    return out;
}

} // namespace pliant
