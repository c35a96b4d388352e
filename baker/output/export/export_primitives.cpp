#include "output/export/export_primitives.h"

#include "input/gltf/scene_chunk.h"
#include "pliant_format.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

using Json = Glb::Json;

constexpr const char* grey = R"({"materials":[{"name":"pliant","pbrMetallicRoughness":)"
                             R"({"baseColorFactor":[0.8,0.8,0.8,1.0],"metallicFactor":0.0,"roughnessFactor":0.7}}]})";

RenderScene plain_scene(const DrawnSpace& space)
{
    RenderScene scene;
    scene.vertex_count = std::uint32_t(space.vertex_count());
    for (std::size_t i = 0; i + 2 < space.triangles.size(); i += 3)
        scene.triangles.push_back({ space.triangles[i], space.triangles[i + 1], space.triangles[i + 2] });
    scene.parts = { { "", 0, 0, scene.vertex_count, 0, std::uint32_t(scene.triangles.size()), {} } };
    scene.materials = grey;
    return scene;
}

// Of the part's own vertices.
std::vector<std::uint32_t> corners_of(const RenderScene& scene, const ScenePart& part)
{
    std::vector<std::uint32_t> corners;
    for (std::size_t f = part.first_face; f < part.first_face + std::size_t(part.face_count); ++f)
        for (const std::uint32_t vertex : scene.triangles[f]) corners.push_back(vertex - part.first_vertex);
    return corners;
}

std::vector<std::int16_t> to_shorts(const Eigen::VectorXd& values)
{
    const Eigen::Matrix<std::int16_t, Eigen::Dynamic, 1> shorts = values.cast<std::int16_t>();
    return { shorts.data(), shorts.data() + shorts.size() };
}

std::vector<float> to_floats(const Eigen::VectorXd& values)
{
    const Eigen::VectorXf floats = values.cast<float>();
    return { floats.data(), floats.data() + floats.size() };
}

// Of a part, and of the box behind it.
Eigen::VectorXd vectors_of(const ScenePart& part, const Eigen::VectorXd& values, const Eigen::VectorXd& box)
{
    const auto count = 3 * Eigen::Index(part.vertex_count);
    Eigen::VectorXd rows(count + box.size());
    rows.head(count) = values.segment(3 * Eigen::Index(part.first_vertex), count);
    rows.tail(box.size()) = box;
    return rows;
}

std::size_t add_positions(Glb& glb, const Eigen::VectorXd& rows, bool is_whole, bool may_be_bytes)
{
    if (!is_whole) return glb.add_floats(to_floats(rows), 3, Glb::Target::vertices, true);
    const bool fits = may_be_bytes && rows.cwiseAbs().maxCoeff() <= 127;
    return glb.add_integers(to_shorts(rows), 3, fits ? gltf_int8 : gltf_int16, false, true);
}

std::size_t add_normals(Glb& glb, const Eigen::VectorXd& rows, bool is_whole)
{
    return is_whole ? glb.add_integers(to_shorts(rows), 3, gltf_int8, true, false)
                    : glb.add_floats(to_floats(rows), 3, Glb::Target::vertices);
}

// glTF wants unit vectors even where no face of any area is.
Eigen::VectorXd with_unit_length(Eigen::VectorXd normals, double unit)
{
    for (Eigen::Index i = 0; i < normals.size(); i += 3)
        if (normals.segment<3>(i).isZero(0)) normals[i + 2] = unit;
    return normals;
}

// TEXCOORD_k and COLOR_k. Normals are those of the blends; whatever else a chunk may hold has no place in glTF.
bool is_painted(const VertexAttribute& attribute)
{
    const bool is_place = attribute.name.compare(0, 9, "TEXCOORD_") == 0 && attribute.components == 2;
    return is_place || (attribute.name.compare(0, 6, "COLOR_") == 0 && attribute.components >= 3);
}

// The rows of a part out of `width` numbers for each vertex.
std::vector<float> rows_of(const ScenePart& part, const std::vector<float>& values, std::size_t width)
{
    const auto first = values.begin() + std::ptrdiff_t(part.first_vertex * width);
    return { first, first + std::ptrdiff_t(part.vertex_count * width) };
}

