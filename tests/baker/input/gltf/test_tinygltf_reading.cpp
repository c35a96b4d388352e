// Our glTF reader against tinygltf, which shares no code with it but the JSON library and Draco's decoder: triangles, and
// the shape at rest and with each morph target, nodes and skins applied by a second, plain evaluator. Animations:
// test_gltf_reading.py.
#include "../../tinygltf_model.h"
#include "../io/files.h"
#include "glb_samples.h"
#include "input/poses/pose_source.h"
#include "skip.h"

#include <functional>

using namespace pliant;

namespace {

using pliant_test::Json;
using pliant_test::Numbers;
using pliant_test::numbers_of;

// Column after column, as glTF's.
using Matrix = std::array<double, 16>;

const Matrix identity = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

Matrix product(const Matrix& a, const Matrix& b)
{
    Matrix out {};
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 4; ++column)
            for (std::size_t k = 0; k < 4; ++k) out[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    return out;
}

// Adds to `out` a share of the point where the matrix takes `point`.
void add_moved(const Matrix& m, const double* point, double share, double* out)
{
    for (std::size_t c = 0; c < 3; ++c)
        out[c] += share * (m[c] * point[0] + m[4 + c] * point[1] + m[8 + c] * point[2] + m[12 + c]);
}

bool is_mirroring(const Matrix& m)
{
    return m[0] * (m[5] * m[10] - m[9] * m[6]) - m[4] * (m[1] * m[10] - m[9] * m[2]) + m[8] * (m[1] * m[6] - m[5] * m[2])
        < 0;
}

Matrix rotation_matrix(const std::vector<double>& quaternion)
{
    const double x = quaternion.at(0), y = quaternion.at(1), z = quaternion.at(2), w = quaternion.at(3),
                 s = 2 / (x * x + y * y + z * z + w * w);
    // clang-format off
    return { 1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w), 0,
             s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w), 0,
             s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y), 0,
             0, 0, 0, 1 };
    // clang-format on
}

Matrix local_matrix(const tinygltf::Node& node)
{
    Matrix local = identity;
    if (!node.matrix.empty()) {
        std::copy_n(node.matrix.begin(), 16, local.begin());
        return local;
    }
    if (!node.rotation.empty()) local = rotation_matrix(node.rotation);
    for (std::size_t i = 0; i < 12 && !node.scale.empty(); ++i) local[i] *= node.scale.at(i / 4);
    for (std::size_t c = 0; c < 3 && !node.translation.empty(); ++c) local[12 + c] = node.translation.at(c);
    return local;
}

// What the default scene of a model draws, in the order of the nodes' numbers.
class Shown {
public:
    explicit Shown(const tinygltf::Model& model)
        : model_(model)
        , world_(model.nodes.size(), identity)
        , is_shown_(model.nodes.size(), false)
    {
        const tinygltf::Scene& scene = model.scenes.at(std::size_t(std::max(model.defaultScene, 0)));
        for (const int root : scene.nodes) place(root, identity);
    }

    // Of all vertices. `target`: the morph target at weight 1; "": none.
    std::vector<double> positions(const std::string& target) const
    {
        std::vector<double> all;
        for_each_primitive([&](const tinygltf::Primitive& primitive, std::size_t node) {
            const std::vector<double> moved = moved_by_node(primitive, node, morphed(primitive, node, target));
            all.insert(all.end(), moved.begin(), moved.end());
        });
        return all;
    }

    // As our reader numbers them: triangles of a mirrored node are turned round.
    std::vector<std::uint32_t> corners() const
    {
        std::vector<std::uint32_t> all;
        std::uint32_t first = 0;
        for_each_primitive([&](const tinygltf::Primitive& primitive, std::size_t node) {
            std::vector<std::uint32_t> own = pliant_test::corners_of(model_, primitive);
            const bool is_mirrored = model_.nodes[node].skin < 0 && is_mirroring(world_[node]);
            for (std::size_t i = 0; is_mirrored && i < own.size(); i += 3) std::swap(own[i + 1], own[i + 2]);
            for (const std::uint32_t corner : own) all.push_back(first + corner);
            first += std::uint32_t(model_.accessors[std::size_t(primitive.attributes.at("POSITION"))].count);
        });
        return all;
    }

private:
    void place(int number, const Matrix& parent)
    {
        const tinygltf::Node& node = model_.nodes.at(std::size_t(number));
        world_[std::size_t(number)] = product(parent, local_matrix(node));
        is_shown_[std::size_t(number)] = true;
        for (const int child : node.children) place(child, world_[std::size_t(number)]);
    }

