// What `pliant export` writes, read by the loader that games link (tinygltf, MIT), and written again by it.
#define TINYGLTF_IMPLEMENTATION // with Draco, for all that is compiled with this file
#include "../tinygltf_model.h"
#undef TINYGLTF_IMPLEMENTATION

#include "../parts_mesh.h"

#include "bake/bake.h"
#include "input/gltf/render_scene.h"
#include "output/export/export_asset.h"
#include "pliant_format.h"

#include <algorithm>
#include <sstream>

using namespace pliant;
using pliant_test::corners_of;
using pliant_test::difference;
using pliant_test::load_glb;
using pliant_test::numbers_of;

namespace {

std::string save(const tinygltf::Model& model)
{
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    CHECK(writer.WriteGltfSceneToStream(&model, stream, false, true));
    return stream.str();
}

// A GLB in memory that is aligned as the runtime wants it.
class AlignedCopy {
public:
    explicit AlignedCopy(const char* bytes, std::size_t size)
        : words_(size / 8 + 3)
    {
        const auto address = reinterpret_cast<std::uintptr_t>(words_.data());
        begin_ = reinterpret_cast<char*>(words_.data() + (address % 16 ? 1 : 0));
        std::memcpy(begin_, bytes, size);
    }
    const char* data() const { return begin_; }

private:
    std::vector<std::uint64_t> words_;
    char* begin_;
};

std::vector<std::uint8_t> baked(const PoseSet& poses, const BakeOptions& options)
{
    Progress silent;
    return bake(poses, options, silent).bytes;
}

RuntimeBlender& tube()
{
    static RuntimeBlender blender(baked(tube_poses(3), BakeOptions()), "tube");
    return blender;
}

const std::string image_bytes("\x89PNG\0 as encoded", 16);

constexpr const char* materials = R"({"materials":[{"name":"cloth","alphaMode":"MASK","alphaCutoff":0.25,)"
                                  R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},{"name":"skin"}],)"
                                  R"("textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":33071}],)"
                                  R"("images":[{"mimeType":"image/png","name":"stripes"}]})";

// Two parts, each with a material and texture coordinates; the body has the first vertices and faces.
RenderScene scene_of(const PoseSet& all, const PoseSet& body)
{
    const auto vertices = std::uint32_t(body.vertex_count()), faces = std::uint32_t(body.triangles.size());
    RenderScene scene;
    scene.vertex_count = std::uint32_t(all.vertex_count());
    scene.triangles = all.triangles;
    const std::uint32_t others = scene.vertex_count - vertices, other_faces = std::uint32_t(all.triangles.size()) - faces;
    scene.parts.push_back({ "body", 1, 0, vertices, 0, faces, { "TEXCOORD_0" } });
    scene.parts.push_back({ "jacket", 0, vertices, others, faces, other_faces, { "TEXCOORD_0" } });
    scene.attributes = { { "TEXCOORD_0", 2, {} } };
    for (std::uint32_t i = 0; i < 2 * scene.vertex_count; ++i)
        scene.attributes[0].values.push_back(0.37f * float(i % 101) - 3);
    scene.materials = materials;
    scene.images = { image_bytes };
    return scene;
}

const PoseSet& painted_poses()
{
    static const PoseSet poses = [] {
        PartsMesh mesh;
        mesh.has_eye = mesh.has_vertex = false;
        mesh.body = { 12, 8 };
        PoseSet all = mesh.poses(3);
        all.repairs.component_count = 2;
        all.scene = std::make_shared<const RenderScene>(scene_of(all, tube_poses(3, mesh.body)));
        return all;
    }();
    return poses;
}

// The same asset, but that its last column moves nothing, as format 1.3 has columns that no blend needs.
std::vector<std::uint8_t> with_empty_column(std::vector<std::uint8_t> bytes)
{
    const RuntimeBlender whole(bytes, "whole");
    const pliant_asset& asset = whole.asset();
    std::size_t size = 0;
    const auto* basis = static_cast<const unsigned char*>(pliant_asset_chunk(&asset, PLIANT_CHUNK_FACTORED, &size));
    REQUIRE(basis);
    const auto place = std::size_t(basis - asset.blob) + sizeof(pliant_format_factored)
        + (asset.dimension - 1) * sizeof(pliant_format_column);
    std::fill_n(bytes.begin() + std::ptrdiff_t(place), sizeof(pliant_format_column), std::uint8_t(0));
    return bytes;
}

