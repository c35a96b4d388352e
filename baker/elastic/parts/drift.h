// How far the parts of a shape are from where their ties should hold them.
#pragma once

#include "elastic/parts/tie_set.h"

namespace pliant {

// The tied vertices of a part in a shape, a column each.
struct PartPlaces {
    std::size_t part, first; // its ties: first, first + 1, ...
    Eigen::Matrix3Xd actual, expected,
        target; // where they are, where their anchors would have them, and where they are target to
    double drift(std::size_t i) const { return (actual.col(Eigen::Index(i)) - expected.col(Eigen::Index(i))).norm(); }
};

// Wanted is each part's cloud of tied vertices at the mean of its places in the poses, weighted like these, where a part that rotations between
// poses rotations in step about the point of it that moves least, and does not shrink. (Ties pull to the plain mean.) Parts with seams are there
// twice.
std::vector<PartPlaces> place_parts(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y);

// How far the tied vertices of a shape are from where they are expected.
struct TieDrift {
    double largest = 0; // over the ties, in units of the diagonal
    std::size_t part = 0;
    std::uint32_t vertex = 0;
};

TieDrift measure_drift(const TieSet& ties, const ShapeSet& set, const Eigen::VectorXd& weights, const Shape& y);

} // namespace pliant
