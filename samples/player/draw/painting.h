// How a character is painted: parts, materials, textures and colours of the asset's chunk GLTF (formats/SPEC.md). No graphics in here.
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
    bool nearest = false; // between its pixels nothing is mixed
};

enum class Alpha { opaque, mask, blend };

// A run of the indices, and what glTF says of the base colour there: factor times texture times the vertices' colours, all linear.
struct PaintedPart {
    std::uint32_t first_index = 0, index_count = 0;
    glm::vec4 factor { 1.0f };
    std::optional<std::size_t> texture;
    Alpha alpha = Alpha::opaque;
    float cutoff = 0.5f; // of a mask: below it nothing is drawn
};

struct PaintedVertex {
    glm::vec2 place { 0.0f }; // in the texture of its part
    glm::vec4 colour { 1.0f };
};

struct Painting {
    std::vector<PaintedVertex> vertices; // one for each of the asset
    std::vector<std::uint32_t> indices;  // triangles, part by part
    std::vector<PaintedPart> parts;
    std::vector<Texture> textures;
    std::vector<Image> images;
};

// Nothing if the asset has no such chunk, or one without materials and colours. Throws Error (exit code 3) for a damaged one.
std::optional<Painting> painting_of(const AssetFile& file);

} // namespace pliant::player
