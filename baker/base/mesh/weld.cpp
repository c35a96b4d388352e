#include "base/mesh/weld.h"

#include "base/common/random.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <numeric>

namespace pliant {
namespace {

using Index = std::uint32_t;

std::uint64_t hash_of(const std::vector<const Positions*>& poses)
{
    std::uint64_t hash = 0;
    for (const Positions* pose : poses)
        for (Eigen::Index i = 0; i < pose->size(); ++i) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, pose->data() + i, sizeof bits);
            hash = (hash ^ bits) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
    return hash;
}

class Welder {
public:
    Welder(const std::vector<const Positions*>& poses, double tolerance)
        : poses_(poses)
        , window_(tolerance * double(poses.size()))
        , heights_(Eigen::VectorXd::Zero(poses[0]->rows()))
    {
        // Along a direction that depends on all coordinates, and another one for each pose: nobody can make a mesh with many
        // vertices at equal heights, which would take quadratic time.
        Random random(hash_of(poses));
        for (const Positions* pose : poses) {
            const Eigen::RowVector3d low = pose->colwise().minCoeff(), high = pose->colwise().maxCoeff();
            const double diagonal = (high - low).norm();
            reach_.push_back(tolerance * diagonal);
            const Eigen::Vector3d up = Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
            if (diagonal > 0) heights_ += (pose->rowwise() - low) / diagonal * up;
        }
    }

    std::vector<Index> weld();

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
std::vector<Index> Welder::weld()
{
    std::vector<Index> order(static_cast<std::size_t>(heights_.size())), centres, centre_of(order.size());
    std::iota(order.begin(), order.end(), Index(0));
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return heights_[a] < heights_[b]; });
    const double rounding = 1e-14; // of heights, which are sums of a few numbers below 2
    for (const Index v : order) {
        centre_of[v] = v;
        for (auto c = centres.rbegin(); c != centres.rend() && heights_[v] - heights_[*c] <= window_ + rounding; ++c) {
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
    if (tolerance > 0) return Welder(poses, tolerance).weld();
    std::vector<Index> result(static_cast<std::size_t>(poses[0]->rows()));
    std::iota(result.begin(), result.end(), Index(0));
    return result;
}

} // namespace pliant
