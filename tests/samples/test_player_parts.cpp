// The parts of the player that need no OpenGL: weight paths, unreduced averages, distances, playback, places of a crowd.
#include "blend/alignment.h"
#include "blend/crowd.h"
#include "blend/error.h"
#include "blend/frame_times.h"
#include "blend/heat.h"
#include "blend/layer_walk.h"
#include "blend/playback.h"
#include "blend/truth.h"
#include "blend/weight_path.h"
#include "draw/image_writer.h"

#include <doctest/doctest.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <unistd.h>

using namespace pliant::player;

namespace {

// A file that exists as long as the object.
class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& bytes)
        : path_((std::filesystem::temp_directory_path() / ("pliant_player_parts" + std::to_string(getpid()))).string())
    {
        std::ofstream(path_, std::ios::binary) << bytes;
    }
    ~TemporaryFile() { std::filesystem::remove(path_); }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

template <typename Call> int number_of_error(const Call& call, std::string* what = nullptr)
{
    try {
        call();
    } catch (const Error& error) {
        if (what) *what = error.what();
        return static_cast<int>(error.number);
    }
    return 0;
}

int path_error(const std::string& text, std::string* what = nullptr)
{
    const TemporaryFile file(text);
    return number_of_error([&] { WeightPath(file.path(), 3); }, what);
}

template <typename T> void append(std::string& bytes, T value)
{
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
}

// As the tool writes it: three vertices, one triangle.
std::string ply(const std::string& vertex_count = "3", float x = 0.5f)
{
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + vertex_count
        + "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int "
          "vertex_indices\nend_header\n";
    for (float number : { x, 1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f, 7.0f, 8.0f }) append(bytes, number);
    bytes += '\3';
    for (int index : { 0, 1, 2 }) append(bytes, index);
    return bytes;
}

int ply_error(const std::string& bytes)
{
    const TemporaryFile file(bytes);
    return number_of_error([&] { read_ply_positions(file.path()); });
}

} // namespace

TEST_CASE("paths of weights are read as the tool reads them")
{
    const TemporaryFile file("# a comment\n1, 1,2\r\n\n0,0,3\n1e300,1e300,0");
    const WeightPath path(file.path(), 3);
    REQUIRE(path.count() == 3);
    CHECK(path.row(0) == std::vector<double> { 0.25, 0.25, 0.5 });
    CHECK(path.row(1) == std::vector<double> { 0.0, 0.0, 1.0 });
    CHECK(path.row(2) == std::vector<double> { 0.5, 0.5, 0.0 });
}

TEST_CASE("a damaged path is refused with the line's number")
{
    std::string what;
    for (const char* row :
         { "1,1", "1,1,1,1", "1,x,1", "1,,1", "1,1,1,", "-1,1,1", "0,0,0", "nan,1,1", "inf,1,1", "1;1;1" }) {
        CAPTURE(row);
        CHECK(path_error(std::string("1,1,1\n# here it comes\n") + row + "\n", &what) == 5913);
        CHECK_MESSAGE(what.find(":3: ") != std::string::npos, what);
    }
    CHECK(path_error("") == 5913);
    CHECK(path_error("# nothing\n\n") == 5913);
    CHECK(number_of_error([] { WeightPath("/no/such/file.csv", 3); }) == 5913);
    CHECK(number_of_error([] { WeightPath("/tmp", 3); }) == 5913);
}

TEST_CASE("a path is a loop, mixed between its rows")
{
    const WeightPath path({ { 1.0, 0.0 }, { 0.5, 0.5 }, { 0.0, 1.0 } });
    CHECK(path.at(0.0) == path.row(0));
    CHECK(path.at(2.0) == path.row(2));
    CHECK(path.at(3.0) == path.row(0));
    CHECK(path.at(-1.0) == path.row(2));
    CHECK(path.at(0.5) == std::vector<double> { 0.75, 0.25 });
    CHECK(path.at(2.25) == std::vector<double> { 0.25, 0.75 });
}

