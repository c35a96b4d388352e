// ARAP cells of surfaces that are no manifold, and their rotations.
#include "base/mesh/align.h"
#include "base/mesh/fans.h"
#include "elastic/energy/arap.h"
#include "elastic/energy/best_rotation.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// A fan of `count` triangles around vertex 0, bent into a cone of this height; closed or not.
PoseSet cone(std::uint32_t count, bool is_closed, double height)
{
    PoseSet poses;
    Positions points(count + 1, 3);
    points.row(0) << 0, 0, height;
    const double turn = 6.283185307179586 / (is_closed ? count : count + 1);
    for (std::uint32_t i = 0; i < count; ++i) points.row(1 + i) << std::cos(turn * i), std::sin(turn * i), 0;
    for (std::uint32_t i = 0; i + 1 < count; ++i) poses.triangles.push_back({ 0, 1 + i, 2 + i });
    if (is_closed) poses.triangles.push_back({ 0, count, 1 });
    poses.positions = { points };
    return poses;
}

// Three triangles at the edge 0 1.
PoseSet book_of_three(double opening)
{
    PoseSet poses;
    Positions points(5, 3);
    points << 0, 0, 0, 0, 0, 1, 1, 0, 0.5, std::cos(opening), std::sin(opening), 0.5, std::cos(2 * opening),
        std::sin(2 * opening), 0.5;
    poses.triangles = { { 0, 1, 2 }, { 0, 1, 3 }, { 0, 1, 4 } };
    poses.positions = { points };
    return poses;
}

std::size_t fans_around(const std::vector<Fan>& fans, std::uint32_t vertex)
{
    return std::size_t(std::count_if(fans.begin(), fans.end(), [&](const Fan& fan) { return fan.centre == vertex; }));
}

} // namespace

TEST_CASE("one fan around a vertex of a manifold, two at a bow-tie, one more for each pair of faces at a crowded edge")
{
    const PoseSet closed = cone(6, true, 0.3), open = cone(6, false, 0.3);
    const std::vector<Fan> ring = find_fans(closed.triangles, normalize(closed).shapes[0]);
    REQUIRE(fans_around(ring, 0) == 1);
    CHECK(ring[0].is_closed);
    CHECK(ring[0].face_count() == 6);
    const std::vector<Fan> chain = find_fans(open.triangles, normalize(open).shapes[0]);
    CHECK_FALSE(chain[0].is_closed);
    CHECK(chain[0].ring == std::vector<std::uint32_t> { 1, 2, 3, 4, 5, 6 });

    PoseSet tie = cone(6, false, 0.3);
    tie.triangles.erase(tie.triangles.begin() + 2); // two chains of two faces are left
    CHECK(fans_around(find_fans(tie.triangles, normalize(tie).shapes[0]), 0) == 2);

    const PoseSet book = book_of_three(1.5);
    const std::vector<Fan> pages = find_fans(book.triangles, normalize(book).shapes[0]);
    CHECK(fans_around(pages, 0) == 6); // every page, and every pair that follow each other
    CHECK(fans_around(pages, 2) == 1);
}

TEST_CASE("a fan of turned faces is one fan all the same")
{
    PoseSet poses = cone(6, true, 0.3);
    std::swap(poses.triangles[2][1], poses.triangles[2][2]);
    const std::vector<Fan> fans = find_fans(poses.triangles, normalize(poses).shapes[0]);
    REQUIRE(fans_around(fans, 0) == 1);
    CHECK(fans[0].face_count() == 6);
}

TEST_CASE("large fans come in pieces that share a face")
{
    for (const bool is_closed : { false, true }) {
        const PoseSet poses = cone(100, is_closed, 0.3);
        std::vector<int> covered(poses.triangles.size(), 0);
        for (const Fan& fan : find_fans(poses.triangles, normalize(poses).shapes[0])) {
            CHECK(fan.ring.size() <= ring_limit);
            if (fan.centre != 0) continue;
            CHECK_FALSE(fan.is_closed);
            for (std::size_t i = 0; i + 1 < fan.ring.size(); ++i) ++covered[fan.ring[i] - 1];
        }
        CHECK(*std::min_element(covered.begin(), covered.end()) == 1);
        CHECK(*std::max_element(covered.begin(), covered.end()) == 2);
    }
}

TEST_CASE("faces at a crowded edge do not turn about it for nothing")
{
    const PoseSet poses = book_of_three(1.5);
    const NormalizedPoses set = normalize(poses);
    const Arap energy(set);
    Shape turned = set.shapes[0];
    const Eigen::Vector3d axis = (point(turned, 1) - point(turned, 0)).normalized();
    const Eigen::Vector3d arm = point(turned, 4) - point(turned, 0);
    turned.segment<3>(12) = point(turned, 0) + Eigen::AngleAxisd(0.5, axis) * arm;
    CHECK(energy_value(energy, corner_weights(1, 0), set.shapes[0]) < 1e-25);
    CHECK(energy_value(energy, corner_weights(1, 0), turned) > 1e-3);
}

TEST_CASE("the best rotation is that of the singular value decomposition")
{
    std::srand(3);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const Eigen::Matrix3d u = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
        const Eigen::Matrix3d v = Eigen::Quaterniond::UnitRandom().toRotationMatrix();
        const double flat[] = { 1, 1e-3, 1e-8, 0, -1e-3, -0.5 };
        const double second = 0.01 + 0.9 * std::abs(Eigen::internal::random<double>());
        const Eigen::Vector3d s(1, second, flat[i % 6] * second);
        const Eigen::Matrix3d m = std::pow(10.0, i % 9 - 4) * u * s.asDiagonal() * v.transpose();
        worst = std::max(worst, (best_rotation(m) - u * v.transpose()).norm() * (s[1] + s[2]));
    }
    CHECK(worst < 1e-13);
    CHECK((best_rotation(Eigen::Matrix3d::Zero()).determinant()) == doctest::Approx(1));
    const Eigen::Matrix3d line = Eigen::Vector3d(1, 2, 3) * Eigen::RowVector3d(3, -1, 2); // any turn about it will do
    const Eigen::Matrix3d rotation = best_rotation(line);
    CHECK(rotation.determinant() == doctest::Approx(1));
    CHECK((rotation.transpose() * line).trace() == doctest::Approx(line.norm()));
}
