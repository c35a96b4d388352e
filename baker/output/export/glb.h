// A GLB (binary glTF 2.0) put together in memory: one buffer, views, accessors, and the JSON that the caller fills in.
#pragma once

#include "input/gltf/accessor.h"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace pliant {

class Glb {
public:
    using Json = nlohmann::ordered_json;

    // What a view holds, as glTF names it.
    enum class Target { none = 0, vertices = 34962, indices = 34963 };

    // Starts with the asset, generator and buffer entries. `leading` (may be empty) becomes view 0, the first bytes of the
    // binary chunk. `with_compression`: the views of accessors are stored by EXT_meshopt_compression, which readers must
    // know.
    explicit Glb(std::string_view leading = {}, bool with_compression = false);

    // Appends bytes as a view and returns its index; the view starts at a multiple of 4.
    std::size_t add_view(std::string_view bytes, Target target = Target::none);

    // A view of these bytes where the leading view has them, behind those of the calls before; else as add_view.
    std::size_t add_shared_view(std::string_view bytes);

    // Appends vectors of `width` floats (1: SCALAR, 2: VEC2, 3: VEC3, 4: VEC4, 16: MAT4) as a view with an accessor; its
    // index. `with_bounds` writes min and max, exact for the floats.
    std::size_t add_floats(const std::vector<float>& values, int width, Target target, bool with_bounds = false);

    // The same for attributes of vertices as integers (KHR_mesh_quantization): gltf_int8 or gltf_int16, which must hold the
    // values. Elements start at multiples of 4.
    std::size_t add_integers(const std::vector<std::int16_t>& values, int width, GltfComponentType component,
                             bool is_normalised, bool with_bounds);

    // Triangles' corners, in 16 bits where vertex_count allows it.
    std::size_t add_indices(const std::vector<std::uint32_t>& indices, std::size_t vertex_count);

    // Four bone numbers a vertex (JOINTS_0), in 8 or 16 bits.
    std::size_t add_joints(const std::vector<std::uint16_t>& joints);

    Json& json() { return json_; }

    // The file. The binary chunk starts at a multiple of 4096, so that an asset in front of it lies as in a file of its own.
    // Throws Failure (failed, P5201) above 4 GiB, which the format cannot count.
    std::string bytes() const;

    // Lists an extension as used, and as required if readers must know it. Listing it twice has no effect.
    void use_extension(const std::string& name, bool is_required);

private:
    std::size_t append(std::string_view bytes);
    std::size_t add_elements(std::string_view bytes, std::size_t stride, Target target);
    std::size_t add_accessor(std::size_t view, int component, std::size_t count, const char* type);
    template <class T> void bound(std::size_t accessor, const std::vector<T>& values, int width);

    Json json_;
    std::string binary_;
    std::set<std::string> used_extensions_, required_extensions_;
    std::size_t leading_size_, searched_size_ = 0; // of the leading view; what no shared view is looked for in any more
    std::size_t unpacked_size_ = 0;                // of the buffer that readers unpack views into
    bool with_compression_;
};

// What does not fit a GLB's 32-bit counts. Throws Failure (failed, P5201).
void check_glb_size(std::uint64_t size);

} // namespace pliant
