#include "base/mesh/point_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {
namespace {

constexpr std::size_t points_of_leaf = 8; // fewer make the tree larger than the points
constexpr std::uint32_t mixed = ~std::uint32_t(0);

} // namespace

Eigen::MatrixXd pose_space(const NormalizedPoses& set)
{
    const Eigen::Index n = set.dof_count() / 3, m = Eigen::Index(set.pose_count());
    Eigen::MatrixXd columns(3 * m, n);
    for (Eigen::Index k = 0; k < m; ++k)
        columns.middleRows<3>(3 * k)
            = Eigen::Map<const Eigen::Matrix3Xd>(set.shapes[std::size_t(k)].data(), 3, n) / std::sqrt(double(m));
    return columns;
}

PointTree::PointTree(const Eigen::MatrixXd& columns, std::vector<TreePoint> points)
    : columns_(columns)
    , points_(std::move(points))
    , labels_(points_.size(), 0)
    , order_(points_.size())
{
    std::iota(order_.begin(), order_.end(), std::size_t(0));
    if (!points_.empty()) build(0, points_.size());
}

void PointTree::build(std::size_t first, std::size_t last)
{
    const std::size_t index = nodes_.size();
    const auto column = [this](std::size_t i) { return columns_.col(points_[order_[i]].vertex); };
    Eigen::VectorXd low = column(first), high = low;
    for (std::size_t i = first + 1; i < last; ++i) {
        low = low.cwiseMin(column(i));
        high = high.cwiseMax(column(i));
    }
    const Eigen::VectorXd centre = 0.5 * (low + high);
    double squared_radius = 0;
    for (std::size_t i = first; i < last; ++i) squared_radius = std::max(squared_radius, (column(i) - centre).squaredNorm());
    nodes_.push_back({ std::sqrt(squared_radius), first, last, 0, 0 });
    centres_.push_back(centre);
    if (last - first <= points_of_leaf) return;
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = first + (last - first) / 2;
    const auto at = [this](std::size_t i) { return order_.begin() + std::ptrdiff_t(i); };
    std::nth_element(at(first), at(middle), at(last), [this, axis](std::size_t a, std::size_t b) {
        const double x = columns_(axis, points_[a].vertex), y = columns_(axis, points_[b].vertex);
        return x != y ? x < y : a < b;
    });
    build(first, middle);
    nodes_[index].right = nodes_.size();
    build(middle, last);
}

void PointTree::relabel(const std::vector<std::uint32_t>& labels)
{
    for (std::size_t p = 0; p < points_.size(); ++p) labels_[p] = labels[points_[p].label];
    for (std::size_t i = nodes_.size(); i-- > 0;) { // children before their parents
        Node& node = nodes_[i];
        if (node.right != 0) {
            node.label = nodes_[i + 1].label == nodes_[node.right].label ? nodes_[i + 1].label : mixed;
            continue;
        }
        node.label = labels_[order_[node.first]];
        for (std::size_t j = node.first; j < node.last; ++j)
            if (labels_[order_[j]] != node.label) node.label = mixed;
    }
}

double PointTree::gap(const Eigen::Ref<const Eigen::VectorXd>& x, std::size_t node) const
{
    return std::max(0.0, (x - centres_[node]).norm() - nodes_[node].radius);
}

Neighbour PointTree::nearest(std::uint32_t v, std::uint32_t label, double squared_limit) const
{
    Neighbour best = { points_.size(), squared_limit };
    std::vector<std::pair<double, std::size_t>> open;
    if (!nodes_.empty()) open.push_back({ gap(columns_.col(v), 0), 0 });
    while (!open.empty()) {
        const auto [distance, index] = open.back();
        open.pop_back();
        const Node& node = nodes_[index];
        if (node.label == label || distance * distance > best.squared_distance) continue;
        if (node.right != 0) {
            const std::pair<double, std::size_t> left(gap(columns_.col(v), index + 1), index + 1),
                right(gap(columns_.col(v), node.right), node.right);
            open.push_back(std::max(left, right));
            open.push_back(std::min(left, right));
            continue;
        }
        for (std::size_t i = node.first; i < node.last; ++i) {
            const std::size_t p = order_[i];
            if (labels_[p] == label || points_[p].vertex == v) continue;
            const double found = squared_distance(v, points_[p].vertex);
            if (found < best.squared_distance || (found == best.squared_distance && p < best.point)) best = { p, found };
        }
    }
    return best;
}

std::vector<std::uint32_t> PointTree::ball(const Eigen::VectorXd& centre, double radius, double resolution,
                                           std::size_t visit_limit) const
{
    std::vector<std::uint32_t> found;
    std::vector<std::size_t> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty() && visit_limit-- > 0) {
        const std::size_t index = open.back();
        open.pop_back();
        const Node& node = nodes_[index];
        if (gap(centre, index) > radius) continue;
        // Points as near to one another as this count as one; on the rim of the ball it may take a few to find it.
        const bool is_small = node.radius <= 0.5 * resolution;
        if (node.right != 0 && !is_small) {
            open.push_back(node.right);
            open.push_back(index + 1);
            continue;
        }
        for (std::size_t i = node.first; i < node.last; ++i) {
            const std::uint32_t v = points_[order_[i]].vertex;
            if ((columns_.col(v) - centre).squaredNorm() > radius * radius) continue;
            found.push_back(v);
            if (is_small) break;
        }
    }
    return found;
}

} // namespace pliant
