#include "output/asset/bounds.h"

#include "output/asset/bytes.h"
#include "pliant_format.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

// More make boxes a little tighter, cost time in each frame, and bytes: 24 for each dimension.
constexpr std::size_t cluster_limit = 64;
constexpr std::size_t vertices_per_cluster = 16;
constexpr Eigen::Index sample_limit = 6; // shapes that clusters are to be small in

using Vertices = std::vector<Eigen::Index>;

// Where a cluster is widest: along which coordinate of which shape, and where its middle is.
struct Cut {
    double extent = 0;
    Eigen::Index shape = 0, coordinate = 0;
    double middle = 0;
};

struct Cluster {
    Vertices vertices;
    Cut cut;
};

Cut widest(const Eigen::MatrixXd& shapes, const Vertices& vertices)
{
    Cut cut;
    for (Eigen::Index s = 0; s < shapes.cols(); ++s)
        for (Eigen::Index c = 0; c < 3; ++c) {
            double low = INFINITY, high = -INFINITY;
            for (Eigen::Index v : vertices) {
                low = std::min(low, shapes(3 * v + c, s));
                high = std::max(high, shapes(3 * v + c, s));
            }
            if (high - low > cut.extent) cut = { high - low, s, c, (low + high) / 2 };
        }
    return cut;
}

// Halves the widest cluster until there are enough.
std::vector<Cluster> find_clusters(const Eigen::MatrixXd& shapes)
{
    const std::size_t vertex_count = std::size_t(shapes.rows() / 3);
    std::vector<Cluster> clusters(1);
    clusters[0].vertices.resize(vertex_count);
    std::iota(clusters[0].vertices.begin(), clusters[0].vertices.end(), 0);
    clusters[0].cut = widest(shapes, clusters[0].vertices);
    const std::size_t wanted = std::clamp<std::size_t>(vertex_count / vertices_per_cluster, 1, cluster_limit);
    while (clusters.size() < wanted) {
        const auto most = std::max_element(clusters.begin(), clusters.end(),
                                           [](const Cluster& a, const Cluster& b) { return a.cut.extent < b.cut.extent; });
        const Cut cut = most->cut;
        if (cut.extent == 0) break;
        Cluster right;
        Vertices left;
        for (Eigen::Index v : most->vertices)
            (shapes(3 * v + cut.coordinate, cut.shape) > cut.middle ? right.vertices : left).push_back(v);
        if (left.empty() || right.vertices.empty()) break; // the middle of neighbouring numbers is one of them
        most->vertices = std::move(left);
        most->cut = widest(shapes, most->vertices);
        right.cut = widest(shapes, right.vertices);
        clusters.push_back(std::move(right));
    }
    return clusters;
}

pliant_format_interval interval_of(const Eigen::Ref<const Eigen::VectorXd>& values, const Vertices& vertices)
{
    pliant_format_interval out {};
    for (Eigen::Index c = 0; c < 3; ++c) {
        double low = INFINITY, high = -INFINITY;
        for (Eigen::Index v : vertices) {
            low = std::min(low, values[3 * v + c]);
            high = std::max(high, values[3 * v + c]);
        }
        out.centre[c] = float((low + high) / 2);
        const double centre = double(out.centre[c]);
        out.radius[c] = std::nextafter(float(std::max(high - centre, centre - low)), INFINITY); // outwards
    }
    return out;
}

} // namespace

std::vector<std::uint8_t> encode_bounds(const Eigen::Vector3d& centre, const Eigen::VectorXd& rest,
                                        const Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples)
{
    const Eigen::VectorXd placed = rest + centre.replicate(rest.size() / 3, 1);
    const Eigen::Index count = std::min(sample_limit, samples.cols());
    Eigen::MatrixXd shapes(rest.size(), 1 + count);
    shapes.col(0) = placed;
    for (Eigen::Index s = 0; s < count; ++s) // the last samples are the poses
        shapes.col(1 + s) = placed + columns * samples.col(samples.cols() - 1 - s * samples.cols() / count);
    const std::vector<Cluster> clusters = find_clusters(shapes);
    pliant_format_count head {};
    head.count = std::uint32_t(clusters.size());
    Bytes out;
    out.put(head);
    for (const Cluster& cluster : clusters) {
        out.put(interval_of(placed, cluster.vertices));
        for (Eigen::Index j = 0; j < columns.cols(); ++j) out.put(interval_of(columns.col(j), cluster.vertices));
    }
    return std::move(out.data);
}

} // namespace pliant