    void for_each_primitive(const std::function<void(const tinygltf::Primitive&, std::size_t)>& use) const
    {
        for (std::size_t i = 0; i < model_.nodes.size(); ++i)
            if (is_shown_[i] && model_.nodes[i].mesh >= 0)
                for (const auto& primitive : model_.meshes.at(std::size_t(model_.nodes[i].mesh)).primitives)
                    use(primitive, i);
    }

    std::string target_name(std::size_t node, std::size_t number) const
    {
        const tinygltf::Value& extras = model_.meshes[std::size_t(model_.nodes[node].mesh)].extras;
        return extras.Has("targetNames") ? extras.Get("targetNames").Get(number).Get<std::string>()
                                         : "target_" + std::to_string(number + 1);
    }

    std::vector<double> morphed(const tinygltf::Primitive& primitive, std::size_t node, const std::string& target) const
    {
        std::vector<double> positions = numbers_of(model_, primitive.attributes.at("POSITION")).values;
        for (std::size_t k = 0; k < primitive.targets.size(); ++k) {
            if (target_name(node, k) != target) continue;
            const std::vector<double> deltas = numbers_of(model_, primitive.targets[k].at("POSITION")).values;
            REQUIRE(deltas.size() == positions.size());
            for (std::size_t i = 0; i < deltas.size(); ++i) positions[i] += deltas[i];
        }
        return positions;
    }

    std::vector<double> moved_by_node(const tinygltf::Primitive& primitive, std::size_t node,
                                      const std::vector<double>& positions) const
    {
        if (model_.nodes[node].skin >= 0) return skinned(primitive, std::size_t(model_.nodes[node].skin), positions);
        std::vector<double> moved(positions.size());
        for (std::size_t i = 0; i < moved.size(); i += 3) add_moved(world_[node], &positions[i], 1, &moved[i]);
        return moved;
    }

    std::vector<Matrix> joint_matrices(std::size_t skin_number) const
    {
        const tinygltf::Skin& skin = model_.skins.at(skin_number);
        const Numbers inverse = numbers_of(model_, skin.inverseBindMatrices);
        std::vector<Matrix> matrices;
        for (std::size_t j = 0; j < skin.joints.size(); ++j) {
            Matrix bind;
            for (std::size_t i = 0; i < 16; ++i) bind[i] = inverse.values.at(16 * j + i);
            matrices.push_back(product(world_.at(std::size_t(skin.joints[j])), bind));
        }
        return matrices;
    }

    std::vector<double> skinned(const tinygltf::Primitive& primitive, std::size_t skin,
                                const std::vector<double>& positions) const
    {
        const std::vector<Matrix> matrices = joint_matrices(skin);
        const Numbers joints = numbers_of(model_, primitive.attributes.at("JOINTS_0")),
                      weights = numbers_of(model_, primitive.attributes.at("WEIGHTS_0"));
        REQUIRE(3 * joints.count() == positions.size());
        std::vector<double> moved(positions.size());
        for (std::size_t v = 0; v < joints.count(); ++v) {
            const double* shares = &weights.values.at(4 * v);
            const double sum = std::accumulate(shares, shares + 4, 0.0);
            for (std::size_t i = 0; i < 4; ++i)
                add_moved(matrices.at(std::size_t(joints.values.at(4 * v + i))), &positions[3 * v], shares[i] / sum,
                          &moved[3 * v]);
        }
        return moved;
    }

    const tinygltf::Model& model_;
    std::vector<Matrix> world_;
    std::vector<bool> is_shown_;
};

// The largest difference of a coordinate over the diagonal of the bounding box.
double relative_difference(const Positions& ours, const std::vector<double>& theirs)
{
    const std::array<double, 3> sides = pliant_test::sides_of(theirs);
    const std::vector<double> numbers(ours.data(), ours.data() + ours.size()); // row after row
    return pliant_test::difference(numbers, theirs) / std::hypot(sides[0], sides[1], sides[2]);
}