TEST_CASE("rows of layers are any finite numbers, kept as they are")
{
    const TemporaryFile file("0,0\n-3,1.5\n");
    const WeightPath path(file.path(), 2, true);
    CHECK(path.row(0) == std::vector<double> { 0.0, 0.0 });
    CHECK(path.row(1) == std::vector<double> { -3.0, 1.5 });
    for (const char* row : { "1", "1,2,3", "1,nan", "1,1e39" }) {
        const TemporaryFile wrong(row);
        CHECK_MESSAGE(number_of_error([&] { WeightPath(wrong.path(), 2, true); }) == 5913, row);
    }
}

TEST_CASE("the walk through layers is closed, eased, and inside the ranges")
{
    const std::vector<WeightRange> layers { { "a", 0.0, 1.0, 0.0 }, { "b", -1.0, 2.0, 0.5 }, { "c", 0.0, 1.0, 1.0 } };
    const WeightPath walk = layer_walk(layers);
    CHECK(walk.row(0) == std::vector<double> { 0.0, 0.5, 1.0 });
    std::vector<double> lowest { 9.0, 9.0, 9.0 }, highest { -9.0, -9.0, -9.0 };
    for (std::size_t i = 0; i < walk.count(); ++i) {
        const std::vector<double>& next = walk.row((i + 1) % walk.count());
        for (std::size_t k = 0; k < 3; ++k) {
            lowest[k] = std::min(lowest[k], walk.row(i)[k]);
            highest[k] = std::max(highest[k], walk.row(i)[k]);
            CHECK(std::abs(next[k] - walk.row(i)[k]) < 0.07 * (layers[k].high - layers[k].low)); // 1.5 / 24 at most
        }
    }
    CHECK(lowest == std::vector<double> { 0.0, -1.0, 0.0 });
    CHECK(highest == std::vector<double> { 1.0, 2.0, 1.0 });
    for (const std::vector<double>& weights : layer_mixtures(layers)) {
        const int active = (weights[0] != 0.0) + (weights[1] != 0.5) + (weights[2] != 1.0);
        CHECK(active >= 2);
    }
}

TEST_CASE("numbered names follow the rule of the tool")
{
    CHECK(numbered_name("--sequence", "f_%04d.png", 7) == "f_0007.png");
    CHECK(numbered_name("--sequence", "f_%d.png", 123) == "f_123.png");
    CHECK(numbered_name("--sequence", "%3d", 5) == "  5");
    CHECK(numbered_name("--sequence", "%04d", 123456) == "123456");
    CHECK(numbered_name("--sequence", "%099999d", 1).size() == 20);
    for (const char* pattern : { "frame.png", "%s.png", "%d_%d.png", "%", "%04", "%%d", "%-4d" }) {
        CAPTURE(pattern);
        CHECK(number_of_error([&] { numbered_name("--sequence", pattern, 0); }) == 5941);
    }
}

TEST_CASE("meshes of the tool are read")
{
    const TemporaryFile file(ply());
    const std::vector<glm::vec3> positions = read_ply_positions(file.path());
    REQUIRE(positions.size() == 3);
    CHECK(positions[0] == glm::vec3(0.5f, 1.0f, 2.0f));
    CHECK(positions[2] == glm::vec3(6.0f, 7.0f, 8.0f));
}

