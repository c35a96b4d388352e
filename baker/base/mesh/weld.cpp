#include "base/mesh/weld.h"

#include "base/common/random.h"
#include "base/common/sha256.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <optional>
#include <string>

namespace pliant {
namespace {

using Index = std::uint32_t;

// Directions that follow from all coordinates, so that nobody can lay vertices across them, where they would have equal
// heights and take quadratic time.
std::uint64_t seed_of(const std::vector<const Positions*>& poses)
{
    std::string digests;
    for (const Positions* pose : poses)
        digests += sha256_hex({ reinterpret_cast<const char*>(pose->data()), std::size_t(pose->size()) * sizeof(double) });
    return std::stoull(sha256_hex(digests).substr(0, 16), nullptr, 16);
}

class Welder {
public:
    Welder(const std::vector<const Positions*>& poses, double tolerance, Random& random)
        : poses_(poses)
        , window_(tolerance * double(poses.size()))
        , heights_(Eigen::VectorXd::Zero(poses[0]->rows()))
    {
        for (const Positions* pose : poses) {
            const Eigen::RowVector3d low = pose->colwise().minCoeff(), high = pose->colwise().maxCoeff();
            const double diagonal = (high - low).norm();
            reach_.push_back(tolerance * diagonal);
            const Eigen::Vector3d up = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
            if (diagonal > 0) heights_ += (pose->rowwise() - low) / diagonal * up;
        }
    }

    // Nothing if it takes more comparisons than `limit`. A vertex is compared with the `limit_of_vertex` centres that are
    // nearest in height.
    std::optional<std::vector<Index>> weld(std::uint64_t limit, std::uint64_t limit_of_vertex);

private:
    bool is_near(Index a, Index b) const
    {
        for (std::size_t k = 0; k < poses_.size(); ++k)
            if ((poses_[k]->row(a) - poses_[k]->row(b)).norm() > reach_[k]) return false;
        return true;
    }

    const std::vector<const Positions*>& poses_;
    double window_;
    Eigen::VectorXd heights_; // distances from planes, over the diagonals, added up over the poses
    std::vector<double> reach_;
};

// Upwards, each vertex to the centre of a cluster near it or a centre itself: no chain of short steps can join what is
// apart.
std::optional<std::vector<Index>> Welder::weld(std::uint64_t limit, std::uint64_t limit_of_vertex)
{
    std::vector<Index> order(static_cast<std::size_t>(heights_.size())), centres, centre_of(order.size());
    std::iota(order.begin(), order.end(), Index(0));
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return heights_[a] < heights_[b]; });
    const double rounding = 1e-14; // of heights, which are sums of a few numbers below 2
    for (const Index v : order) {
        centre_of[v] = v;
        std::uint64_t left = limit_of_vertex;
        for (auto c = centres.rbegin(); c != centres.rend() && heights_[v] - heights_[*c] <= window_ + rounding; ++c) {
            if (left-- == 0) break;
            if (limit-- == 0) return std::nullopt;
            if (!is_near(v, *c)) continue;
            centre_of[v] = *c;
            break;
        }
        if (centre_of[v] == v) centres.push_back(v);
    }
    // The lowest number of each cluster stands for it.
    std::vector<Index> lowest(order.size(), static_cast<Index>(order.size())), result(order.size());
    for (Index v = 0; v < order.size(); ++v) {
        Index& least = lowest[centre_of[v]];
        least = std::min(least, v);
        result[v] = least;
    }
    return result;
}

} // namespace

std::vector<Index> weld(const std::vector<const Positions*>& poses, double tolerance)
{
    constexpr std::uint64_t mean_limit = 64; // comparisons of a vertex
    if (tolerance > 0) {
        Random random(seed_of(poses));
        // A mesh may lie across the directions by chance: then others are tried.
        for (int attempt = 0; attempt < 8; ++attempt)
            if (auto result
                = Welder(poses, tolerance, random).weld(mean_limit * std::uint64_t(poses[0]->rows()), UINT64_MAX))
                return std::move(*result);
        return *Welder(poses, tolerance, random).weld(UINT64_MAX, mean_limit);
    }
    std::vector<Index> result(static_cast<std::size_t>(poses[0]->rows()));
    std::iota(result.begin(), result.end(), Index(0));
    return result;
}

} // namespace pliant