// The numbers of both are doubles of the same bytes; only sums differ in their order.
constexpr double rounding = 1e-12;

void compare(const std::string& path, std::size_t target_count)
{
    CAPTURE(path);
    DiagnosticList diagnostics;
    const std::vector<MeshFile> poses = read_pose_sources({ path, path + "#rest" }, Blend::layers, diagnostics).meshes;
    const tinygltf::Model model = pliant_test::load_file(path);
    const Shown shown(model);
    REQUIRE(poses.size() == target_count + 2);
    CHECK(poses[0].faces.indices == shown.corners());
    for (std::size_t k = 0; k < poses.size(); ++k) {
        CAPTURE(poses[k].name);
        const bool is_target = k > 0 && k <= target_count;
        CHECK(relative_difference(poses[k].positions, shown.positions(is_target ? poses[k].name : "")) < rounding);
    }
}

struct GlbParts {
    Json json;
    std::string bytes;
};

GlbParts split(const std::string& glb)
{
    std::uint32_t size;
    std::memcpy(&size, glb.data() + 12, sizeof size);
    return { Json::parse(glb.substr(20, size)), glb.substr(28 + size) };
}

} // namespace

TEST_CASE("poses by tinygltf: a skin, a morph target of sparse numbers, as .glb and as .gltf with its buffer beside it")
{
    const pliant_test::TemporaryFolder folder;
    pliant_test::write_bytes(folder / "a.glb", pliant_test::moving_glb());
    compare(folder / "a.glb", 1);
    GlbParts parts = split(pliant_test::moving_glb());
    parts.json["buffers"][0]["uri"] = "a.bin";
    pliant_test::write_bytes(folder / "a.bin", parts.bytes);
    pliant_test::write_bytes(folder / "a.gltf", parts.json.dump());
    compare(folder / "a.gltf", 1);
}

TEST_CASE("poses by tinygltf: nodes in nodes, one mesh at two of them, one mirrored")
{
    const pliant_test::TemporaryFolder folder;
    GlbParts parts = split(pliant_test::moving_glb());
    parts.json["nodes"] = Json::parse(R"([{"children":[1,2],"rotation":[0.6,0,0,0.8],"scale":[1,2,1]},
        {"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1]},{"mesh":0,"scale":[-2,1,1],"translation":[0,0,3]}])");
    for (const char* key : { "skins", "animations" }) parts.json.erase(key);
    pliant_test::GlbBuilder glb;
    glb.json = parts.json;
    glb.bytes = parts.bytes;
    pliant_test::write_bytes(folder / "a.glb", glb.glb());
    compare(folder / "a.glb", 1);
}

TEST_CASE("poses by tinygltf: Draco data")
{
    const pliant_test::TemporaryFolder folder;
    const std::size_t n = pliant_test::grid_positions().size() / 3;
    for (const int method : { draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING }) {
        CAPTURE(method);
        pliant_test::write_bytes(folder / "a.glb", pliant_test::draco_glb(pliant_test::encode_draco(method), n, n));
        compare(folder / "a.glb", 1);
    }
}

TEST_CASE("poses by tinygltf: real files")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    const std::pair<const char*, std::size_t> files[] = { { "gltf_morph/AnimatedMorphCube.glb", 2 },
                                                          { "gltf_morph/AnimatedMorphSphere.glb", 2 },
                                                          { "gltf_morph/MorphStressTest.gltf", 8 },
                                                          { "gltf_morph/RobotExpressive.glb", 3 },
                                                          { "gltf_skin/CesiumMan.glb", 0 },
                                                          { "gltf_skin/CesiumMan/CesiumMan.gltf", 0 },
                                                          { "gltf_skin/Fox.glb", 0 },
                                                          { "gltf_skin/Trex.glb", 0 },
                                                          { "gltf_skin/Wolf.glb", 0 },
                                                          { "gltf_draco/AnimatedMorphSphere_draco.glb", 2 },
                                                          { "gltf_draco/MorphStressTest_draco.glb", 8 },
                                                          { "gltf_draco/CesiumMan_draco.glb", 0 },
                                                          { "gltf_draco/Enemy_Small-transformed.glb", 0 },
                                                          { "gltf_draco/Mech_FinnTheFrog-transformed.glb", 0 } };
    for (const auto& [name, target_count] : files) compare(data + "/" + name, target_count);
}
