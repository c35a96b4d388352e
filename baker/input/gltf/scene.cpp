#include "input/gltf/scene.h"

#include "input/gltf/widened_shorts.h"

#include "input/io/source_file.h"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <set>
#include <utility>

namespace pliant {
namespace {

// A small file may draw one mesh many times, or unpack a little Draco into much: numbers that are believed of any file, and
// of each of its bytes. A drawn primitive counts for some numbers itself.
constexpr std::uint64_t free_numbers = 4000000, numbers_per_byte = 8, numbers_of_part = 64, numbers_of_node = 96,
                        numbers_of_joint = 32;

// Of meshes, whose names every node repeats, and of targets.
constexpr std::size_t name_size_limit = 256;

std::string name_of(const GltfValue& value)
{
    std::string name = value.text_or("");
    if (name.size() > name_size_limit)
        value.fail(2306, fmt::format("has {} bytes, the limit is {}", name.size(), name_size_limit));
    if (name.find('\0') != std::string::npos) value.fail(2306, "has a zero character");
    return name;
}

Eigen::Matrix4d matrix_of(const GltfNode& node, const GltfTransform& transform)
{
    if (node.has_matrix) return node.matrix;
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topLeftCorner<3, 3>() = transform.rotation.toRotationMatrix() * transform.scale.asDiagonal();
    matrix.topRightCorner<3, 1>() = transform.translation;
    return matrix;
}

Eigen::Vector3d vector_of(const GltfValue& value, double missing)
{
    if (!value.exists()) return Eigen::Vector3d::Constant(missing);
    const std::vector<double> v = value.numbers(3);
    return { v[0], v[1], v[2] };
}

Eigen::Quaterniond rotation_of(const GltfValue& value)
{
    if (!value.exists()) return Eigen::Quaterniond::Identity();
    const std::vector<double> v = value.numbers(4); // x y z w
    const Eigen::Quaterniond rotation(v[3], v[0], v[1], v[2]);
    if (!(rotation.norm() > 1e-6)) value.fail(2306, "a rotation of length 1 expected"); // files round to 1e-6 at best
    return rotation.normalized();
}

std::vector<double> weights_of(const GltfValue& value, std::size_t count)
{
    std::vector<double> weights(count, 0.0);
    if (value.exists() && value.size() > count)
        value.fail(2317, fmt::format("has {} weights for {} morph targets", value.size(), count), "export the file again");
    for (std::size_t i = 0; i < value.size(); ++i) weights[i] = value.at(i).number();
    return weights;
}

void read_node(const GltfDocument& document, const GltfValue& value, GltfScene& scene)
{
    GltfNode node;
    node.name = value["name"].text_or("");
    node.mesh = value["mesh"].index_or_none(document["meshes"].size(), "meshes");
    node.skin = value["skin"].index_or_none(document["skins"].size(), "skins");
    node.has_matrix = value["matrix"].exists();
    if (node.has_matrix) {
        const std::vector<double> m = value["matrix"].numbers(16);
        node.matrix = Eigen::Map<const Eigen::Matrix4d>(m.data()); // column after column, as Eigen's
    }
    scene.rest.transforms.push_back(
        { vector_of(value["translation"], 0), rotation_of(value["rotation"]), vector_of(value["scale"], 1) });
    scene.nodes.push_back(std::move(node));
}

void read_nodes(GltfScene& scene, GltfAllowance& allowance)
{
    const GltfDocument& document = *scene.document;
    const GltfValue nodes = document["nodes"];
    allowance.take(nodes, nodes.size(), numbers_of_node);
    for (std::size_t i = 0; i < nodes.size(); ++i) read_node(document, nodes.at(i), scene);
    std::vector<std::vector<std::size_t>> children(scene.nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const GltfValue list = nodes.at(i)["children"];
        for (std::size_t k = 0; k < list.size(); ++k) {
            const std::size_t child = list.at(k).index(scene.nodes.size(), "nodes");
            if (scene.nodes[child].parent >= 0)
                list.at(k).fail(2314,
                                fmt::format("node {} has two parents, {} and {}", child, scene.nodes[child].parent, i));
            scene.nodes[child].parent = static_cast<std::ptrdiff_t>(i);
            children[i].push_back(child);
        }
    }
    for (std::size_t i = 0; i < scene.nodes.size(); ++i)
        if (scene.nodes[i].parent < 0) scene.parents_first.push_back(i);
    for (std::size_t i = 0; i < scene.parents_first.size(); ++i) // grows while it is walked
        for (const std::size_t child : children[scene.parents_first[i]]) scene.parents_first.push_back(child);
    if (scene.parents_first.size() != scene.nodes.size()) nodes.fail(2314, "nodes are their own ancestors");
}

// Numbers of the nodes that the default scene shows, ascending.
std::vector<std::size_t> shown_nodes(const GltfScene& scene)
{
    const GltfDocument& document = *scene.document;
    const GltfValue scenes = document["scenes"];
    std::vector<bool> is_shown(scene.nodes.size(), scenes.size() == 0);
    if (scenes.size() != 0) {
        const GltfValue chosen = document["scene"];
        const GltfValue roots = scenes.at(chosen.exists() ? chosen.index(scenes.size(), "scenes") : 0)["nodes"];
        for (std::size_t i = 0; i < roots.size(); ++i) is_shown[roots.at(i).index(scene.nodes.size(), "nodes")] = true;
        for (const std::size_t node : scene.parents_first)
            if (scene.nodes[node].parent >= 0 && is_shown[static_cast<std::size_t>(scene.nodes[node].parent)])
                is_shown[node] = true;
    }
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < is_shown.size(); ++i)
        if (is_shown[i]) numbers.push_back(i);
    return numbers;
}

// Exporters write them into the extras of the mesh, as the specification suggests; those of VRM into its primitives'.
std::optional<GltfValue> given_target_names(const GltfValue& mesh)
{
    const auto names_in = [](const GltfValue& holder) -> std::optional<GltfValue> {
        const GltfValue extras = holder["extras"];
        if (!extras.exists() || !extras.json().is_object()) return std::nullopt;
        const GltfValue names = extras["targetNames"];
        return names.exists() && names.json().is_array() && names.size() > 0 ? std::optional<GltfValue>(names)
                                                                             : std::nullopt;
    };
    if (const std::optional<GltfValue> names = names_in(mesh)) return names;
    const GltfValue primitives = mesh["primitives"];
    for (std::size_t i = 0; i < primitives.size(); ++i)
        if (const std::optional<GltfValue> names = names_in(primitives.at(i))) return names;
    return std::nullopt;
}

std::vector<std::string> target_names_of(const GltfValue& mesh, std::size_t count)
{
    std::vector<std::string> names;
    std::set<std::string> known;
    std::size_t next = 1;
    const std::optional<GltfValue> given = given_target_names(mesh);
    for (std::size_t i = 0; i < count; ++i) {
        std::string name;
        if (given && i < given->size() && given->at(i).json().is_string()) name = name_of(given->at(i));
        for (next = std::max(next, i + 1); name.empty() || !known.insert(name).second; ++next)
            name = fmt::format("target_{}", next); // others may have such a name, too
        names.push_back(std::move(name));
    }
    return names;
}

struct LeftOut {
    std::size_t primitives = 0;
    std::string first; // its place
};

GltfMesh read_gltf_mesh(const GltfDocument& document, const GltfValue& value, GltfAllowance& allowance, LeftOut& left_out)
{
    GltfMesh mesh;
    mesh.name = name_of(value["name"]);
    const GltfValue primitives = value["primitives"];
    std::size_t target_count = 0;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const GltfValue primitive = primitives.at(i);
        if (!has_triangles(primitive)) {
            if (left_out.primitives++ == 0) left_out.first = primitive.place();
            continue;
        }
        mesh.primitives.push_back(read_primitive(document, primitive, allowance));
        target_count = std::max(target_count, mesh.primitives.back().targets.size());
    }
    mesh.target_names = target_names_of(value, target_count);
    return mesh;
}

