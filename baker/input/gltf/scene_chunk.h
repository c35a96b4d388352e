// The scene chunk of an asset (formats/SPEC.md, GLTF): what is drawn with the vertices, as binary glTF without positions.
#pragma once

#include "base/common/diagnostics.h"
#include "input/gltf/render_scene.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

// The bytes of the chunk; the same scene gives the same bytes. Throws Failure (bad_input, P2330) if they would be 4 GiB or
// more.
std::vector<std::uint8_t> encode_scene_chunk(const RenderScene& scene);

// The way back. `path` is for messages. Normals come back within 3e-5 of what they were, all else as it was. Hostile bytes
// are refused as those of any glTF file, and more vertices than `vertex_limit`: throws Failure (bad_input): P2301 to P2317.
RenderScene decode_scene_chunk(std::string_view bytes, const std::string& path, std::size_t vertex_limit);

} // namespace pliant
