// What a glTF pose source draws besides positions: parts, colours, materials. Plain data, kept from the file to the asset's
// scene chunk.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// One primitive of the file: a run of vertices and a run of faces that use only these, drawn with one material.
struct ScenePart {
    std::string name;             // of its mesh, for people
    std::ptrdiff_t material = -1; // index into the materials; -1: none
    std::uint32_t first_vertex = 0, vertex_count = 0;
    std::uint32_t first_face = 0, face_count = 0;
    std::vector<std::string> attributes; // those it has, of RenderScene::attributes
};

// Numbers of all vertices: n rows of `components`; zero in parts that do not have them. By glTF's names: NORMAL (3, length
// 1, of the file's first pose), TEXCOORD_k (2), COLOR_k (3 or 4, linear), k below 8.
struct VertexAttribute {
    std::string name;
    std::uint32_t components = 0;
    std::vector<float> values;
};

// Eight sets are more than any engine draws, and each takes memory for all vertices.
inline bool is_drawn_attribute(std::string_view name)
{
    if (name == "NORMAL") return true;
    const std::string_view set = name.substr(0, name.empty() ? 0 : name.size() - 1);
    return (set == "TEXCOORD_" || set == "COLOR_") && name.back() >= '0' && name.back() <= '7';
}

struct RenderScene {
    std::string path;
    std::uint32_t vertex_count = 0;
    std::vector<std::array<std::uint32_t, 3>> triangles; // as the file has them, corners below vertex_count
    std::vector<ScenePart> parts;                        // in the order of vertices and faces, without gaps
    std::vector<VertexAttribute> attributes;

    // JSON text of an object with the file's own materials, textures, samplers and images, and the extensionsUsed and
    // extensionsRequired of these, where it has them. An image is {"mimeType", "name"} and its bytes are images[i], in the
    // file's encoding (PNG, JPEG, ...).
    std::string materials;
    std::vector<std::string> images;

    // Null if no part has it.
    const VertexAttribute* find(const std::string& name) const
    {
        for (const VertexAttribute& attribute : attributes)
            if (attribute.name == name) return &attribute;
        return nullptr;
    }
};

} // namespace pliant