Json attributes_of(Glb& glb, const RenderScene& scene, const ScenePart& part, const StoredVertices& vertices,
                   const Eigen::VectorXd& box)
{
    Json attributes;
    attributes["POSITION"] = add_positions(glb, vectors_of(part, vertices.positions, box), vertices.is_whole, false);
    if (vertices.normals.size()) {
        const Eigen::VectorXd normals = vectors_of(part, vertices.normals, Eigen::VectorXd::Zero(box.size()));
        attributes["NORMAL"] = add_normals(glb, with_unit_length(normals, vertices.is_whole ? 127 : 1), vertices.is_whole);
    }
    for (const std::string& name : part.attributes) {
        const VertexAttribute& attribute = *scene.find(name);
        if (!is_painted(attribute)) continue;
        std::vector<float> rows = rows_of(part, attribute.values, attribute.components);
        rows.resize(rows.size() + std::size_t(box.size()) / 3 * attribute.components);
        attributes[name] = glb.add_floats(rows, int(attribute.components), Glb::Target::vertices);
    }
    return attributes;
}

// What a program with the runtime must know of a part (formats/SPEC.md, section 7); null if it is the whole asset.
Json extras_of(const RenderScene& scene, const ScenePart& part, bool has_box)
{
    Json ours;
    if (part.vertex_count != scene.vertex_count) ours = { { "name", part.name }, { "first_vertex", part.first_vertex } };
    if (has_box) ours["vertex_count"] = part.vertex_count;
    return ours;
}

} // namespace

RenderScene exported_scene(const RuntimeBlender& blender, const DrawnSpace& space, const std::string& path)
{
    std::size_t size = 0;
    const void* chunk = pliant_asset_chunk(&blender.asset(), PLIANT_CHUNK_SCENE, &size);
    if (!chunk) return plain_scene(space);
    const std::size_t limit = 2 * space.vertex_count(); // a wrong scene is told below; a hostile one takes no memory
    RenderScene scene = decode_scene_chunk({ static_cast<const char*>(chunk), size }, path, limit);
    const auto is_empty = [](const ScenePart& part) { return part.face_count == 0; };
    scene.parts.erase(std::remove_if(scene.parts.begin(), scene.parts.end(), is_empty), scene.parts.end());
    if (scene.vertex_count != space.vertex_count() || scene.parts.empty())
        throw Failure(ExitCode::bad_input,
                      error_at(4505, path,
                               fmt::format("its scene has {} vertices and {} parts with faces, the asset has {} vertices",
                                           scene.vertex_count, scene.parts.size(), space.vertex_count()),
                               "bake it again"));
    return scene;
}

Json add_primitives(Glb& glb, const RenderScene& scene, const StoredVertices& vertices, const Eigen::VectorXd& box)
{
    Json primitives = Json::array();
    const auto extra = std::uint32_t(box.size() / 3);
    for (const ScenePart& part : scene.parts) {
        std::vector<std::uint32_t> corners = corners_of(scene, part);
        if (extra) corners.insert(corners.end(), { part.vertex_count, part.vertex_count + 1, part.vertex_count });
        Json primitive;
        primitive["attributes"] = attributes_of(glb, scene, part, vertices, box);
        primitive["indices"] = glb.add_indices(corners, part.vertex_count + extra);
        if (part.material >= 0) primitive["material"] = part.material;
        Json ours = extras_of(scene, part, extra > 0);
        if (!ours.is_null()) primitive["extras"]["pliant"] = std::move(ours);
        primitives.push_back(std::move(primitive));
    }
    return primitives;
}

void add_target(Glb& glb, const RenderScene& scene, const StoredVertices& deltas, Json& primitives)
{
    const Eigen::VectorXd still = Eigen::VectorXd::Zero(6); // the box
    for (std::size_t i = 0; i < scene.parts.size(); ++i) {
        Json target;
        target["POSITION"] = add_positions(glb, vectors_of(scene.parts[i], deltas.positions, still), deltas.is_whole, true);
        if (deltas.normals.size())
            target["NORMAL"] = add_normals(glb, vectors_of(scene.parts[i], deltas.normals, still), deltas.is_whole);
        primitives[i]["targets"].push_back(std::move(target));
    }
}

void add_materials(Glb& glb, const RenderScene& scene)
{
    const Json materials = nlohmann::json::parse(scene.materials); // an ordered parse is quadratic in an object's keys
    for (const char* key : { "materials", "textures", "samplers", "images" })
        if (materials.contains(key)) glb.json()[key] = materials[key];
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        Json& image = glb.json()["images"][i];
        if (!scene.images[i].empty()) image["bufferView"] = glb.add_shared_view(scene.images[i]);
    }
    for (const char* list : { "extensionsUsed", "extensionsRequired" })
        if (materials.contains(list))
            for (const Json& name : materials[list])
                glb.use_extension(name.get<std::string>(), list == std::string_view("extensionsRequired"));
}

} // namespace pliant
