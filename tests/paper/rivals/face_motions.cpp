#include "face_motions.h"

#include "elastic/energy/best_rotation.h"

#include <Eigen/Geometry>
#include <cmath>

namespace pliant {

namespace {

Eigen::Matrix3d frame_of(const Shape& shape, const Triangle& t)
{
    Eigen::Matrix3d frame;
    frame.leftCols<2>() = edges_of(shape, t);
    const Eigen::Vector3d normal = frame.col(0).cross(frame.col(1));
    frame.col(2) = normal / std::sqrt(normal.norm());
    return frame;
}

} // namespace

std::vector<FaceMotion> face_motions(const NormalizedPoses& set, const Shape& shape)
{
    std::vector<FaceMotion> motions;
    for (const Triangle& t : set.triangles) {
        const Eigen::Matrix3d gradient = frame_of(shape, t) * frame_of(set.shapes[0], t).inverse();
        const Eigen::Matrix3d rotation = best_rotation(gradient);
        motions.push_back({ rotation, rotation.transpose() * gradient });
    }
    return motions;
}

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation)
{
    const Eigen::AngleAxisd turned(rotation);
    return turned.angle() * turned.axis();
}

std::vector<FaceMotion> blend_motions(const std::vector<std::vector<FaceMotion>>& motions, const Weights& w)
{
    std::vector<FaceMotion> blended(motions[0].size());
    for (std::size_t i = 0; i < blended.size(); ++i) {
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();
        blended[i].stretch.setZero();
        for (std::size_t k = 0; k < motions.size(); ++k) {
            turn += w[Eigen::Index(k)] * rotation_vector(motions[k][i].rotation);
            blended[i].stretch += w[Eigen::Index(k)] * motions[k][i].stretch;
        }
        blended[i].rotation = rotation_by(turn);
    }
    return blended;
}

Shape put_together(const NormalizedPoses& set, const CellFit& fit, const Weights& w, const std::vector<FaceMotion>& motions)
{
    const Shape start = linear_blend(set, w);
    Eigen::Matrix3Xd changes(3, 2 * Eigen::Index(motions.size()));
    for (std::size_t i = 0; i < motions.size(); ++i) {
        const auto before = edges_of(set.shapes[0], set.triangles[i]);
        changes.middleCols<2>(2 * Eigen::Index(i))
            = motions[i].rotation * motions[i].stretch * before - edges_of(start, set.triangles[i]);
    }
    return fit(start, changes);
}

} // namespace pliant
