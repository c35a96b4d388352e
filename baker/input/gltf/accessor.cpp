#include "input/gltf/accessor.h"

#include "input/io/source_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace pliant {
namespace {

// Bytes of a component; 0 for what glTF does not have.
std::size_t size_of(unsigned component_type)
{
    switch (component_type) {
    case gltf_int8:
    case gltf_uint8: return 1;
    case gltf_int16:
    case gltf_uint16: return 2;
    case gltf_uint32:
    case gltf_float32: return 4;
    default: return 0;
    }
}

int components_of(const std::string& type)
{
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4" || type == "MAT2") return 4;
    if (type == "MAT3") return 9;
    return type == "MAT4" ? 16 : 0;
}

template <class T> T value_at(const char* bytes)
{
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

// glTF 2.0, section 3.11: what a normalized integer stands for.
double number_at(const char* bytes, unsigned component_type, bool is_normalised)
{
    switch (component_type) {
    case gltf_int8:
        return is_normalised ? std::max(value_at<std::int8_t>(bytes) / 127.0, -1.0) : value_at<std::int8_t>(bytes);
    case gltf_uint8: return value_at<std::uint8_t>(bytes) / (is_normalised ? 255.0 : 1.0);
    case gltf_int16:
        return is_normalised ? std::max(value_at<std::int16_t>(bytes) / 32767.0, -1.0) : value_at<std::int16_t>(bytes);
    case gltf_uint16: return value_at<std::uint16_t>(bytes) / (is_normalised ? 65535.0 : 1.0);
    case gltf_uint32: return value_at<std::uint32_t>(bytes);
    default: return value_at<float>(bytes);
    }
}

// Elements that lie in a buffer view, every one inside it.
struct Elements {
    const char* bytes = nullptr;
    std::size_t stride = 0;
    const char* at(std::uint64_t i) const { return bytes + i * stride; }
};

// `holder` has bufferView and byteOffset. Sizes are compared by division, so that no product can overflow.
Elements elements_of(const GltfDocument& document, const GltfValue& holder, std::uint64_t count, std::size_t size)
{
    const GltfValue views = document["bufferViews"];
    const std::size_t index = holder["bufferView"].index(views.size(), "buffer views");
    const std::string_view bytes = document.view(index);
    const std::uint64_t offset = holder["byteOffset"].whole_or(0);
    const std::uint64_t stride = views.at(index)["byteStride"].whole_or(size);
    if (stride < size || stride > 4096)
        views.at(index)["byteStride"].fail(2308, fmt::format("is {}, its elements take {} bytes", stride, size));
    const bool fits = count == 0
        || (offset <= bytes.size() && size <= bytes.size() - offset && count - 1 <= (bytes.size() - offset - size) / stride);
    if (!fits)
        holder.fail(2308,
                    fmt::format("{} elements of {} bytes from byte {} do not lie inside its buffer view of {}", count, size,
                                offset, bytes.size()),
                    "the file is cut off or damaged: export or copy it again");
    return { bytes.data() + (count == 0 ? 0 : offset), static_cast<std::size_t>(stride) };
}

GltfValue accessor_of(const GltfDocument& document, const GltfValue& reference)
{
    const GltfValue accessors = document["accessors"];
    return accessors.at(reference.index(accessors.size(), "accessors"));
}

// Elements that replace those of the dense part.
void read_sparse(const GltfDocument& document, const GltfValue& accessor, const AccessorShape& shape, GltfNumbers& numbers)
{
    const GltfValue sparse = accessor["sparse"], indices = sparse["indices"], values = sparse["values"];
    const std::uint64_t count = sparse["count"].whole();
    if (count > shape.count)
        sparse.fail(2308, fmt::format("replaces {} elements of an accessor with {}", count, shape.count));
    const unsigned index_type = static_cast<unsigned>(indices["componentType"].whole());
    if (index_type != gltf_uint8 && index_type != gltf_uint16 && index_type != gltf_uint32)
        indices.fail(2311, fmt::format("component type {} cannot hold indices", index_type));
    const std::size_t component_size = size_of(shape.component_type);
    const Elements places = elements_of(document, indices, count, size_of(index_type));
    const Elements data = elements_of(document, values, count, component_size * static_cast<std::size_t>(shape.components));
    for (std::uint64_t i = 0; i < count; ++i) {
        const double place = number_at(places.at(i), index_type, false);
        if (place >= static_cast<double>(shape.count))
            indices.fail(2308, fmt::format("element {} of an accessor with {}", place, shape.count));
        for (int c = 0; c < shape.components; ++c)
            numbers(static_cast<Eigen::Index>(place), c) = number_at(
                data.at(i) + static_cast<std::size_t>(c) * component_size, shape.component_type, shape.is_normalised);
    }
}

GltfNumbers read_all(const GltfDocument& document, const GltfValue& accessor, const AccessorShape& shape)
{
    GltfNumbers numbers = GltfNumbers::Zero(static_cast<Eigen::Index>(shape.count), shape.components);
    const std::size_t component_size = size_of(shape.component_type);
    if (shape.has_view) {
        // Columns of matrices of bytes and of 3x3 shorts start at multiples of four; the only matrices read here are of
        // floats.
        const Elements elements
            = elements_of(document, accessor, shape.count, component_size * static_cast<std::size_t>(shape.components));
        for (Eigen::Index i = 0; i < numbers.rows(); ++i) {
            const char* element = elements.at(static_cast<std::uint64_t>(i));
            for (int c = 0; c < shape.components; ++c)
                numbers(i, c) = number_at(element + static_cast<std::size_t>(c) * component_size, shape.component_type,
                                          shape.is_normalised);
        }
    }
    if (accessor["sparse"].exists()) read_sparse(document, accessor, shape, numbers);
    return numbers;
}

// The largest power of two that a number of the accessor is stored with; 0 if there is none.
double largest_power(const GltfDocument& document, const GltfValue& accessor, const AccessorShape& shape)
{
    const std::size_t view = accessor["bufferView"].index(document["bufferViews"].size(), "buffer views");
    const std::vector<std::int8_t>& exponents = document.exponents(view);
    if (exponents.empty()) return 0;
    const char* begin = document.view(view).data();
    const std::size_t size = sizeof(float), width = static_cast<std::size_t>(shape.components);
    const Elements elements = elements_of(document, accessor, shape.count, size * width);
    int largest = std::numeric_limits<int>::min();
    for (std::uint64_t i = 0; i < shape.count; ++i)
        for (std::size_t c = 0; c < width; ++c) {
            const char* at = elements.at(i) + size * c;
            if (value_at<float>(at) != 0) largest = std::max<int>(largest, exponents[std::size_t(at - begin) / size]);
        }
    return std::exp2(largest);
}

void check_components(const GltfValue& reference, const AccessorShape& shape, std::initializer_list<int> components)
{
    if (std::find(components.begin(), components.end(), shape.components) == components.end())
        reference.fail(2311, fmt::format("has elements of {} numbers, which does not fit here", shape.components));
    if (shape.components > 4 && shape.component_type != gltf_float32) reference.fail(2311, "matrices must be of floats");
}

} // namespace

AccessorShape accessor_shape(const GltfDocument& document, const GltfValue& reference)
{
    const GltfValue accessor = accessor_of(document, reference);
    AccessorShape shape;
    shape.count = accessor["count"].whole();
    const std::string type = accessor["type"].text();
    shape.components = components_of(type);
    shape.component_type = static_cast<unsigned>(std::min<std::uint64_t>(accessor["componentType"].whole(), 0xffff));
    if (shape.components == 0) accessor.fail(2311, fmt::format("is of the unknown type {}", excerpt(type)));
    if (size_of(shape.component_type) == 0)
        accessor.fail(2311, fmt::format("is of the unknown component type {}", shape.component_type));
    shape.is_normalised = accessor["normalized"].reference_or(false);
    shape.has_view = accessor["bufferView"].exists();
    return shape;
}

double step_of(const GltfDocument& document, const GltfValue& reference)
{
    const AccessorShape shape = accessor_shape(document, reference);
    if (shape.component_type == gltf_float32)
        return shape.has_view ? largest_power(document, accessor_of(document, reference), shape) : 0;
    if (!shape.is_normalised) return 1;
    switch (shape.component_type) {
    case gltf_int8: return 1.0 / 127;
    case gltf_uint8: return 1.0 / 255;
    case gltf_int16: return 1.0 / 32767;
    case gltf_uint16: return 1.0 / 65535;
    default: return 1;
    }
}

GltfAllowance::GltfAllowance(const GltfDocument& document, std::uint64_t free_count, std::uint64_t per_byte)
    : document_(document)
    , limit_(free_count + per_byte * document.byte_count())
    , left_(limit_)
{
}

void GltfAllowance::take(const GltfValue& place, std::uint64_t count, std::uint64_t width)
{
    if (count > left_ / width)
        place.fail(
            2333,
            fmt::format("with its {} x {} numbers more than {} are read, the limit for a file of {} bytes", count, width,
                        limit_, document_.byte_count()),
            "simplify the mesh, store it without Draco's compression, or let fewer nodes, primitives, targets, skins and "
            "channels share data");
    left_ -= count * width;
}

void GltfAllowance::take_all_of(const GltfValue& reference)
{
    constexpr std::uint64_t numbers_of_use = 64; // what finding an accessor costs
    const AccessorShape shape = accessor_shape(document_, reference);
    take(reference, shape.count, static_cast<std::uint64_t>(shape.components));
    take(reference, numbers_of_use);
}

bool GltfAllowance::has_own(std::uint64_t size)
{
    const std::uint64_t left = document_.byte_count() - stream_bytes_;
    if (size > left) return false;
    stream_bytes_ += size;
    return true;
}

GltfNumbers read_numbers(const GltfDocument& document, const GltfValue& reference, std::initializer_list<int> components,
                         std::uint64_t count)
{
    const AccessorShape shape = accessor_shape(document, reference);
    check_components(reference, shape, components);
    if (shape.count != count)
        reference.fail(
            2317, fmt::format("has {} elements, {} expected", shape.count, count),
            "all attributes and morph targets of a mesh need one element per vertex (of a Draco mesh: per decoded "
            "vertex): export the file again");
    return read_all(document, accessor_of(document, reference), shape);
}

GltfNumbers read_numbers(const GltfDocument& document, const GltfValue& reference, std::initializer_list<int> components)
{
    const AccessorShape shape = accessor_shape(document, reference);
    check_components(reference, shape, components);
    const GltfValue accessor = accessor_of(document, reference);
    // Before memory is taken: the bytes must be there. Zeros take none, but whatever uses them takes a byte for each number.
    if (shape.has_view) {
        elements_of(document, accessor, shape.count,
                    size_of(shape.component_type) * static_cast<std::size_t>(shape.components));
    } else if (shape.count > document.byte_count() / static_cast<std::size_t>(shape.components)) {
        accessor["bufferView"].fail(2308, "is missing, for more numbers than the file has bytes", "export the file again");
    }
    return read_all(document, accessor, shape);
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document, const GltfValue& reference, int components)
{
    const AccessorShape shape = accessor_shape(document, reference);
    if (shape.component_type != gltf_uint8 && shape.component_type != gltf_uint16 && shape.component_type != gltf_uint32)
        reference.fail(2311, fmt::format("component type {} cannot hold indices", shape.component_type));
    const GltfNumbers numbers = read_numbers(document, reference, { components });
    std::vector<std::uint32_t> indices(static_cast<std::size_t>(numbers.size()));
    // A uint32 fits into a double; normalized ones are nonsense here and come out as 0 or 1.
    for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = static_cast<std::uint32_t>(numbers.data()[i]);
    return indices;
}

} // namespace pliant
