#include "output/export/export_primitives.h"

#include "input/gltf/scene_chunk.h"
#include "output/export/draco_mesh.h"
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

// KHR_draco_mesh_compression: the accessors say what comes out.
Json add_compressed(Glb& glb, const std::vector<float>& positions, const std::vector<float>& normals,
                    const std::vector<std::uint32_t>& corners, ExportReport& report)
{
    const DracoMesh mesh = compress_mesh(positions, normals, corners);
    const std::size_t view = glb.add_view(mesh.bytes);
    const std::size_t position = glb.describe_floats(mesh.positions, 3, true);
    const std::size_t normal = glb.describe_floats(normals, 3, false);
    const std::size_t indices = glb.describe_indices(corners.size(), positions.size() / 3);
    report.compression_error = std::max(report.compression_error, mesh.largest_error);
    return { { "attributes", { { "POSITION", position }, { "NORMAL", normal } } },
             { "indices", indices },
             { "extensions",
               { { "KHR_draco_mesh_compression",
                   { { "bufferView", view },
                     { "attributes", { { "POSITION", mesh.position_id }, { "NORMAL", mesh.normal_id } } } } } } } };
}

Json add_plain(Glb& glb, const std::vector<float>& positions, const std::vector<float>& normals,
               const std::vector<std::uint32_t>& corners)
{
    const std::size_t position = glb.add_floats(positions, 3, Glb::Target::vertices, true);
    const std::size_t normal = glb.add_floats(normals, 3, Glb::Target::vertices);
    const std::size_t indices = glb.add_indices(corners, positions.size() / 3);
    return { { "attributes", { { "POSITION", position }, { "NORMAL", normal } } }, { "indices", indices } };
}

// glTF wants unit vectors even where no face of any area is.
std::vector<float> with_unit_length(std::vector<float> normals)
{
    for (std::size_t i = 0; i < normals.size(); i += 3)
        if (normals[i] == 0 && normals[i + 1] == 0 && normals[i + 2] == 0) normals[i + 2] = 1;
    return normals;
}

// TEXCOORD_k and COLOR_k. Normals are those of the blends; whatever else a chunk may hold has no place in glTF.
bool is_painted(const VertexAttribute& attribute)
{
    const bool is_place = attribute.name.compare(0, 9, "TEXCOORD_") == 0 && attribute.components == 2;
    return is_place || (attribute.name.compare(0, 6, "COLOR_") == 0 && attribute.components >= 3);
}

} // namespace

RenderScene exported_scene(const RuntimeBlender& blender, const DrawnSpace& space, const std::string& path)
{
    std::size_t size = 0;
    const void* chunk = pliant_asset_chunk(&blender.asset(), PLIANT_CHUNK_SCENE, &size);
    if (!chunk) return plain_scene(space);
    RenderScene scene = decode_scene_chunk({ static_cast<const char*>(chunk), size }, path);
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

std::vector<float> rows_of(const ScenePart& part, const std::vector<float>& values, std::size_t width)
{
    const auto first = values.begin() + std::ptrdiff_t(part.first_vertex * width);
    return { first, first + std::ptrdiff_t(part.vertex_count * width) };
}

Json add_primitives(Glb& glb, const RenderScene& scene, const std::vector<float>& positions,
                    const std::vector<float>& normals, const ExportOptions& options, ExportReport& report)
{
    Json primitives = Json::array();
    for (const ScenePart& part : scene.parts) {
        const std::vector<float> places = rows_of(part, positions, 3),
                                 directions = with_unit_length(rows_of(part, normals, 3));
        const std::vector<std::uint32_t> corners = corners_of(scene, part);
        Json primitive = options.with_compression ? add_compressed(glb, places, directions, corners, report)
                                                  : add_plain(glb, places, directions, corners);
        for (const std::string& name : part.attributes) {
            const VertexAttribute& attribute = *scene.find(name);
            if (!is_painted(attribute)) continue;
            primitive["attributes"][name] = glb.add_floats(rows_of(part, attribute.values, attribute.components),
                                                           int(attribute.components), Glb::Target::vertices);
        }
        if (part.material >= 0) primitive["material"] = part.material;
        if (part.vertex_count != scene.vertex_count)
            primitive["extras"] = { { "pliant", { { "name", part.name }, { "first_vertex", part.first_vertex } } } };
        primitives.push_back(std::move(primitive));
    }
    if (options.with_compression)
        for (const char* list : { "extensionsUsed", "extensionsRequired" })
            glb.json()[list].push_back("KHR_draco_mesh_compression");
    return primitives;
}

void add_materials(Glb& glb, const RenderScene& scene)
{
    const Json materials = Json::parse(scene.materials);
    for (const char* key : { "materials", "textures", "samplers", "images" })
        if (materials.contains(key)) glb.json()[key] = materials[key];
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        Json& image = glb.json()["images"][i];
        if (!scene.images[i].empty()) image["bufferView"] = glb.add_shared_view(scene.images[i]);
    }
    if (materials.contains("extensionsUsed"))
        for (const Json& name : materials["extensionsUsed"]) glb.json()["extensionsUsed"].push_back(name);
}

} // namespace pliant
