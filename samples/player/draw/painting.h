// Materials, textures and vertex colours of a character, from the asset's chunk GLTF (formats/SPEC.md). No OpenGL.
#pragma once

#include "blend/asset_file.h"
#include "draw/image_reader.h"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace pliant::player {

enum class Wrap { repeat, mirror, clamp };

struct Texture {
    std::size_t image = 0;
    Wrap wrap_x = Wrap::repeat, wrap_y = Wrap::repeat;
    bool nearest = false; // no interpolation between pixels
};

enum class Alpha { opaque, mask, blend };

// A range of the indices and its base colour as glTF defines it: factor times texture times vertex colour, all linear.
struct PaintedPart {
    std::uint32_t first_index = 0, index_count = 0;
    glm::vec4 factor { 1.0f };
    std::optional<std::size_t> texture;
    Alpha alpha = Alpha::opaque;
    float cutoff = 0.5f; // alpha mask: nothing is drawn below it
};

struct PaintedVertex {
    glm::vec2 place { 0.0f }; // texture coordinates in its part's texture
    glm::vec4 colour { 1.0f };
};

struct Painting {
    std::vector<PaintedVertex> vertices; // one for each vertex of the asset
    std::vector<std::uint32_t> indices;  // triangles, part by part
    std::vector<PaintedPart> parts;
    std::vector<Texture> textures;
    std::vector<Image> images;
};

// Empty if the asset has no such chunk, or a chunk without materials and colours. Throws Error (exit code 3) if it is
// damaged.
std::optional<Painting> painting_of(const AssetFile& file);

} // namespace pliant::player