std::uint64_t vertex_count_of(const GltfMesh& mesh)
{
    std::uint64_t count = 0;
    for (const GltfPrimitive& primitive : mesh.primitives) count += primitive.vertex_count();
    return count;
}

std::uint64_t number_count_of(const GltfMesh& mesh)
{
    std::uint64_t count = 0;
    for (const GltfPrimitive& primitive : mesh.primitives) count += primitive.number_count();
    return count;
}

// An extension that draws the mesh many times; files need not list it among the required ones.
void refuse_instancing(const GltfValue& node)
{
    constexpr const char* name = "EXT_mesh_gpu_instancing";
    if (!node["extensions"][name].exists()) return;
    node.fail(2305, fmt::format("needs the extension {}, which is not read", name),
              "export the file with a node for each instance (gltf-transform optimize --instance false)");
}

void read_instances(GltfScene& scene, GltfAllowance& allowance, std::vector<Diagnostic>& warnings)
{
    const GltfDocument& document = *scene.document;
    const GltfValue meshes = document["meshes"];
    scene.meshes.resize(meshes.size());
    std::vector<bool> is_read(meshes.size(), false);
    std::uint64_t vertex_count = 0;
    LeftOut left_out;
    for (const std::size_t node : shown_nodes(scene)) {
        if (scene.nodes[node].mesh < 0) continue;
        const std::size_t mesh = static_cast<std::size_t>(scene.nodes[node].mesh);
        const GltfValue place = document["nodes"].at(node);
        refuse_instancing(place);
        if (is_read[mesh])
            allowance.take(place, number_count_of(scene.meshes[mesh]));
        else
            scene.meshes[mesh] = read_gltf_mesh(document, meshes.at(mesh), allowance, left_out);
        is_read[mesh] = true;
        allowance.take(place, scene.meshes[mesh].primitives.size(), numbers_of_part);
        vertex_count += vertex_count_of(scene.meshes[mesh]);
        if (vertex_count > vertex_count_limit)
            place.fail(2007, fmt::format("makes {} vertices, the limit is {}", vertex_count, vertex_count_limit),
                       "simplify the mesh");
        scene.instances.push_back({ node, mesh, scene.nodes[node].skin });
    }
    if (left_out.primitives != 0)
        warnings.push_back(warning_at(2313, document.path(),
                                      fmt::format("{} primitives of points or lines are ignored, the first is {}",
                                                  left_out.primitives, left_out.first),
                                      "only triangles are used"));
}

