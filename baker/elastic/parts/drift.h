// Drift: the distance of tied vertices from where they should be.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// The tied vertices of a part in a shape, 3 x ties, in normalized lengths. Column i is of tie first_tie + i.
struct PartPlaces {
    std::size_t part, first_tie;
    Eigen::Matrix3Xd actual;   // their positions
    Eigen::Matrix3Xd expected; // where they should be, see place_parts
    double radius;             // of `expected` about its centroid; 0 unless the part is rigid and turns visibly
    Eigen::Matrix3Xd target;   // where the energy of the ties pulls them: the plain mean of their places in the poses

    double drift(std::size_t i) const { return (actual.col(Eigen::Index(i)) - expected.col(Eigen::Index(i))).norm(); }
};

// The anchors of `y` transform the places of every pose into space: one point cloud per pose. Expected is the mean of the
// clouds with these weights. Unlike in the plain mean, a part that rotates between poses does not shrink there, and it
// rotates about its pivot in proportion to the weights. Returns one entry per group of consecutive ties of a part, so that
// a part with seams has two.
std::vector<PartPlaces> place_parts(const TieSet& ties, const Eigen::VectorXd& weights, const Shape& y);

// The tied vertex that is farthest from its expected position.
struct TieDrift {
    double largest = 0; // in units of the diagonal
    std::size_t part = 0;
    std::uint32_t vertex = 0;
};
TieDrift measure_drift(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& y);

// The same of rigid parts that turn, such as eyes and wheels, each in units of the radius of its tied vertices about their
// centroid: what is nothing beside the diagonal may be a visible turn of a small part.
TieDrift measure_turn_drift(const TieSet& ties, const Eigen::VectorXd& weights, const Shape& y);

// The goal for every part of a character: drifts above are seen. Of a part that turns it is a turn by a tenth of a radian.
constexpr double drift_limit = 0.005, turn_drift_limit = 0.1;

// The largest drift of a part of `blend` over its limit. Blends follow the averages: parts count as 0 where they drift about
// as far in `average`, or so far that its place says nothing, as where turns of layers to both sides meet.
double avoidable_drift(const TieSet& ties, const NormalizedPoses& set, const Eigen::VectorXd& weights, const Shape& average,
                       const Shape& blend);

} // namespace pliant