TEST_CASE("every damage of a mesh is refused")
{
    const std::string good = ply();
    CHECK(ply_error(good) == 0);
    for (std::size_t length = 0; length < good.size(); ++length) {
        CAPTURE(length);
        CHECK(ply_error(good.substr(0, length)) == 5914);
    }
    CHECK(ply_error(good + "x") == 5914);
    for (const std::string count : { "2", "4", "9999999999", "99999999999999999999", "-3", "", "3 3", "0x3" }) {
        CAPTURE(count);
        CHECK(ply_error(ply(count)) == 5914);
    }
    CHECK(ply_error(ply("3", std::numeric_limits<float>::quiet_NaN())) == 5914);
    CHECK(ply_error(ply("3", std::numeric_limits<float>::infinity())) == 5914);
    std::string ascii = good, doubles = good, corners = good;
    CHECK(ply_error(ascii.replace(4, 34, "format ascii 1.0")) == 5914);
    CHECK(ply_error(doubles.replace(doubles.find("float x"), 5, "double")) == 5914);
    corners[corners.size() - 13] = '\377'; // a face of 255 corners
    CHECK(ply_error(corners) == 5914);
    CHECK(number_of_error([] { read_ply_positions("/no/such.ply"); }) == 5914);
    CHECK(number_of_error([] { read_ply_positions("/tmp"); }) == 5914);
}

TEST_CASE("distances on the scale")
{
    CHECK(heat_of_share(0.0f) == 0.0f);
    CHECK(heat_of_share(lowest_heat) == 0.0f);
    CHECK(heat_of_share(highest_heat) == doctest::Approx(1.0f));
    CHECK(heat_of_share(1.0f) == 1.0f);
    CHECK(heat_of_share(1e-3f) == doctest::Approx(1.0f / 3.0f)); // a decade of three
    CHECK(heat_of_share(std::numeric_limits<float>::quiet_NaN()) == 0.0f);

    const std::vector<glm::vec3> a { { 0, 0, 0 }, { 3, 4, 0 }, { 9, 9, 9 } }, b { { 1, 1, 1 }, { 1, 1, 7 }, { 0, 0, 0 } };
    CHECK(diagonal_of(a, 2) == doctest::Approx(5.0f));
    std::vector<float> heat { 7.0f, 7.0f, 7.0f };
    const HeatSummary summary = measure_heat(a, b, 2, 5.0f, heat); // two points at distance 5 on two at distance 6
    CHECK(summary.largest == doctest::Approx(0.1f));
    CHECK(summary.mean == doctest::Approx(0.1f));
    CHECK(heat[1] == doctest::Approx(1.0f));
    CHECK(heat[2] == 0.0f); // not counted
}

TEST_CASE("rigid motions are found again, and never mirror")
{
    std::vector<glm::vec3> from, onto, mirrored;
    const glm::dquat turn = glm::angleAxis(2.5, glm::normalize(glm::dvec3(1.0, -2.0, 0.5)));
    for (int i = 0; i < 40; ++i) {
        const glm::dvec3 x(std::sin(1.0 + i), std::cos(3.0 * i), 0.3 * std::sin(7.0 * i));
        from.emplace_back(x);
        onto.emplace_back(turn * x + glm::dvec3(5.0, 6.0, 7.0));
        mirrored.emplace_back(-x.x, x.y, x.z);
    }
    const RigidMotion motion = best_motion(from, onto, from.size());
    for (std::size_t i = 0; i < from.size(); ++i) CHECK(glm::distance(motion(from[i]), glm::dvec3(onto[i])) < 1e-6);
    CHECK(glm::determinant(best_motion(from, mirrored, from.size()).rotation) == doctest::Approx(1.0));
    CHECK(glm::length(best_motion(from, from, 1)(from[0]) - glm::dvec3(from[0]))
          < 1e-6); // a single point has no orientation
    CHECK(best_motion({}, {}, 0)(glm::dvec3(1.0)) == glm::dvec3(1.0));
}

TEST_CASE("the path plays, pauses, and gives way to the point")
{
    const ControlPolygon polygon(3);
    const WeightPath path({ { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } });
    Playback playback(polygon, { 1.0, 0.0, 0.0 }, true, path, 2.0);
    CHECK(playback.plays());
    CHECK(playback.weights() == path.row(0));
    playback.advance(0.5);
    CHECK(playback.weights() == path.row(1));
    REQUIRE(playback.path_frame());
    CHECK(*playback.path_frame() == doctest::Approx(1.0));
    playback.advance(0.75);
    CHECK(*playback.path_frame() == doctest::Approx(0.5));
    playback.toggle_play();
    CHECK_FALSE(playback.plays());
    playback.advance(10.0);
    CHECK(playback.weights() == path.at(0.5));

    playback.drag_to({ 0.0, 0.0 });
    CHECK_FALSE(playback.plays());
    CHECK_FALSE(playback.path_frame());
    for (double weight : playback.weights()) CHECK(weight == doctest::Approx(1.0 / 3.0));
    playback.toggle_play();
    CHECK(playback.plays());
    CHECK(playback.weights() == path.at(0.5)); // continues where it was
}