RuntimeBlender& painted()
{
    static RuntimeBlender blender = [] {
        BakeOptions options;
        options.subspace = SubspaceKind::krylov;
        options.element_count = 24; // these numbers make it quick
        options.check_count = options.fresh_count = 4;
        return RuntimeBlender(with_empty_column(baked(painted_poses(), options)), "painted");
    }();
    return blender;
}

// Whether some coordinate moves no vertex.
bool has_empty_column(const RuntimeBlender& blender)
{
    std::vector<float> q(blender.asset().dimension, 0.0f);
    const std::vector<float> at_zero = blender.positions(q);
    for (float& coordinate : q) {
        coordinate = 1;
        if (blender.positions(q) == at_zero) return true;
        coordinate = 0;
    }
    return false;
}

struct Kind {
    bool with_asset = false, with_morph_targets = false;
    int bone_count = 0;
    double quantisation_error = 0;
};

// All in floats.
constexpr Kind kinds[] = { { false, true, 0 }, { true, false, 0 }, { true, true, 0 }, { false, false, 4 } };

Kind in_integers(Kind kind)
{
    kind.quantisation_error = 1e-4;
    return kind;
}

tinygltf::Model exported_model(RuntimeBlender& blender, const Kind& kind)
{
    ExportOptions options;
    options.with_asset = kind.with_asset;
    options.with_morph_targets = kind.with_morph_targets;
    options.bone_count = kind.bone_count;
    options.quantisation_error = kind.quantisation_error;
    options.frames_per_second = 5;
    if (kind.bone_count) options.path = default_path(blender.domain(), 2, 5);
    return load_glb(export_asset(blender, options).bytes);
}

const tinygltf::Primitive& only_primitive(const tinygltf::Model& model)
{
    REQUIRE(model.meshes.size() == 1);
    REQUIRE(model.meshes[0].primitives.size() == 1);
    return model.meshes[0].primitives[0];
}

// Vertices of the asset; behind them may lie the corners of a box.
std::size_t own_count(const tinygltf::Model& model, const tinygltf::Primitive& primitive)
{
    if (primitive.extras.Has("pliant") && primitive.extras.Get("pliant").Has("vertex_count"))
        return std::size_t(primitive.extras.Get("pliant").Get("vertex_count").GetNumberAsInt());
    return model.accessors.at(std::size_t(primitive.attributes.at("POSITION"))).count;
}

// Positions of the mesh as its node places them, part after part, moved by weighted targets.
std::vector<double> placed_shape(const tinygltf::Model& model, const std::vector<float>& weights)
{
    const tinygltf::Node& node = model.nodes.at(0);
    std::vector<double> all;
    for (const tinygltf::Primitive& primitive : model.meshes.at(0).primitives) {
        REQUIRE(primitive.targets.size() == weights.size());
        std::vector<double> shape = numbers_of(model, primitive.attributes.at("POSITION")).values;
        for (std::size_t j = 0; j < weights.size(); ++j) {
            const std::vector<double> deltas = numbers_of(model, primitive.targets[j].at("POSITION")).values;
            for (std::size_t i = 0; i < shape.size(); ++i) shape[i] += double(weights[j]) * deltas.at(i);
        }
        shape.resize(3 * own_count(model, primitive));
        for (std::size_t i = 0; i < shape.size() && !node.scale.empty(); ++i)
            shape[i] = node.scale[i % 3] * shape[i] + node.translation.at(i % 3);
        all.insert(all.end(), shape.begin(), shape.end());
    }
    return all;
}

