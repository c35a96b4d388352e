// The parts of `pliant export` by themselves: GLB bytes, fitted normals, paths, warnings, skins. Whole exports:
// tests/baker/output/engines.
#include "output/export/export_asset.h"
#include "output/export/export_primitives.h"
#include "output/export/glb.h"
#include "output/export/grid_mesh.h"
#include "output/export/skinning.h"
#include "reduced/surrogate/training.h"

#include <Eigen/Geometry>
#include <chrono>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace pliant;

namespace {

std::uint32_t word_at(const std::string& bytes, std::size_t at)
{
    std::uint32_t word;
    std::memcpy(&word, bytes.data() + at, sizeof word);
    return word;
}

std::vector<int> numbers_of(const std::vector<Diagnostic>& diagnostics)
{
    std::vector<int> numbers;
    for (const Diagnostic& diagnostic : diagnostics) numbers.push_back(diagnostic.number);
    return numbers;
}

// A rod along x whose parts turn about z, three bones with smooth weights between them.
struct Rod {
    Skin skin;
    std::vector<BonePose> poses;
    std::vector<Eigen::Matrix3Xd> shapes;

    explicit Rod(int shape_count)
    {
        const int n = 240;
        skin.bone_count = 3;
        skin.rest.resize(3, n);
        skin.influences.resize(std::size_t(n));
        Random random(3);
        for (int v = 0; v < n; ++v) {
            skin.rest.col(v) << 3.0 * v / n, 0.3 * random.normal(), 0.3 * random.normal();
            const double at = 3.0 * v / n - 0.5, share = std::min(1.0, std::max(0.0, (at - std::floor(at)) * 2 - 0.5));
            const int left = std::max(0, int(std::floor(at))), right = std::min(2, left + 1);
            skin.influences[std::size_t(v)].bones = { std::uint16_t(left), std::uint16_t(right), 0, 0 };
            skin.influences[std::size_t(v)].weights = { 1 - share, share, 0, 0 };
        }
        for (int s = 0; s < shape_count; ++s) {
            BonePose pose(3);
            Eigen::Affine3d whole = Eigen::Affine3d::Identity();
            for (int b = 0; b < 3; ++b) {
                whole = whole * Eigen::Translation3d(b, 0, 0)
                    * Eigen::AngleAxisd(0.5 * random.normal(), Eigen::Vector3d(0, 0.4, 1).normalized())
                    * Eigen::Translation3d(-b, 0, 0);
                pose[std::size_t(b)] = { whole.linear(), whole.translation() };
            }
            poses.push_back(pose);
            shapes.push_back(skin.shape(pose));
        }
    }
};

// Accessor i as something that names it.
GltfValue reference_to(const GltfDocument& document, std::size_t i)
{
    static const GltfJson numbers = { 0, 1, 2 };
    return { document.path(), numbers[i] };
}

// In order and turned alike, from whichever corner on.
bool has_same_triangles(const std::vector<std::uint32_t>& a, std::vector<std::uint32_t> b)
{
    for (std::size_t i = 0; i + 2 < b.size(); i += 3)
        for (int turn = 0; turn < 2 && !std::equal(b.begin() + int(i), b.begin() + int(i) + 3, a.begin() + int(i)); ++turn)
            std::rotate(b.begin() + int(i), b.begin() + int(i) + 1, b.begin() + int(i) + 3);
    return a == b;
}

double distance(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) { return (a - b).colwise().norm().maxCoeff(); }

} // namespace

TEST_CASE("images that the asset has are not written once more, and are found in a time linear in its bytes")
{
    Glb glb("one, two");
    const auto place_of = [&](std::string_view image) {
        return glb.json()["bufferViews"][glb.add_shared_view(image)]["byteOffset"].get<std::size_t>();
    };
    CHECK(place_of("one") == 0);
    CHECK(place_of("two") == 5);
    CHECK(place_of("one") >= 8);      // it is not behind the last one
    const std::size_t half = 1 << 21; // bytes that all but match everywhere: 1e12 comparisons for whoever makes them all
    Glb hostile(std::string(half, 'A'));
    const auto begin = std::chrono::steady_clock::now();
    hostile.add_shared_view(std::string(half / 2, 'A') + 'B');
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 5);
}

TEST_CASE("materials keep their extensions, and objects of many members take time linear in them")
{
    RenderScene scene;
    scene.materials = R"({"extensionsUsed":["A_materials_b","KHR_texture_basisu"],)"
                      R"("extensionsRequired":["KHR_texture_basisu"],"materials":[{"extras":{)";
    for (int i = 0; i < 300000; ++i) scene.materials += fmt::format("\"{}\":0,", i);
    scene.materials += R"("last":0}}]})";
    Glb glb;
    const auto begin = std::chrono::steady_clock::now();
    add_materials(glb, scene);
    const std::string bytes = glb.bytes();
    CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 20);
    CHECK(bytes.find(R"("extensionsUsed":["A_materials_b","KHR_texture_basisu"])") < bytes.size());
    CHECK(bytes.find(R"("extensionsRequired":["KHR_texture_basisu"])") < bytes.size());
    CHECK(bytes.find(R"("299999":0)") < bytes.size());
}