TEST_CASE("given weights stay until the point moves")
{
    const ControlPolygon polygon(4);
    const std::vector<double> given { 0.5, 0.0, 0.5, 0.0 }; // not the weights of the centre, where its point is
    Playback playback(polygon, given, false, std::nullopt, 30.0);
    playback.advance(1.0);
    CHECK(playback.weights() == given);
    CHECK(glm::length(playback.point()) < 1e-12);
    playback.go_to(1);
    playback.advance(60.0);
    CHECK(playback.weights()[1] == 1.0);

    Playback idle(polygon, given, true, std::nullopt, 30.0);
    CHECK(idle.plays());
    idle.toggle_play();
    CHECK_FALSE(idle.plays());
}

TEST_CASE("weights that are given stop the path")
{
    const ControlPolygon polygon(3);
    const WeightPath path({ { 0.0, 1.0 }, { 1.0, 0.0 } });
    Playback playback(polygon, { 0.0, 0.0 }, true, path, 1.0);
    playback.advance(0.25);
    playback.show({ 0.25, -2.0 });
    CHECK_FALSE(playback.plays());
    playback.advance(1.0);
    CHECK(playback.weights() == std::vector<double> { 0.25, -2.0 });
    playback.toggle_play();
    CHECK(playback.weights() == path.at(0.25));

    const Playback given(polygon, { 0.0, 3.0 }, false, path, 1.0);
    CHECK(given.weights() == std::vector<double> { 0.0, 3.0 });
}

TEST_CASE("the other shares make room in their proportions")
{
    std::vector<double> shares { 0.2, 0.6, 0.2, 0.0 };
    set_share(shares, 0, 0.6);
    for (std::size_t k = 0; k < 4; ++k) CHECK(shares[k] == doctest::Approx(std::vector<double> { 0.6, 0.3, 0.1, 0.0 }[k]));
    set_share(shares, 1, 7.0);
    CHECK(shares == std::vector<double> { 0.0, 1.0, 0.0, 0.0 });
    set_share(shares, 1, 0.7); // the proportions are gone
    for (std::size_t k = 0; k < 4; ++k) CHECK(shares[k] == doctest::Approx(k == 1 ? 0.7 : 0.1));
    set_share(shares, 2, -1.0);
    CHECK(shares[2] == 0.0);
    CHECK(shares[0] + shares[1] + shares[3] == doctest::Approx(1.0));
}

TEST_CASE("a name that is not taken")
{
    const TemporaryFile one("x");
    const std::string& stem = one.path();
    CHECK(unused_path(stem, ".png") == stem + "_001.png");
    std::ofstream(stem + "_001.png") << "x";
    std::filesystem::create_symlink("/nowhere", stem + "_002.png");
    CHECK(unused_path(stem, ".png") == stem + "_003.png");
    CHECK(unused_path(stem, "") == stem + "_001");
    for (const char* end : { "_001.png", "_002.png" }) std::filesystem::remove(stem + end);
}

