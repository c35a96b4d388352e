// What `pliant export` writes, read by the loader that games link (tinygltf, MIT), and written again by it.
#include "../tube.h"

#include "bake/bake.h"
#include "output/export/export_asset.h"

#include <cstring>
#include <doctest/doctest.h>
#include <fmt/core.h>
#include <sstream>
#include <tiny_gltf.h>

using namespace pliant;

namespace {

tinygltf::Model load(const std::string& bytes)
{
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    const bool is_read = loader.LoadBinaryFromMemory(
        &model, &error, &warning, reinterpret_cast<const unsigned char*>(bytes.data()), unsigned(bytes.size()));
    CHECK_MESSAGE(is_read, error);
    CHECK(error == "");
    CHECK(warning == "");
    return model;
}

std::string save(const tinygltf::Model& model)
{
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    CHECK(writer.WriteGltfSceneToStream(&model, stream, false, true));
    return stream.str();
}

// The floats of an accessor without gaps.
Eigen::MatrixXf floats_of(const tinygltf::Model& model, int number)
{
    const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(number));
    REQUIRE(accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT);
    const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
    const int rows = tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type));
    REQUIRE(accessor.ByteStride(view) == 4 * rows);
    Eigen::MatrixXf values(rows, Eigen::Index(accessor.count));
    const std::size_t begin = view.byteOffset + accessor.byteOffset, size = 4 * std::size_t(values.size());
    REQUIRE(begin + size <= model.buffers.at(std::size_t(view.buffer)).data.size());
    std::memcpy(values.data(), model.buffers[std::size_t(view.buffer)].data.data() + begin, size);
    return values;
}

const tinygltf::Primitive& only_primitive(const tinygltf::Model& model)
{
    REQUIRE(model.meshes.size() == 1);
    REQUIRE(model.meshes[0].primitives.size() == 1);
    return model.meshes[0].primitives[0];
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

RuntimeBlender& tube()
{
    static Progress silent;
    static RuntimeBlender blender(bake(tube_poses(3), BakeOptions(), silent).bytes, "tube");
    return blender;
}

std::string exported(bool with_asset, bool with_morph_targets, int bone_count = 0)
{
    ExportOptions options;
    options.with_asset = with_asset;
    options.with_morph_targets = with_morph_targets;
    options.bone_count = decltype(options.bone_count)(bone_count);
    options.frames_per_second = 5;
    options.path = bone_count ? default_path(3, 2, 5) : options.path;
    return export_asset(tube(), options).bytes;
}

} // namespace

TEST_CASE("tinygltf reads morph targets: base and targets give the shapes of the runtime")
{
    const tinygltf::Model model = load(exported(false, true));
    const tinygltf::Primitive& primitive = only_primitive(model);
    const pliant_asset& asset = tube().asset();
    REQUIRE(primitive.targets.size() == asset.dimension);
    CHECK(model.accessors.at(std::size_t(primitive.indices)).count == 3 * tube_poses(3).triangles.size());
    const std::vector<float> q = tube().solve({ 1, 2, 0.5f }, false), expected = tube().positions(q);
    std::vector<float> weights(asset.dimension);
    REQUIRE(pliant_morph_weights(&asset, q.data(), weights.data()) == PLIANT_OK);
    Eigen::MatrixXf shape = floats_of(model, primitive.attributes.at("POSITION"));
    for (std::size_t j = 0; j < weights.size(); ++j)
        shape += weights[j] * floats_of(model, primitive.targets[j].at("POSITION"));
    REQUIRE(shape.size() == Eigen::Index(expected.size()));
    CHECK((shape.reshaped() - Eigen::Map<const Eigen::VectorXf>(expected.data(), shape.size())).cwiseAbs().maxCoeff()
          < 1e-5);
}

TEST_CASE("an embedded asset lies where its extension says, and is found again after tinygltf has saved the file")
{
    for (const bool with_morph_targets : { false, true }) {
        const std::string bytes = exported(true, with_morph_targets);
        const pliant_asset& asset = tube().asset();
        const tinygltf::Model model = load(bytes);
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
        CHECK(load(saved).meshes.at(0).extensions.count("PLIANT_elastic_blend"));
    }
}

TEST_CASE("tinygltf reads a skin and its animation")
{
    const tinygltf::Model model = load(exported(false, false, 4));
    REQUIRE(model.skins.size() == 1);
    CHECK(model.skins[0].joints.size() == 4);
    CHECK(model.accessors.at(std::size_t(model.skins[0].inverseBindMatrices)).count == 4);
    const tinygltf::Primitive& primitive = only_primitive(model);
    const Eigen::MatrixXf weights = floats_of(model, primitive.attributes.at("WEIGHTS_0"));
    CHECK((weights.colwise().sum().array() - 1).abs().maxCoeff() < 1e-5);
    REQUIRE(model.animations.size() == 1);
    for (const tinygltf::AnimationSampler& sampler : model.animations[0].samplers)
        CHECK(model.accessors.at(std::size_t(sampler.input)).count == default_path(3, 2, 5).size());
}
