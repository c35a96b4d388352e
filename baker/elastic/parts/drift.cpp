#include "elastic/parts/drift.h"

#include "elastic/parts/rotations.h"

#include <Eigen/Dense>

namespace pliant {

namespace {

// Where the anchors of a tie, as they are in y, would have the tied vertex: in pose k (columns of the first), and where it is.
struct Places {
    Eigen::Matrix3Xd expected;
    Eigen::Vector3d actual;
};

Places places_of(const Tie& tie, const Shape& y)
{
    const auto& v = tie.vertices;
    const Eigen::Matrix3d vectors = tie_vectors(tie, point(y, v[0]), point(y, v[1]), point(y, v[2]), point(y, v[3]));
    Eigen::Matrix3d frame; // rows e1, e2, n
    frame << vectors.col(1).transpose(), vectors.col(2).transpose(), vectors.col(1).cross(vectors.col(2)).transpose();
    return { (frame.inverse() * tie.rest).colwise() + point(y, v[1]), point(y, v[0]) };
}

// The weighted mean of clouds of points (3 x count each) that does not shrink where they are turned against each other: of their shapes, as
// the plain mean is turned, or, of rigid ones, in the mean of their rotations; it lies where the weighted mean of its pivot point does.
Eigen::Matrix3Xd mean_cloud(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::VectorXd& weights, bool is_rigid)
{
    const Eigen::Index count = clouds[0].cols();
    const Eigen::VectorXd shares = weights / weights.sum();
    Eigen::Matrix3Xd plain = Eigen::Matrix3Xd::Zero(3, count);
    for (std::size_t k = 0; k < clouds.size(); ++k) plain += shares[Eigen::Index(k)] * clouds[k];
    if (count < 3) return plain;            // nothing that could be seen to turn
    std::vector<Eigen::Matrix3d> rotations; // from the mean shape
    Eigen::Matrix3d mean_rotation = Eigen::Matrix3d::Zero();
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, count), centres(3, Eigen::Index(clouds.size()));
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const double share = shares[Eigen::Index(k)];
        rotations.push_back(best_rotation(plain, clouds[k]));
        centres.col(Eigen::Index(k)) = clouds[k].rowwise().mean();
        mean += share * (rotations[k].transpose() * (clouds[k].colwise() - centres.col(Eigen::Index(k))));
        mean_rotation += share * rotations[k];
    }
    const Eigen::Vector3d pivot = pivot_point(rotations, centres, mean.colwise().norm().maxCoeff());
    Eigen::Vector3d place = centres * shares;
    for (std::size_t k = 0; k < clouds.size(); ++k) place += shares[Eigen::Index(k)] * (rotations[k] * pivot);
    const Eigen::Matrix3d turn = is_rigid ? nearest_rotation(mean_rotation) : Eigen::Matrix3d::Identity();
    return (turn * (mean.colwise() - pivot)).colwise() + place;
}

} // namespace

std::vector<PartPlaces> place_parts(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y)
{
    std::vector<PartPlaces> out;
    for (std::size_t first = 0, last = 0; first < ties.ties.size(); first = last) {
        last = end_of_part(ties, first);
        const Eigen::Index count = Eigen::Index(last - first);
        PartPlaces places = { ties.ties[first].part, first, Eigen::Matrix3Xd(3, count), {}, Eigen::Matrix3Xd(3, count) };
        std::vector<Eigen::Matrix3Xd> clouds(set.pose_count(), Eigen::Matrix3Xd(3, count));
        for (Eigen::Index i = 0; i < count; ++i) {
            const Places one = places_of(ties.ties[first + std::size_t(i)], y);
            for (std::size_t k = 0; k < clouds.size(); ++k) clouds[k].col(i) = one.expected.col(Eigen::Index(k));
            places.actual.col(i) = one.actual;
            places.target.col(i) = one.expected * weights / weights.sum();
        }
        places.expected = mean_cloud(clouds, weights, joint_of(ties, first) != nullptr);
        out.push_back(std::move(places));
    }
    return out;
}

TieDrift measure_drift(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y)
{
    TieDrift out;
    for (const PartPlaces& places : place_parts(ties, set, weights, y))
        for (std::size_t i = 0; i < std::size_t(places.actual.cols()); ++i) {
            const double drift = places.drift(i) / set.diagonal;
            if (!(drift <= out.largest)) out = { drift, places.part, ties.ties[places.first + i].vertices[0] };
        }
    return out;
}

} // namespace pliant
