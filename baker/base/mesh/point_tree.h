// Vertices near one another in all poses: a tree over points of R^(3m), the positions of a vertex in the m poses in one
// vector.
#pragma once

#include "base/mesh/align.h"

#include <cstdint>
#include <limits>

namespace pliant {

// 3m x n: column v holds the positions of vertex v in all poses, divided by sqrt(m), so that the distance of two columns is
// the root of the mean over the poses of the squared distance of the two vertices. Two vertices are near by it only if they
// are near in every pose.
Eigen::MatrixXd pose_space(const NormalizedPoses& set);

// One point of a tree: a vertex, and the number of what it belongs to.
struct TreePoint {
    std::uint32_t vertex;
    std::uint32_t label;
};

struct Neighbour {
    std::size_t point; // of the tree's points
    double squared_distance;
};

constexpr double infinity = std::numeric_limits<double>::infinity(); // a distance that all others are below

// Balls around balls around a few points each. Everything is decided by distances, then by the order of the points: the same
// answers on every machine. Building costs n log n.
class PointTree {
public:
    // `columns` must outlive the tree.
    PointTree(const Eigen::MatrixXd& columns, std::vector<TreePoint> points);

    const std::vector<TreePoint>& points() const { return points_; }

    // What points have the labels that `labels` gives for their own: for nearest().
    void relabel(const std::vector<std::uint32_t>& labels);

    // The point next to vertex v that is not v and has not this label (after relabel), nearer than `squared_limit`; its
    // distance is
    // `squared_limit` and its number points().size() if there is none. Without relabel all labels are 0: any other label
    // finds all.
    Neighbour nearest(std::uint32_t v, std::uint32_t label, double squared_limit) const;

    // The vertices of some points within `radius` of a centre (3m): all of them, but of those that lie within about
    // `resolution` of one another only one. Their number is bounded by the ratio of the two, not by n, unless the resolution
    // is 0. After `visit_limit` nodes of the tree those that were found.
    std::vector<std::uint32_t> ball(const Eigen::VectorXd& centre, double radius, double resolution,
                                    std::size_t visit_limit = SIZE_MAX) const;

private:
    struct Node {
        double radius;
        std::size_t first, last; // of order_
        std::size_t right;       // the left child stands behind its parent; 0: a leaf
        std::uint32_t label;     // of all points below, or mixed
    };
    void build(std::size_t first, std::size_t last);
    double squared_distance(std::uint32_t v, std::uint32_t u) const
    {
        return (columns_.col(v) - columns_.col(u)).squaredNorm();
    }
    double gap(const Eigen::Ref<const Eigen::VectorXd>& x,
               std::size_t node) const; // least distance that a point below the node can have

    const Eigen::MatrixXd& columns_;
    std::vector<TreePoint> points_;
    std::vector<std::uint32_t> labels_; // of points, after relabel
    std::vector<std::size_t> order_;
    std::vector<Node> nodes_;
    std::vector<Eigen::VectorXd> centres_; // of nodes
};

} // namespace pliant