TEST_CASE("a GLB is laid out as the format wants, an asset in front on a page")
{
    Glb glb("0123456789");
    CHECK(glb.add_floats({ 1, 2, 3, -4, 5, 6 }, 3, Glb::Target::vertices, true) == 0);
    CHECK(glb.add_indices({ 0, 1, 1 }, 2) == 1);
    CHECK(glb.json()["bufferViews"][0]["byteLength"] == 10);
    CHECK(glb.json()["bufferViews"][1]["byteOffset"] == 12);
    CHECK(glb.json()["accessors"][0]["min"] == std::vector<float> { -4, 2, 3 });
    CHECK(glb.json()["accessors"][0]["max"] == std::vector<float> { 1, 5, 6 });
    CHECK(glb.json()["accessors"][1]["componentType"] == 5123);
    CHECK(glb.add_indices({ 0, 70000, 1 }, 70001) == 2);
    CHECK(glb.json()["accessors"][2]["componentType"] == 5125);
    const std::string bytes = glb.bytes();
    CHECK(bytes.substr(0, 4) == "glTF");
    CHECK(word_at(bytes, 8) == bytes.size());
    CHECK(20 + word_at(bytes, 12) + 8 == 4096);
    CHECK(bytes.substr(4096, 10) == "0123456789");
    CHECK(word_at(bytes, 4096 - 8) == bytes.size() - 4096);
    CHECK(bytes.size() % 4 == 0);
}

TEST_CASE("integers of a GLB start at multiples of 4, and compressed views come out of meshoptimizer as they went in")
{
    const std::vector<std::int16_t> rows = { 1, -2, 300, 4, 5, -32767 }, small = { 1, -2, 127, -127, 0, 3 };
    const std::vector<std::uint32_t> corners = { 0, 1, 2, 2, 1, 3, 4, 5, 4 };
    for (const bool is_packed : { false, true }) {
        CAPTURE(is_packed);
        Glb glb({}, is_packed);
        glb.add_integers(rows, 3, gltf_int16, false, true);
        glb.add_integers(small, 3, gltf_int8, true, false);
        glb.add_indices(corners, 6);
        CHECK(glb.json()["bufferViews"][0]["byteStride"] == 8);
        CHECK(glb.json()["bufferViews"][1]["byteLength"] == 8);
        CHECK(glb.json()["accessors"][0]["max"] == std::vector<int> { 4, 5, 300 });
        CHECK(glb.json()["accessors"][1]["normalized"] == true);
        const GltfDocument document("a.glb", glb.bytes());
        const GltfNumbers read = read_numbers(document, reference_to(document, 0), { 3 });
        for (int i = 0; i < 6; ++i) CHECK(read(i / 3, i % 3) == rows[std::size_t(i)]);
        CHECK(read_numbers(document, reference_to(document, 1), { 3 })(1, 0) == -1);
        CHECK(has_same_triangles(read_indices(document, reference_to(document, 2), 1), corners));
    }
}

TEST_CASE("rounding together keeps sums nearer than rounding each number")
{
    Random random(17);
    const int n = 300, d = 12, samples = 400;
    Eigen::MatrixXf weights(d, samples);
    for (int s = 0; s < samples; ++s) { // two parameters decide
        const double a = random.uniform(), b = random.uniform();
        for (int j = 0; j < d; ++j) weights(j, s) = float(0.5 + 0.4 * std::sin(a * (1 + 0.1 * j) + b + j));
    }
    Eigen::MatrixXd x(n, d + 1);
    for (double& value : x.reshaped()) value = 200 * random.normal();
    const GridRounding rounding(weights);
    const auto error
        = [&](const Eigen::MatrixXd& whole) { return ((x - whole) * with_one(weights)).norm() / std::sqrt(n * samples); };
    const auto rounded = [&](int limit) { return rounding.round(x, x.col(d), limit); };
    const double together = error(rounded(32767).cast<double>()), each = error(x.array().round());
    CHECK(together < 0.3); // one rounded number: 0.29
    CHECK(each > 2 * together);
    CHECK(rounded(127).cwiseAbs().maxCoeff() == 127);
}

TEST_CASE("without targets every vertex is as near as asked")
{
    Random random(23);
    Eigen::VectorXd positions(600);
    for (double& value : positions) value = 5 + random.normal();
    const Eigen::VectorXd exact = positions;
    const Grid grid = grid_for(positions, 1e-4);
    CHECK(round_to(grid, positions) < 1e-4);
    for (int i = 0; i < 600; ++i) CHECK(std::abs(grid.origin[i % 3] + grid.step * positions[i] - exact[i]) < 3e-3);
    CHECK(positions.cwiseAbs().maxCoeff() <= 32767);
}

TEST_CASE("P5201: what 32 bits cannot count is refused")
{
    check_glb_size(0xFFFFFFFFull);
    try {
        check_glb_size(0x100000000ull);
        FAIL("accepted");
    } catch (const Failure& failure) {
        CHECK(failure.diagnostics()[0].number == 5201);
    }
}

