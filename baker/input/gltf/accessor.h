// Numbers of a glTF file: accessors, dense and sparse, of every component type.
#pragma once

#include "input/gltf/document.h"

#include <Eigen/Core>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace pliant {

// count x components, one row per element.
using GltfNumbers = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

enum GltfComponentType : unsigned {
    gltf_int8 = 5120,
    gltf_uint8 = 5121,
    gltf_int16 = 5122,
    gltf_uint16 = 5123,
    gltf_uint32 = 5125,
    gltf_float32 = 5126
};

// What an accessor says about itself, checked for sense but not yet against its bytes.
struct AccessorShape {
    std::uint64_t count = 0;
    int components = 0;          // of an element: 1 to 4, 9 or 16 (matrices)
    unsigned component_type = 0; // a GltfComponentType
    bool is_normalised = false;
    bool has_view = false;
};

// `reference` is the value that names the accessor, as primitive["indices"]; errors are told there. P2306, P2307, P2311.
AccessorShape accessor_shape(const GltfDocument& document, const GltfValue& reference);

// Of the grid that the numbers were rounded to: the distance of two integers in a row, as what they stand for; the largest
// power of two of floats that EXT_meshopt_compression stores with exponents; 0 for other floats. Throws what read_numbers()
// throws.
double step_of(const GltfDocument& document, const GltfValue& reference);

// How many numbers may be read of a file for one purpose. Primitives, skins and channels may share accessors, and accessors
// may share bytes: without a limit a small file takes hours and gigabytes.
class GltfAllowance {
public:
    // Some for any file, and more for each byte of this one, with its buffers.
    explicit GltfAllowance(const GltfDocument& document, std::uint64_t free_count = 10000000, std::uint64_t per_byte = 32);

    // P2333, told at `place`, if `count` elements of `width` numbers are too many.
    void take(const GltfValue& place, std::uint64_t count, std::uint64_t width = 1);
    // The same for all elements of the accessor that `reference` names, and for its use.
    void take_all_of(const GltfValue& reference);
    // Whether compressed streams, with one more of so many bytes, still fit into the file beside each other.
    bool has_own(std::uint64_t size);

private:
    const GltfDocument& document_;
    std::uint64_t limit_, left_, stream_bytes_ = 0;
};

// The elements as doubles; normalized integers as what they stand for. Without a buffer view they are zero, apart from
// sparse ones.
// `components`: those allowed, else P2311. `count`: how many there must be, else P2317; an accessor without bytes cannot
// make the reader take memory for more. P2308: bytes outside of the view; all of P2306 and P2307.
GltfNumbers read_numbers(const GltfDocument& document, const GltfValue& reference, std::initializer_list<int> components,
                         std::uint64_t count);
// The same where any count is right. P2308 for more zeros without a buffer view than the file has bytes.
GltfNumbers read_numbers(const GltfDocument& document, const GltfValue& reference, std::initializer_list<int> components);

// Unsigned integers (indices of vertices or joints), as they are.
std::vector<std::uint32_t> read_indices(const GltfDocument& document, const GltfValue& reference, int components);

} // namespace pliant