TEST_CASE("frame times: medians of the last 120")
{
    FrameTimes times;
    CHECK(times.median().sum() == 0.0);
    for (int i = 0; i < 1000; ++i) times.add({ 100.0, 100.0, 100.0 });
    for (int i = 0; i < 119; ++i) times.add({ 1.0, 2.0, i % 2 == 0 ? 3.0 : 4.0 });
    times.add({ 9.0, 9.0, 9.0 });
    CHECK(times.count() == 120);
    CHECK(times.frame(0).solve == 9.0);
    CHECK(times.frame(119).solve == 1.0);
    CHECK(times.median().solve == 1.0);
    CHECK(times.median().reconstruct == 2.0);
    CHECK(times.longest() == 27.0);
    for (auto [longest, end] : { std::pair<double, double> { 0.0, 1.0 },
                                 { 0.7, 1.0 },
                                 { 1.0, 1.0 },
                                 { 1.2, 2.0 },
                                 { 33.0, 50.0 },
                                 { 51.0, 100.0 } }) {
        CHECK(axis_end(longest) == doctest::Approx(end));
    }
}

TEST_CASE("a crowd stands apart, around the middle, inside its extent")
{
    const Extent one { { -1, 0, -2 }, { 1, 3, 2 }, { { -1, 0, 0 }, { 1, 3, 0 }, { 0, 1, -2 }, { 0, 1, 2 } } };
    for (std::uint32_t count : { 1u, 2u, 7u, 100u }) {
        CAPTURE(count);
        const std::vector<glm::vec3> places = crowd_places(count, { 2.0f, 4.0f });
        REQUIRE(places.size() == count);
        glm::vec3 middle(0.0f);
        const Extent all = extent_of_crowd(one, places);
        for (std::size_t i = 0; i < count; ++i) {
            middle += places[i];
            CHECK(places[i].y == 0.0f);
            for (std::size_t j = 0; j < i; ++j) {
                const glm::vec3 apart = glm::abs(places[i] - places[j]);
                CHECK((apart.x > 1.99f || apart.z > 3.99f));
            }
            CHECK(glm::all(glm::lessThanEqual(all.lowest, one.lowest + places[i] + 1e-4f)));
            CHECK(glm::all(glm::greaterThanEqual(all.highest, one.highest + places[i] - 1e-4f)));
        }
        CHECK(glm::length(middle) < 1e-3f * static_cast<float>(count));
        CHECK(all.outline.size() == 4 * one.outline.size());
    }
}

TEST_CASE("characters of a crowd differ, the first one from none, and stay in their extent")
{
    CHECK(crowd_variation(0) == 0.0f);
    const Extent one { { -1, 0, -2 }, { 1, 3, 2 }, { { -1, 0, 0 }, { 1, 3, 0 }, { 1, 1, -2 }, { -1, 1, -2 }, { 1, 1, 2 } } };
    const Extent all = extent_with_turns(one);
    for (std::uint32_t i = 0; i < 100; ++i) {
        CHECK(std::abs(crowd_variation(i)) <= 1.0f);
        CHECK(std::abs(crowd_variation(i) - crowd_variation(i + 1)) > 0.3f);
        const glm::mat3 turn(glm::rotate(glm::mat4(1.0f), crowd_variation(i) * largest_crowd_turn, { 0.0f, 1.0f, 0.0f }));
        for (const glm::vec3& point : one.outline) {
            const glm::vec3 turned = turn * point; // the centre of the extent is on the axis
            CHECK(glm::all(glm::lessThanEqual(all.lowest, turned + 1e-5f)));
            CHECK(glm::all(glm::greaterThanEqual(all.highest, turned - 1e-5f)));
        }
    }
}

TEST_CASE("characters of a crowd are elsewhere on one loop")
{
    const ControlPolygon polygon(3);
    const auto now = crowd_weights(5, 0.25, polygon, std::nullopt);
    REQUIRE(now.size() == 5);
    CHECK(now[0] == polygon.weights(polygon.idle_point(0.25)));
    CHECK(now[1] != now[0]);
    const WeightPath path({ { 1.0, 0.0, 0.0 }, { 0.0, 1.0, 0.0 } });
    CHECK(crowd_weights(1, 0.5, polygon, path)[0] == path.row(1));
    CHECK(loop_seconds(polygon, path, 4.0) == doctest::Approx(0.5));
}
