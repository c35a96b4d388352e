// Seams stay smooth, hard edges stay hard.
#include "base/mesh/smoothing_groups.h"

#include <algorithm>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>
#include <stdexcept>

using namespace pliant;
using Groups = std::vector<std::uint32_t>;

namespace {

Eigen::Vector3d tilted(double degrees)
{
    const double angle = degrees * 3.14159265358979323846 / 180;
    return { std::sin(angle), 0, std::cos(angle) };
}

} // namespace

TEST_CASE("without input normals all vertices of a place share theirs")
{
    CHECK(smoothing_groups({ 7, 3, 7, 7, 3, 9 }) == Groups { 0, 1, 0, 0, 1, 5 });
    CHECK(smoothing_groups({}).empty());
}

TEST_CASE("vertices of a place share a normal if their input normals do")
{
    // A texture seam (0, 2), a hard edge (1, 4), a corner of three hard faces with a seam in one (3, 5, 6, 7).
    const Groups welded { 0, 1, 0, 2, 1, 2, 2, 2 };
    const std::vector<Eigen::Vector3d> normals { tilted(0),  tilted(10), 2 * tilted(0.5), tilted(0),
                                                 tilted(80), tilted(90), tilted(180),     tilted(90.5) };
    CHECK(smoothing_groups(welded, normals) == Groups { 0, 1, 0, 3, 4, 5, 6, 5 });
}

TEST_CASE("the sides of a sheet do not share a normal, whatever the file says")
{
    const std::vector<Eigen::Vector3d> sides { tilted(0), tilted(180), 1e-9 * tilted(10), tilted(150), { 0, 0, 0 } };
    CHECK(smoothing_groups({ 0, 0, 0, 0, 0 }, {}, sides) == Groups { 0, 1, 0, 0, 0 });
    CHECK(smoothing_groups({ 0, 0 }, { tilted(0), tilted(0) }, { tilted(20), tilted(200) }) == Groups { 0, 1 });
    CHECK(smoothing_groups({ 0, 1 }, {}, { tilted(0), tilted(180) }) == Groups { 0, 1 });
    CHECK_THROWS_AS(smoothing_groups({ 0, 0 }, {}, { tilted(0) }), std::invalid_argument);
}

TEST_CASE("one degree is the limit")
{
    CHECK(smoothing_groups({ 0, 0 }, { tilted(30), tilted(30.99) }) == Groups { 0, 0 });
    CHECK(smoothing_groups({ 0, 0 }, { tilted(30), tilted(31.01) }) == Groups { 0, 1 });
    // Steps of less than a degree do not add up: each is compared with the first one of a group.
    CHECK(smoothing_groups({ 0, 0, 0 }, { tilted(0), tilted(0.9), tilted(1.8) }) == Groups { 0, 0, 2 });
}

TEST_CASE("a group has at most 256 vertices")
{
    const Groups groups = smoothing_groups(Groups(600, 7));
    CHECK(std::count(groups.begin(), groups.end(), 0) == 256);
    CHECK(std::count(groups.begin(), groups.end(), 256) == 256);
    CHECK(groups.back() == 512);
}

TEST_CASE("of many groups at one place the last 64 are looked at")
{
    std::vector<Eigen::Vector3d> normals;
    for (int i = 0; i < 65; ++i) normals.push_back(tilted(2 * i));
    for (int i = 0; i < 2; ++i) normals.push_back(tilted(2 * i)); // of the first group, and of the second
    const Groups groups = smoothing_groups(Groups(67, 0), normals);
    CHECK(groups[65] == 65);
    CHECK(groups[66] == 66);
    normals[66] = tilted(4);
    CHECK(smoothing_groups(Groups(67, 0), normals)[66] == 2);
}

TEST_CASE("a normal that says nothing joins")
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(smoothing_groups({ 0, 0 }, { tilted(0), Eigen::Vector3d::Zero() }) == Groups { 0, 0 });
    CHECK(smoothing_groups({ 0, 0 }, { tilted(0), Eigen::Vector3d(nan, 0, 1) }) == Groups { 0, 0 });
    CHECK_THROWS_AS(smoothing_groups({ 0, 0 }, { tilted(0) }), std::invalid_argument);
}

TEST_CASE("groups of one vertex each are trivial")
{
    CHECK(is_trivial({}));
    CHECK(is_trivial({ 0, 1, 2 }));
    CHECK_FALSE(is_trivial({ 0, 1, 1 }));
}