TEST_CASE("warnings about what some engine may not do: P5202, P5205, P5208")
{
    ExportReport report;
    report.has_stored_ranges = true;
    report.target_count = 64;
    CHECK(warnings_about(report).empty());
    report.target_count = 65;
    CHECK(numbers_of(warnings_about(report)) == std::vector<int> { 5202 });
    report.has_stored_ranges = false;
    CHECK(numbers_of(warnings_about(report)) == std::vector<int> { 5202, 5205 });
    report.table_largest = 0.009;
    CHECK(warnings_about(report).size() == 2);
    report.table_largest = 0.011;
    CHECK(numbers_of(warnings_about(report)) == std::vector<int> { 5202, 5205, 5208 });
    report.target_count = 0; // without morph targets nothing of it matters
    CHECK(warnings_about(report).empty());
}

TEST_CASE("the path passes all poses and the mean, and every row sums to 1")
{
    const auto path = default_path(WeightDomain::simplex(3), 6, 30);
    REQUIRE(path.size() == 181);
    CHECK(path[0] == std::vector<float> { 1, 0, 0 });
    CHECK(path[45] == std::vector<float> { 0, 1, 0 });
    CHECK(path[90] == std::vector<float> { 0, 0, 1 });
    CHECK(path[135][0] == doctest::Approx(1.0 / 3));
    CHECK(path[180] == path[0]);
    for (const auto& row : path) CHECK(row[0] + row[1] + row[2] == doctest::Approx(1));
}

TEST_CASE("the path of layers passes the rest shape, each layer at its full strength, and all or the first of them together")
{
    const auto path = default_path(WeightDomain::box({ { 0, 1 }, { -2, 0.5 } }), 6, 1);
    REQUIRE(path.size() == 7);
    CHECK(path[0] == std::vector<float> { 0, 0 });
    CHECK(path[1] == std::vector<float> { 1, 0 });
    CHECK(path[2] == path[0]);
    CHECK(path[3] == std::vector<float> { 0, -2 });
    CHECK(path[5] == std::vector<float> { 1, -2 });
    CHECK(path[6] == path[0]);
    const auto many = default_path(WeightDomain::box(std::vector<WeightRange>(20)), 42, 1);
    REQUIRE(many.size() == 43);
    CHECK(Eigen::Map<const Eigen::VectorXf>(many[41].data(), 20).sum() == sparse_limit);
}

TEST_CASE("normals that are linear up to length are found, also where the base would vanish")
{
    Random random(5);
    const int n = 40, d = 3;
    Eigen::VectorXd base(3 * n);
    Eigen::MatrixXd deltas(3 * n, d);
    for (Eigen::Index i = 0; i < base.size(); ++i) {
        base[i] = random.normal();
        for (int j = 0; j < d; ++j) deltas(i, j) = 0.1 * random.normal();
    }
    base.head<3>().setZero(); // its normals are as small as its deltas: the direction at w = 0 is undefined
    NormalFit fit(n, d);
    NormalErrorMeter meter;
    const auto normals_at = [&](const Eigen::VectorXd& w) { return Eigen::VectorXd(base + deltas * w); };
    for (int s = 0; s < 60; ++s) {
        const Eigen::VectorXd w = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
        fit.add(w, normals_at(w));
    }
    const NormalFit::Result result = fit.solve();
    for (int v = 0; v < n; ++v) CHECK(result.base.segment<3>(3 * v).norm() == doctest::Approx(1));
    for (int s = 0; s < 20; ++s) {
        const Eigen::VectorXd w = Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform());
        Eigen::VectorXd others = normals_at(w);
        others.head<3>().setZero(); // "no normal": not judged
        meter.add(result, w, others);
    }
    CHECK(meter.error().worst_degrees < 1e-2);
    CHECK(meter.error().mean_degrees <= meter.error().worst_degrees);
}

TEST_CASE("a skin that made the shapes is found again, and its bones in a shape not seen")
{
    const Rod rod(24);
    const std::vector<Eigen::Matrix3Xd> seen(rod.shapes.begin(), rod.shapes.begin() + 20);
    const SkinFit fit = fit_skin(rod.skin.rest, seen, 3);
    REQUIRE(fit.skin.bone_count == 3);
    for (std::size_t s = 0; s < seen.size(); ++s) CHECK(distance(fit.skin.shape(fit.poses[s]), seen[s]) < 0.03);
    for (std::size_t s = 20; s < 24; ++s)
        CHECK(distance(fit.skin.shape(fit_bones(fit.skin, rod.shapes[s], fit.poses[0])), rod.shapes[s]) < 0.06);
    for (const Influences& influence : fit.skin.influences) {
        double sum = 0;
        for (double w : influence.weights) {
            CHECK(w >= 0);
            sum += w;
        }
        CHECK(sum == doctest::Approx(1));
    }
    // One rigid bone cannot do it.
    const SkinFit stiff = fit_skin(rod.skin.rest, seen, 1);
    CHECK(distance(stiff.skin.shape(stiff.poses[0]), seen[0]) > 0.1);
}
