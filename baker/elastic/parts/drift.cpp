#include "elastic/parts/drift.h"

#include "elastic/parts/joints.h"
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

// A cloud counts as rigid if it keeps its shape to this share of its radius in all poses: the anchors of a part that lies on
// a soft body do not agree on its shape.
constexpr double rigid_share = 0.5;

// Point clouds, one per pose, each rotated back onto their plain mean and taken about its centroid.
struct TurnedClouds {
    std::vector<Eigen::Matrix3Xd> shapes;
    std::vector<Eigen::Matrix3d> rotations; // from the plain mean to each cloud
    Eigen::Matrix3Xd centres;               // 3 x clouds

    TurnedClouds(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::Matrix3Xd& plain)
        : centres(3, Eigen::Index(clouds.size()))
    {
        for (std::size_t k = 0; k < clouds.size(); ++k) {
            rotations.push_back(best_rotation(plain, clouds[k]));
            centres.col(Eigen::Index(k)) = clouds[k].rowwise().mean();
            shapes.push_back(rotations[k].transpose() * (clouds[k].colwise() - centres.col(Eigen::Index(k))));
        }
    }

    bool are_rigid_and_turn(const Eigen::Matrix3Xd& mean, double radius) const
    {
        double error = 0;
        for (const Eigen::Matrix3Xd& shape : shapes) error = std::max(error, (shape - mean).colwise().norm().maxCoeff());
        return error < rigid_share * radius && largest_rotation(rotations) > min_rotation;
    }
};

// Sets `expected` to the weighted mean of the point clouds (3 x n each) that keeps its size where they are rotated against
// each other: the mean of their shapes after each is rotated onto the plain mean. Rigid clouds are then rotated by the mean
// of their rotations, so that they do not leave the plane of their motion. The pivot of the result is at the weighted mean
// of the clouds' pivots.
void expect_mean(const std::vector<Eigen::Matrix3Xd>& clouds, const Eigen::VectorXd& shares, bool is_rigid, PartPlaces& out)
{
    out.expected = Eigen::Matrix3Xd::Zero(3, clouds[0].cols());
    for (std::size_t k = 0; k < clouds.size(); ++k) out.expected += shares[Eigen::Index(k)] * clouds[k];
    if (clouds[0].cols() < 3) return; // too few points to define a rotation
    const TurnedClouds turned(clouds, out.expected);
    Eigen::Matrix3d mean_rotation = Eigen::Matrix3d::Zero();
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, clouds[0].cols());
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        mean += shares[Eigen::Index(k)] * turned.shapes[k];
        mean_rotation += shares[Eigen::Index(k)] * turned.rotations[k];
    }
    const double radius = mean.colwise().norm().maxCoeff();
    if (is_rigid || turned.are_rigid_and_turn(mean, radius)) out.radius = radius;
    const Eigen::Vector3d pivot = pivot_point(turned.rotations, turned.centres, radius);
    Eigen::Vector3d place = turned.centres * shares;
    for (std::size_t k = 0; k < clouds.size(); ++k) place += shares[Eigen::Index(k)] * (turned.rotations[k] * pivot);
    const Eigen::Matrix3d rotation = is_rigid ? nearest_rotation(mean_rotation) : Eigen::Matrix3d::Identity();
    out.expected = (rotation * (mean.colwise() - pivot)).colwise() + place;
}

// The ties first ... last - 1.
PartPlaces place_part(const TieSet& ties, std::size_t first, std::size_t last, const Eigen::VectorXd& shares, const Shape& y)
{
    const Eigen::Index count = Eigen::Index(last - first);
    PartPlaces out = { ties.ties[first].part, first, Eigen::Matrix3Xd(3, count), {}, 0, Eigen::Matrix3Xd(3, count) };
    std::vector<Eigen::Matrix3Xd> clouds(std::size_t(shares.size()), Eigen::Matrix3Xd(3, count));
    for (Eigen::Index i = 0; i < count; ++i) {
        const Tie& tie = ties.ties[first + std::size_t(i)];
        const Eigen::Matrix3Xd positions = posed_positions(tie, y);
        for (std::size_t k = 0; k < clouds.size(); ++k) clouds[k].col(i) = positions.col(Eigen::Index(k));
        out.actual.col(i) = point(y, tie.vertices[0]);
        out.target.col(i) = positions * shares;
    }
    expect_mean(clouds, shares, joint_of(ties, first) != nullptr, out);
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

namespace {

// `unit`: of the drift of a part; 0 for parts that are left out.
template <class Unit> TieDrift farthest(const TieSet& ties, const std::vector<PartPlaces>& parts, Unit unit)
{
    TieDrift out;
    for (const PartPlaces& places : parts) {
        for (std::size_t i = 0; unit(places) > 0 && i < std::size_t(places.actual.cols()); ++i) {
            const double drift = places.drift(i) / unit(places);
            if (!(drift <= out.largest)) out = { drift, places.part, ties.ties[places.first_tie + i].vertices[0] };
        }
    }
    return out;
}

} // namespace

TieDrift measure_drift(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& y)
{
    return farthest(ties, place_parts(ties, weights, y), [&](const PartPlaces&) { return set.diagonal; });
}

TieDrift measure_turn_drift(const TieSet& ties, const Eigen::VectorXd& weights, const Shape& y)
{
    return farthest(ties, place_parts(ties, weights, y), [](const PartPlaces& places) { return places.radius; });
}

namespace {

// A blend drifts as far as the average if it drifts by at most this much more.
constexpr double as_far = 1.1;

// Where an average drifts by this many limits, its part is adrift.
constexpr double adrift = 5;

// `radius`: of the part, or 0 if it does not turn.
double over_limit(const PartPlaces& places, double radius, double diagonal)
{
    const double unit = radius > 0 ? std::min(turn_drift_limit * radius, drift_limit * diagonal) : drift_limit * diagonal;
    return (places.actual - places.expected).colwise().norm().maxCoeff() / unit;
}

} // namespace

double avoidable_drift(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& average,
                       const Shape& blend)
{
    const std::vector<PartPlaces> blended = place_parts(ties, weights, blend),
                                  averaged = place_parts(ties, weights, average);
    double out = 0;
    for (std::size_t i = 0; i < blended.size(); ++i) {
        const double drift = over_limit(blended[i], blended[i].radius, set.diagonal);
        const double least = over_limit(averaged[i], blended[i].radius, set.diagonal);
        if (drift > as_far * least && least < adrift) out = std::max(out, drift);
    }
    return out;
}

} // namespace pliant