void read_skins(GltfScene& scene, GltfAllowance& drawn)
{
    const GltfDocument& document = *scene.document;
    const GltfValue skins = document["skins"];
    GltfAllowance allowance(document);
    for (std::size_t s = 0; s < skins.size(); ++s) {
        GltfSkin skin;
        const GltfValue joints = skins.at(s)["joints"];
        drawn.take(joints, joints.size(), numbers_of_joint);
        for (std::size_t i = 0; i < joints.size(); ++i)
            skin.joints.push_back(joints.at(i).index(scene.nodes.size(), "nodes"));
        skin.inverse_bind.assign(skin.joints.size(), Eigen::Matrix4d::Identity());
        if (const GltfValue matrices = skins.at(s)["inverseBindMatrices"]; matrices.exists()) {
            allowance.take_all_of(matrices);
            const GltfNumbers numbers = read_numbers(document, matrices, { 16 });
            if (static_cast<std::size_t>(numbers.rows()) < skin.joints.size())
                matrices.fail(2324, fmt::format("has {} matrices for {} joints", numbers.rows(), skin.joints.size()));
            for (std::size_t i = 0; i < skin.joints.size(); ++i)
                skin.inverse_bind[i] = Eigen::Map<const Eigen::Matrix4d>(
                    numbers.row(static_cast<Eigen::Index>(i)).data()); // column by column
        }
        scene.skins.push_back(std::move(skin));
    }
}

std::string name_of_joint(std::uint32_t joint)
{
    return joint == UINT32_MAX ? "a joint that is no whole number" : fmt::format("joint {}", joint);
}

// Influences name joints of the skin; weights are made to sum to 1. Returns how many did not, by more than files round.
std::size_t normalise_weights(const GltfScene& scene, const GltfInstance& instance, GltfPrimitive& primitive)
{
    constexpr double rounding = 0.01; // four weights of a byte each are off by 4 * 0.5 / 255
    const std::size_t joint_count = scene.skins[static_cast<std::size_t>(instance.skin)].joints.size();
    std::size_t unequal = 0;
    for (Eigen::Index v = 0; v < primitive.weights.rows(); ++v) {
        auto weights = primitive.weights.row(v);
        for (Eigen::Index c = 0; c < weights.size(); ++c) {
            const std::uint32_t joint = primitive.joints[static_cast<std::size_t>(v * weights.size() + c)];
            if (weights[c] != 0 && joint >= joint_count)
                scene.document->root().fail(2324,
                                            fmt::format("node {}: vertex {} of its mesh uses {}, its skin has {}",
                                                        instance.node, v, name_of_joint(joint), joint_count),
                                            "export the file again");
        }
        const double sum = weights.sum();
        if (!std::isfinite(sum))
            scene.document->root().fail(
                2324, fmt::format("node {}: vertex {} of its mesh has joint weights that are no numbers", instance.node, v),
                "export the file again");
        if (std::abs(sum - 1) > rounding) ++unequal;
        if (sum > 1e-6) // of weights that are at best multiples of 1/65535
            weights /= sum;
        else
            weights.setZero(), weights[0] = 1; // what engines do
        if (!(sum > 1e-6) && primitive.joints[static_cast<std::size_t>(v * weights.size())] >= joint_count)
            primitive.joints[static_cast<std::size_t>(v * weights.size())] = 0;
    }
    return unequal;
}

