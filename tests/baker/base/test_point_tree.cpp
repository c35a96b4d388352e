// The nearest point with another label is the one that comparing all of them finds.
#include <doctest/doctest.h>

#include "base/mesh/point_tree.h"

#include <algorithm>

using namespace pliant;

namespace {

Neighbour nearest_of_all(const Eigen::MatrixXd& columns, const std::vector<std::uint32_t>& labels, std::uint32_t v,
                         double squared_limit)
{
    Neighbour best = { labels.size(), squared_limit };
    for (std::uint32_t u = 0; u < labels.size(); ++u) {
        const double squared = (columns.col(u) - columns.col(v)).squaredNorm();
        if (u != v && labels[u] != labels[v] && squared < best.squared_distance) best = { u, squared };
    }
    return best;
}

} // namespace

TEST_CASE("nearest with another label, however labels lie among the points")
{
    constexpr std::uint32_t n = 400;
    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(6, n);
    std::vector<TreePoint> points;
    for (std::uint32_t v = 0; v < n; ++v) points.push_back({ v, v });
    PointTree tree(columns, points);
    for (const std::uint32_t label_count : { 1u, 2u, 3u, 40u, n })
        for (const bool is_by_place : { false, true }) {
            std::vector<std::uint32_t> labels;
            for (std::uint32_t v = 0; v < n; ++v)
                labels.push_back(is_by_place ? std::uint32_t((columns(0, v) + 1) / 2 * label_count) : v % label_count);
            tree.relabel(labels);
            for (std::uint32_t v = 0; v < n; ++v) {
                const Neighbour found = tree.nearest(v, labels[v], 1.5), wanted = nearest_of_all(columns, labels, v, 1.5);
                CHECK(found.point == wanted.point);
                CHECK(found.squared_distance == wanted.squared_distance);
            }
        }
    // A limit ends the search with what it has.
    CHECK(tree.ball(columns.col(0), infinity, 0).size() == n);
    CHECK(tree.ball(columns.col(0), infinity, 0, 20).size() < n / 2);
}
