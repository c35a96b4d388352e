#include "face_motions.h"
#include "rival.h"

#include "base/common/union_find.h"
#include "elastic/average/sparse_cholesky.h"
#include "elastic/energy/best_rotation.h"

#include <array>

namespace pliant {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;

// From the frame of one triangle to that of its neighbour: first * map = second.
struct Connection {
    std::array<std::uint32_t, 2> faces;
    Matrix3d at_pose_0;
    std::vector<Eigen::Vector3d> turns; // of each pose, beyond that of pose 0
};

class ConnectionMaps final : public Rival {
public:
    explicit ConnectionMaps(const NormalizedPoses& set)
        : set_(set)
        , fit_(set, default_solver())
        , frames_(default_solver())
    {
        for (const Shape& shape : set.shapes) motions_.push_back(face_motions(set, shape));
        UnionFind parts(set.triangles.size());
        for (const Hinge& hinge : find_hinges(set.triangles, set.shapes[0])) {
            connections_.push_back(connect(hinge.faces));
            parts.join(hinge.faces[0], hinge.faces[1]);
        }
        for (std::uint32_t face = 0; face < set.triangles.size(); ++face) is_known_.push_back(parts.find(face) == face);
    }
    const RivalTraits& traits() const override
    {
        static const RivalTraits traits { "connection maps", "Kircher and Garland 2008", true, false,
                                          "stretches and turns do not fit" };
        return traits;
    }
    Shape blend(const Weights& w) override
    {
        std::vector<FaceMotion> blended = blend_motions(motions_, w); // of the known faces, and all stretches
        solve_frames(w, blended);
        return put_together(set_, fit_, w, blended);
    }

private:
    Connection connect(const std::array<std::uint32_t, 2>& faces) const
    {
        const auto map = [&](std::size_t k) -> Matrix3d {
            return motions_[k][faces[0]].rotation.transpose() * motions_[k][faces[1]].rotation;
        };
        Connection connection { faces, map(0), {} };
        for (std::size_t k = 0; k < motions_.size(); ++k)
            connection.turns.push_back(rotation_vector(connection.at_pose_0.transpose() * map(k)));
        return connection;
    }

    // Least squares over all connections of |second - first * map|^2; the rows of a frame are unknowns of their own, with
    // the same matrix.
    void solve_frames(const Weights& w, std::vector<FaceMotion>& blended)
    {
        const Index count = 3 * Index(blended.size());
        std::vector<Eigen::Triplet<double, std::int64_t>> entries;
        Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 3);
        const auto add = [&](std::uint32_t row, std::uint32_t column, const Matrix3d& block) {
            if (is_known_[row]) return;
            if (is_known_[column])
                right.middleRows<3>(3 * Index(row)) -= block * blended[column].rotation.transpose();
            else
                for (Index i = 0; i < 3; ++i)
                    for (Index j = 0; j < 3; ++j)
                        if (3 * row + i >= 3 * column + j) entries.emplace_back(3 * row + i, 3 * column + j, block(i, j));
        };
        for (const Connection& connection : connections_) {
            Eigen::Vector3d turn = Eigen::Vector3d::Zero();
            for (std::size_t k = 0; k < motions_.size(); ++k) turn += w[Index(k)] * connection.turns[k];
            const Matrix3d map = connection.at_pose_0 * rotation_by(turn);
            const auto [first, second] = connection.faces;
            add(first, first, Matrix3d::Identity());
            add(second, second, Matrix3d::Identity());
            add(second, first, -map.transpose());
            add(first, second, -map);
        }
        for (std::uint32_t face = 0; face < blended.size(); ++face)
            for (Index i = 0; is_known_[face] && i < 3; ++i) entries.emplace_back(3 * face + i, 3 * face + i, 1);
        SparseLower matrix(count, count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (!frames_.factorize(matrix)) throw std::runtime_error("the system of the frames is singular");
        const Eigen::MatrixXd rows = frames_.solve(right);
        for (std::size_t i = 0; i < blended.size(); ++i)
            if (!is_known_[i]) blended[i].rotation = best_rotation(rows.middleRows<3>(3 * Index(i)).transpose());
    }

    const NormalizedPoses& set_;
    CellFit fit_;
    SparseCholesky frames_;
    std::vector<std::vector<FaceMotion>> motions_; // of each pose
    std::vector<Connection> connections_;
    std::vector<bool> is_known_; // per triangle: its frame holds its connected part
};

} // namespace

std::unique_ptr<Rival> make_connection_maps(const NormalizedPoses& set) { return std::make_unique<ConnectionMaps>(set); }

} // namespace pliant
