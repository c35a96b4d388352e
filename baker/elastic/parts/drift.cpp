#include "elastic/parts/drift.h"

#include "elastic/parts/rotations.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

namespace {

// Positions of a tied vertex as its place in every pose gives them (3 x m) with the anchors of y.
Eigen::Matrix3Xd posed_positions(const Tie& tie, const Shape& y)
{
    const auto& v = tie.vertices;
    const Eigen::Matrix3d vectors = tie_vectors(tie, point(y, v[0]), point(y, v[1]), point(y, v[2]), point(y, v[3]));
    Eigen::Matrix3d frame; // rows e1, e2, n
    frame << vectors.col(1).transpose(), vectors.col(2).transpose(), vectors.col(1).cross(vectors.col(2)).transpose();
    return (frame.inverse() * tie.rest).colwise() + point(y, v[1]);
}

// The weighted mean of point clouds (3 x n each) that keeps its size where they are rotated against each other: the mean of
// their shapes after each is rotated onto the plain mean. Rigid clouds are then rotated by the mean of their rotations, so
// that they do not leave the plane of their motion. The pivot of the result is at the weighted mean of the clouds' pivots.
Eigen::Matrix3Xd mean_cloud(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::VectorXd& shares, bool is_rigid)
{
    const Eigen::Index count = clouds[0].cols();
    Eigen::Matrix3Xd plain = Eigen::Matrix3Xd::Zero(3, count);
    for (std::size_t k = 0; k < clouds.size(); ++k) plain += shares[Eigen::Index(k)] * clouds[k];
    if (count < 3) return plain;            // too few points to define a rotation
    std::vector<Eigen::Matrix3d> rotations; // from the plain mean to each cloud
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
    const Eigen::Matrix3d rotation = is_rigid ? nearest_rotation(mean_rotation) : Eigen::Matrix3d::Identity();
    return (rotation * (mean.colwise() - pivot)).colwise() + place;
}

// The ties first ... last - 1.
PartPlaces place_part(const TieSet& ties, std::size_t first, std::size_t last, const Eigen::VectorXd& shares, const Shape& y)
{
    const Eigen::Index count = Eigen::Index(last - first);
    PartPlaces out = { ties.ties[first].part, first, Eigen::Matrix3Xd(3, count), {}, Eigen::Matrix3Xd(3, count) };
    std::vector<Eigen::Matrix3Xd> clouds(std::size_t(shares.size()), Eigen::Matrix3Xd(3, count));
    for (Eigen::Index i = 0; i < count; ++i) {
        const Tie& tie = ties.ties[first + std::size_t(i)];
        const Eigen::Matrix3Xd positions = posed_positions(tie, y);
        for (std::size_t k = 0; k < clouds.size(); ++k) clouds[k].col(i) = positions.col(Eigen::Index(k));
        out.actual.col(i) = point(y, tie.vertices[0]);
        out.target.col(i) = positions * shares;
    }
    out.expected = mean_cloud(clouds, shares, joint_of(ties, first) != nullptr);
    return out;
}

} // namespace

std::vector<PartPlaces> place_parts(const TieSet& ties, const Eigen::VectorXd& weights, const Shape& y)
{
    std::vector<PartPlaces> out;
    if (ties.ties.empty()) return out;
    const Weights shares = linear_shares(weights, std::size_t(posed_positions(ties.ties[0], y).cols()));
    for (std::size_t first = 0, last = 0; first < ties.ties.size(); first = last) {
        last = end_of_part(ties, first);
        out.push_back(place_part(ties, first, last, shares, y));
    }
    return out;
}

TieDrift measure_drift(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& y)
{
    TieDrift out;
    for (const PartPlaces& places : place_parts(ties, weights, y))
        for (std::size_t i = 0; i < std::size_t(places.actual.cols()); ++i) {
            const double drift = places.drift(i) / set.diagonal;
            if (!(drift <= out.largest)) out = { drift, places.part, ties.ties[places.first_tie + i].vertices[0] };
        }
    return out;
}

TieDrift measure_joint_drift(const TieSet& ties, const Eigen::VectorXd& weights, const Shape& y)
{
    TieDrift out;
    for (const PartPlaces& places : place_parts(ties, weights, y)) {
        const Joint* joint = joint_of(ties, places.first_tie);
        if (!joint || !joint->is_used) continue;
        const Eigen::Vector3d centre = places.expected.rowwise().mean();
        const double radius = (places.expected.colwise() - centre).colwise().norm().maxCoeff();
        for (std::size_t i = 0; i < std::size_t(places.actual.cols()); ++i) {
            const double drift = places.drift(i) / radius;
            if (!(drift <= out.largest)) out = { drift, places.part, ties.ties[places.first_tie + i].vertices[0] };
        }
    }
    return out;
}

double drift_over_limit(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& y)
{
    return std::max(measure_drift(ties, set, weights, y).largest / drift_limit,
                    measure_joint_drift(ties, weights, y).largest / joint_drift_limit);
}

} // namespace pliant