void check_skins(GltfScene& scene, std::vector<Diagnostic>& warnings)
{
    std::vector<bool> is_done(scene.meshes.size(), false);
    std::size_t unequal = 0;
    for (GltfInstance& instance : scene.instances) {
        if (instance.skin < 0) continue;
        const GltfSkin& skin = scene.skins[static_cast<std::size_t>(instance.skin)];
        if (skin.joints.empty())
            scene.document->root().fail(2324, fmt::format("skin {} has no joints", instance.skin), "export the file again");
        for (GltfPrimitive& primitive : scene.meshes[instance.mesh].primitives) {
            if (primitive.weights.cols() == 0)
                scene.document->root().fail(
                    2324, fmt::format("node {} has a skin, but its mesh has no JOINTS_0 and WEIGHTS_0", instance.node),
                    "export the file again");
            // Another skin at the same mesh may have fewer joints; weights that sum to 1 stay as they are.
            const std::size_t count = normalise_weights(scene, instance, primitive);
            if (!is_done[instance.mesh]) unequal += count;
        }
        is_done[instance.mesh] = true;
    }
    if (unequal != 0)
        warnings.push_back(warning_at(2323, scene.document->path(),
                                      fmt::format("the joint weights of {} vertices do not sum to 1: normalised", unequal),
                                      "harmless if the program that renders them does the same"));
}

// Of all nodes, at rest. A mesh that is not drawn has not been read: it has none.
void read_weights(GltfScene& scene, GltfAllowance& allowance)
{
    constexpr std::uint64_t numbers_of_weight = 8; // poses have copies, and look at every one
    const GltfDocument& document = *scene.document;
    for (std::size_t i = 0; i < scene.nodes.size(); ++i) {
        const std::ptrdiff_t mesh = scene.nodes[i].mesh;
        const std::size_t count = mesh < 0 ? 0 : scene.meshes[static_cast<std::size_t>(mesh)].target_names.size();
        const GltfValue node = document["nodes"].at(i), own = node["weights"];
        const GltfValue weights
            = own.exists() || mesh < 0 ? own : document["meshes"].at(static_cast<std::size_t>(mesh))["weights"];
        allowance.take(node, count, numbers_of_weight);
        scene.rest.weights.push_back(count == 0 ? std::vector<double>() : weights_of(weights, count));
    }
}

void name_targets(GltfScene& scene)
{
    std::set<std::string> known;
    std::vector<bool> is_done(scene.meshes.size(), false);
    for (const GltfInstance& instance : scene.instances) {
        if (is_done[instance.mesh]) continue;
        is_done[instance.mesh] = true;
        for (const std::string& name : scene.meshes[instance.mesh].target_names)
            if (known.insert(name).second) scene.target_names.push_back(name);
    }
}

} // namespace

std::vector<Eigen::Matrix4d> world_matrices(const GltfScene& scene, const GltfState& state)
{
    std::vector<Eigen::Matrix4d> world(scene.nodes.size());
    for (const std::size_t i : scene.parents_first) {
        const GltfNode& node = scene.nodes[i];
        const Eigen::Matrix4d local = matrix_of(node, state.transforms[i]);
        world[i] = node.parent < 0 ? local : world[static_cast<std::size_t>(node.parent)] * local;
    }
    return world;
}

std::uint64_t GltfScene::vertex_count() const
{
    std::uint64_t count = 0;
    for (const GltfInstance& instance : instances) count += vertex_count_of(meshes[instance.mesh]);
    return count;
}

GltfScene read_scene(std::shared_ptr<const GltfDocument> document, std::vector<Diagnostic>& warnings)
{
    GltfScene scene;
    scene.document = std::move(document);
    GltfAllowance drawn(*scene.document, free_numbers, numbers_per_byte);
    read_nodes(scene, drawn);
    read_skins(scene, drawn);
    read_instances(scene, drawn, warnings);
    std::size_t triangle_count = 0;
    for (const GltfInstance& instance : scene.instances)
        for (const GltfPrimitive& primitive : scene.meshes[instance.mesh].primitives)
            triangle_count += primitive.triangles.size();
    if (triangle_count == 0)
        scene.document->root().fail(2312, "its scene has no mesh with triangles", "export the mesh along with the scene");
    check_skins(scene, warnings);
    read_weights(scene, drawn);
    name_targets(scene);
    std::vector<GltfPrimitive*> primitives;
    for (GltfMesh& mesh : scene.meshes)
        for (GltfPrimitive& primitive : mesh.primitives) primitives.push_back(&primitive);
    find_widened_shorts(primitives);
    return scene;
}

} // namespace pliant