// The mesh at the coordinates q.
std::vector<double> morphed_shape(const tinygltf::Model& model, const pliant_asset& asset, const std::vector<float>& q)
{
    std::vector<float> weights(asset.dimension);
    REQUIRE(pliant_morph_weights(&asset, q.data(), weights.data()) == PLIANT_OK);
    return placed_shape(model, weights);
}

// Of the triangles between the asset's vertices.
std::size_t corner_count(const tinygltf::Model& model)
{
    std::size_t count = 0;
    for (const tinygltf::Primitive& primitive : model.meshes.at(0).primitives)
        for (const std::uint32_t corner : corners_of(model, primitive)) count += corner < own_count(model, primitive);
    return count;
}

// Engines that take the bounds of positions, or the vertices of triangles, find a box that holds the shape.
void check_box(const tinygltf::Model& model, const std::vector<double>& shape)
{
    const tinygltf::Node& node = model.nodes.at(0);
    for (const tinygltf::Primitive& primitive : model.meshes.at(0).primitives) {
        const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(primitive.attributes.at("POSITION")));
        CHECK(accessor.count == own_count(model, primitive) + 2);
        CHECK(corners_of(model, primitive).back() == own_count(model, primitive));
        for (std::size_t i = 0; i < shape.size(); ++i) {
            const double scale = node.scale.empty() ? 1 : node.scale[i % 3],
                         at = node.scale.empty() ? 0 : node.translation[i % 3];
            const bool is_inside
                = shape[i] >= scale * accessor.minValues[i % 3] + at && shape[i] <= scale * accessor.maxValues[i % 3] + at;
            REQUIRE(is_inside);
        }
    }
}

// The blends of the runtime and its triangles; `tolerance` of a coordinate.
void check_blends(RuntimeBlender& blender, const Kind& kind, double tolerance)
{
    const tinygltf::Model model = exported_model(blender, kind);
    CHECK(corner_count(model) == blender.faces().indices.size());
    for (const std::vector<float>& weights : { std::vector<float> { 1, 2, 0.5f }, { 0, 0, 1 } }) {
        const std::vector<float> q = blender.solve(weights, false);
        const std::vector<double> shape = morphed_shape(model, blender.asset(), q);
        CHECK(difference(shape, blender.positions(q)) < tolerance);
        check_box(model, shape);
    }
}

void check_painting(const tinygltf::Model& model)
{
    REQUIRE(model.materials.size() == 2);
    const tinygltf::Material& cloth = model.materials[0];
    CHECK(cloth.name == "cloth");
    CHECK(cloth.alphaMode == "MASK");
    CHECK(cloth.alphaCutoff == 0.25);
    CHECK(cloth.pbrMetallicRoughness.baseColorTexture.index == 0);
    CHECK(model.textures.at(0).source == 0);
    CHECK(model.samplers.at(std::size_t(model.textures[0].sampler)).wrapS == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE);
    REQUIRE(model.images.size() == 1);
    CHECK(std::string(model.images[0].image.begin(), model.images[0].image.end()) == image_bytes);
    const RenderScene& scene = *painted_poses().scene;
    const std::vector<float>& places = scene.find("TEXCOORD_0")->values;
    REQUIRE(model.meshes.at(0).primitives.size() == scene.parts.size());
    for (std::size_t i = 0; i < scene.parts.size(); ++i) {
        const tinygltf::Primitive& primitive = model.meshes[0].primitives[i];
        CHECK(primitive.material == scene.parts[i].material);
        CHECK(primitive.extras.Get("pliant").Get("first_vertex").GetNumberAsInt() == int(scene.parts[i].first_vertex));
        const auto first = places.begin() + std::ptrdiff_t(2 * scene.parts[i].first_vertex);
        const std::vector<float> wanted(first, first + std::ptrdiff_t(2 * scene.parts[i].vertex_count));
        std::vector<double> found = numbers_of(model, primitive.attributes.at("TEXCOORD_0")).values;
        found.resize(2 * own_count(model, primitive));
        CHECK(difference(found, wanted) == 0);
    }
}

} // namespace

