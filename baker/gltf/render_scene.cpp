#include "gltf/render_scene.h"

#include <algorithm>
#include <fmt/format.h>

namespace pliant {
namespace {

// The attribute of that name, made if need be.
VertexAttribute& attribute_of(RenderScene& scene, const std::string& name, std::uint32_t components)
{
    for (VertexAttribute& attribute : scene.attributes) {
        if (attribute.name != name) continue;
        if (attribute.components < components) { // colours with alpha in a later part
            std::vector<float> values(std::size_t(scene.vertex_count) * components, 0.0f);
            for (std::size_t v = 0; v < scene.vertex_count; ++v) {
                for (std::size_t c = 0; c < attribute.components; ++c)
                    values[v * components + c] = attribute.values[v * attribute.components + c];
                values[v * components + components - 1] = 1;
            }
            attribute.values = std::move(values);
            attribute.components = components;
        }
        return attribute;
    }
    scene.attributes.push_back({ name, components, std::vector<float>(std::size_t(scene.vertex_count) * components, 0.0f) });
    return scene.attributes.back();
}

void put_attribute(RenderScene& scene, const std::string& name, const GltfNumbers& numbers, std::uint32_t first)
{
    VertexAttribute& attribute = attribute_of(scene, name, static_cast<std::uint32_t>(numbers.cols()));
    for (Eigen::Index v = 0; v < numbers.rows(); ++v)
        for (std::uint32_t c = 0; c < attribute.components; ++c)
            attribute.values[(first + std::size_t(v)) * attribute.components + c]
                = static_cast<Eigen::Index>(c) < numbers.cols() ? static_cast<float>(numbers(v, c)) : 1.0f;
}

void put_parts(const GltfScene& scene, const Positions& normals, RenderScene& out)
{
    std::uint32_t vertex = 0, face = 0;
    for (const GltfInstance& instance : scene.instances) {
        const GltfMesh& mesh = scene.meshes[instance.mesh];
        for (const GltfPrimitive& primitive : mesh.primitives) {
            ScenePart part { mesh.name, primitive.material,
                             vertex,    static_cast<std::uint32_t>(primitive.vertex_count()),
                             face,      static_cast<std::uint32_t>(primitive.triangles.size()),
                             {} };
            for (const auto& [name, numbers] : primitive.attributes) {
                part.attributes.push_back(name);
                put_attribute(out, name,
                              name == "NORMAL" ? GltfNumbers(normals.middleRows(vertex, part.vertex_count)) : numbers,
                              vertex);
            }
            vertex += part.vertex_count;
            face += part.face_count;
            out.parts.push_back(std::move(part));
        }
    }
}

// Images without their places in the file; their bytes go to `out`.
GltfJson take_images(const GltfDocument& document, RenderScene& out, std::vector<Finding>& warnings)
{
    GltfJson images = GltfJson::array();
    const GltfValue list = document["images"];
    for (std::size_t i = 0; i < list.size(); ++i) {
        std::string why;
        std::string bytes = document.image(i, why);
        GltfJson image = GltfJson::object();
        for (const char* key : { "name", "mimeType" })
            if (list.at(i)[key].exists()) image[key] = list.at(i)[key].text();
        if (!image.contains("mimeType"))
            image["mimeType"] = bytes.compare(0, 3, "\xff\xd8\xff") == 0 ? "image/jpeg" : "image/png";
        if (bytes.empty())
            warnings.push_back(warning_at(2328, document.path(),
                                          fmt::format("image {} is left out: {}", i, why.empty() ? "it is empty" : why),
                                          "put the file there, or pack all into one .glb"));
        out.images.push_back(std::move(bytes));
        images.push_back(std::move(image));
    }
    return images;
}

// Every index in the lists that are kept points into them, or the file is wrong.
void check_materials(const GltfDocument& document)
{
    const GltfValue textures = document["textures"];
    for (std::size_t i = 0; i < textures.size(); ++i) {
        textures.at(i)["source"].index_or_none(document["images"].size(), "images");
        textures.at(i)["sampler"].index_or_none(document["samplers"].size(), "samplers");
    }
    for (const char* key : { "materials", "samplers" })
        for (std::size_t i = 0; i < document[key].size(); ++i)
            if (!document[key].at(i).json().is_object()) document[key].at(i).fail(2306, "an object expected");
}

} // namespace

RenderScene render_scene(const GltfScene& scene, const Positions& normals, std::vector<Finding>& warnings)
{
    const GltfDocument& document = *scene.document;
    RenderScene out;
    out.path = document.path();
    out.vertex_count = static_cast<std::uint32_t>(scene.vertex_count());
    put_parts(scene, normals, out);
    check_materials(document);
    GltfJson materials = GltfJson::object();
    for (const char* key : { "materials", "textures", "samplers", "extensionsUsed" })
        if (document[key].size() != 0) materials[key] = document[key].json();
    GltfJson images = take_images(document, out, warnings);
    if (!images.empty()) materials["images"] = std::move(images);
    out.materials = materials.dump(-1, ' ', false, GltfJson::error_handler_t::replace);
    return out;
}

} // namespace pliant
