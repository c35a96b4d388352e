// Rotation-strain coordinates: they give the shape back, half of them bends half as far, and nothing misleads the count of
// turns.
#include "../tube.h"
#include "../twisted_bar.h"
#include "base/mesh/align.h"
#include "elastic/average/rotation_strain.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// Straight, and bent by these angles.
NormalizedPoses bent_tubes(const std::vector<double>& bends)
{
    PoseSet poses = tube_poses(1 + bends.size());
    for (std::size_t k = 0; k < bends.size(); ++k) poses.positions[k + 1] = Tube().pose(bends[k], 0);
    return normalize(poses);
}

Eigen::VectorXd rotation_lengths(const Eigen::VectorXd& coordinates, std::size_t cell_count)
{
    return Eigen::Map<const Eigen::MatrixXd>(coordinates.data(), 6, Eigen::Index(cell_count)).topRows(3).colwise().norm();
}

} // namespace

TEST_CASE("coordinates of a shape give the shape")
{
    const NormalizedPoses tube = bent_tubes({ 3 }), bar = normalize(twisted_bar(2, 8, 2));
    for (const NormalizedPoses* set : { &tube, &bar }) {
        CAPTURE(set->is_solid());
        const RotationStrain coordinates(*set, set->shapes[0]);
        const CellFit fit(*set, default_solver());
        for (const Shape& shape : set->shapes)
            CHECK(relative_distance(*set, coordinates.shape(coordinates.coordinates(shape), fit), shape) < 1e-6);
        CHECK(coordinates.coordinates(set->shapes[0]).head(6).norm() < 1e-9); // the base itself
    }
}

TEST_CASE("half of the coordinates bend half as far, also beyond a full turn")
{
    const NormalizedPoses set = bent_tubes({ 7, 3.5 });
    const RotationStrain coordinates(set, set.shapes[0]);
    const Eigen::VectorXd straight = coordinates.coordinates(set.shapes[0]), bent = coordinates.coordinates(set.shapes[1]);
    CHECK(rotation_lengths(bent, set.triangles.size()).maxCoeff()
          > 3.3); // the ends turn by 3.5 to the one side and the other
    const Shape half = coordinates.shape((straight + bent) / 2, CellFit(set, default_solver()));
    CHECK(relative_distance(set, half, set.shapes[2]) < 0.01);
    CHECK(relative_distance(set, (set.shapes[0] + set.shapes[1]) / 2, set.shapes[2]) > 0.3);
}

TEST_CASE("cells that are turned over mislead no other")
{
    const NormalizedPoses set = bent_tubes({ 7 });
    const RotationStrain coordinates(set, set.shapes[0]);
    const auto is_pushed = [](std::uint32_t v) { return v < 240 && v % 10 % 5 == 2 && v / 10 % 3 == 1; };
    Shape pushed = set.shapes[1];
    for (std::uint32_t v = 0; v < 240; ++v) // beyond the next vertex of the ring
        if (is_pushed(v)) pushed.segment<3>(3 * v) += 1.9 * (point(set.shapes[1], v + 1) - point(set.shapes[1], v));
    const Eigen::VectorXd sound = coordinates.coordinates(set.shapes[1]), after = coordinates.coordinates(pushed);
    double most = 0, most_pushed = 0;
    for (std::size_t i = 0; i < set.triangles.size(); ++i) {
        const Triangle& t = set.triangles[i];
        double& largest = std::any_of(t.begin(), t.end(), is_pushed) ? most_pushed : most;
        largest = std::max(largest, (after - sound).segment<3>(6 * Eigen::Index(i)).norm());
    }
    CHECK(most_pushed > 2.5);
    CHECK(most < 1e-9);
}

TEST_CASE("derivatives are what coordinates change by")
{
    const NormalizedPoses tube = bent_tubes({ 3 }), bar = normalize(twisted_bar(2, 8, 2));
    for (const NormalizedPoses* set : { &tube, &bar }) {
        CAPTURE(set->is_solid());
        const RotationStrain coordinates(*set, set->shapes[0]);
        const Eigen::MatrixXd move = set->shapes[1] - set->shapes[0];
        const Shape y = set->shapes[0] + 0.05 * move.col(0);
        const Eigen::VectorXd at = coordinates.coordinates(y), slope = coordinates.derivatives(y, at, move).col(0);
        const double step = 1e-4;
        const Eigen::VectorXd change
            = coordinates.coordinates(y + step * move.col(0)) - coordinates.coordinates(y - step * move.col(0));
        CHECK((change / (2 * step) - slope).norm() < 1e-5 * slope.norm());
    }
}

TEST_CASE("parts that touch in one vertex are not torn apart")
{
    // A second tube, mirrored at the end of the first one, shares the vertex in the middle of its lid.
    PoseSet poses = tube_poses(2);
    const std::uint32_t count = std::uint32_t(poses.positions[0].rows()), shared = count - 1;
    const auto second = [&](std::uint32_t v) { return v == shared ? shared : count + v; };
    for (const Triangle& t : Tube().triangles()) poses.triangles.push_back({ second(t[0]), second(t[2]), second(t[1]) });
    for (Positions& positions : poses.positions) {
        const Positions first = positions;
        positions.resize(2 * count - 1, 3);
        positions.topRows(count) = first;
        for (std::uint32_t v = 0; v + 1 < count; ++v) positions.row(count + v) = 2 * first.row(shared) - first.row(v);
    }
    const NormalizedPoses set = normalize(poses);
    const RotationStrain coordinates(set, set.shapes[0]);
    const Shape back = coordinates.shape(coordinates.coordinates(set.shapes[1]), CellFit(set, default_solver()));
    CHECK(relative_distance(set, back, set.shapes[1]) < 1e-6);
}