TEST_CASE("tinygltf reads morph targets: base and targets give the shapes of the runtime, in integers as near as asked")
{
    for (RuntimeBlender* blender : { &tube(), &painted() }) {
        const std::array<double, 3> sides = pliant_test::sides_of(placed_shape(exported_model(*blender, kinds[1]), {}));
        check_blends(*blender, { false, true }, 1e-5);
        check_blends(*blender, in_integers({ false, true }), 1.5e-4 * std::hypot(sides[0], sides[1], sides[2]));
    }
    CHECK(has_empty_column(painted()));
}

TEST_CASE("a mesh without targets has its place by its node")
{
    const std::vector<double> plain = placed_shape(exported_model(tube(), kinds[1]), {});
    const tinygltf::Model model = exported_model(tube(), in_integers(kinds[1]));
    CHECK(model.extensionsRequired == std::vector<std::string> { "KHR_mesh_quantization" });
    const std::array<double, 3> sides = pliant_test::sides_of(plain);
    CHECK(difference(placed_shape(model, {}), plain) < 1e-4 * std::hypot(sides[0], sides[1], sides[2]));
}

TEST_CASE("materials, texture, image and texture coordinates come through every kind of export")
{
    for (const Kind& kind : kinds) {
        CAPTURE(kind.with_asset);
        CAPTURE(kind.bone_count);
        check_painting(exported_model(painted(), kind));
        check_painting(exported_model(painted(), in_integers(kind)));
    }
}

TEST_CASE("an embedded asset lies where its extension says, and is found again after tinygltf has saved the file")
{
    const pliant_asset& asset = tube().asset();
    for (const Kind& kind : { Kind { true, false }, Kind { true, true }, in_integers({ true, false }) }) {
        const tinygltf::Model model = exported_model(tube(), kind);
        const tinygltf::Mesh& mesh = model.meshes.at(0);
        REQUIRE(mesh.extensions.count("PLIANT_elastic_blend"));
        CHECK(mesh.extensions.at("PLIANT_elastic_blend").Get("bufferView").GetNumberAsInt() == 0);
        const tinygltf::BufferView& view = model.bufferViews.at(0);
        REQUIRE(view.byteLength == asset.blob_size);
        CHECK(std::memcmp(model.buffers.at(0).data.data() + view.byteOffset, asset.blob, asset.blob_size) == 0);

        const std::string saved = save(model);
        std::size_t offset = 0, size = 0;
        REQUIRE(pliant_glb_find(saved.data(), saved.size(), &offset, &size) == PLIANT_OK);
        CHECK(offset % 4096 != 0); // the page is lost, as the format allows
        REQUIRE(size >= asset.blob_size);
        CHECK(std::memcmp(saved.data() + offset, asset.blob, asset.blob_size) == 0);
        const AlignedCopy copy(saved.data() + offset, size);
        pliant_asset again;
        CHECK(pliant_asset_open(&again, copy.data(), asset.blob_size, PLIANT_OPEN_VERIFY_CHECKSUMS) == PLIANT_OK);
        CHECK(load_glb(saved).meshes.at(0).extensions.count("PLIANT_elastic_blend"));
    }
}

TEST_CASE("tinygltf reads a skin and its animation")
{
    const tinygltf::Model model = exported_model(tube(), { false, false, 4 });
    REQUIRE(model.skins.size() == 1);
    CHECK(model.skins[0].joints.size() == 4);
    CHECK(model.accessors.at(std::size_t(model.skins[0].inverseBindMatrices)).count == 4);
    const pliant_test::Numbers weights = numbers_of(model, only_primitive(model).attributes.at("WEIGHTS_0"));
    REQUIRE(weights.width == 4);
    REQUIRE(weights.count() == tube().asset().vertex_count);
    for (auto four = weights.values.begin(); four != weights.values.end(); four += 4)
        CHECK(std::accumulate(four, four + 4, 0.0) == doctest::Approx(1).epsilon(1e-5));
    REQUIRE(model.animations.size() == 1);
    for (const tinygltf::AnimationSampler& sampler : model.animations[0].samplers)
        CHECK(model.accessors.at(std::size_t(sampler.input)).count == default_path(WeightDomain::simplex(3), 2, 5).size());
}
