// glTF files as tinygltf (MIT) reads them, for tests that compare them with ours. Debian's library has no Draco; the header
// has it. So one source of an executable defines TINYGLTF_IMPLEMENTATION before it includes this.
#pragma once

#define TINYGLTF_ENABLE_DRACO
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <doctest/doctest.h>
#include <limits>
#include <nlohmann/json.hpp> // before tiny_gltf.h, which would hide its symbols
#include <numeric>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace pliant_test {

// Images stay as the file encodes them, so that their bytes can be compared.
inline bool keep_encoded(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                         int size, void*)
{
    image->image.assign(bytes, bytes + size);
    return true;
}

// Calls read(loader, model, error, warning), which must succeed without a message.
template <class Read> tinygltf::Model load_with(Read&& read)
{
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(keep_encoded, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const bool is_read = read(loader, model, error, warning);
    CHECK_MESSAGE(is_read, error);
    CHECK(error == "");
    CHECK(warning == "");
    return model;
}

inline tinygltf::Model load_glb(const std::string& bytes)
{
    return load_with([&](tinygltf::TinyGLTF& loader, tinygltf::Model& model, std::string& error, std::string& warning) {
        const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
        return loader.LoadBinaryFromMemory(&model, &error, &warning, data, unsigned(bytes.size()));
    });
}

// A .glb, or a .gltf with the files that it names.
inline tinygltf::Model load_file(const std::string& path)
{
    return load_with([&](tinygltf::TinyGLTF& loader, tinygltf::Model& model, std::string& error, std::string& warning) {
        return path.back() == 'b' ? loader.LoadBinaryFromFile(&model, &error, &warning, path)
                                  : loader.LoadASCIIFromFile(&model, &error, &warning, path);
    });
}

template <class T> double number_as(const unsigned char* at, bool is_normalised)
{
    T value;
    std::memcpy(&value, at, sizeof value);
    return is_normalised ? std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0) : double(value);
}

inline double number_at(const unsigned char* at, int component_type, bool is_normalised)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return number_as<std::int8_t>(at, is_normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return number_as<std::uint8_t>(at, is_normalised);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return number_as<std::int16_t>(at, is_normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return number_as<std::uint16_t>(at, is_normalised);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return number_as<std::uint32_t>(at, false);
    default: return number_as<float>(at, false);
    }
}

// Elements of an accessor, `width` numbers each. No Eigen: its templates would take as long to compile as tinygltf.
struct Numbers {
    std::size_t width = 0;
    std::vector<double> values;

    std::size_t count() const { return values.size() / width; }
};

// Elements that are `stride` bytes apart (0: without gaps).
inline Numbers numbers_in_view(const tinygltf::Model& model, int view_number, std::size_t offset, std::size_t stride,
                               const tinygltf::Accessor& like, std::size_t count)
{
    const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(view_number));
    const std::vector<unsigned char>& bytes = model.buffers.at(std::size_t(view.buffer)).data;
    const int width = tinygltf::GetNumComponentsInType(std::uint32_t(like.type)),
              size = tinygltf::GetComponentSizeInBytes(std::uint32_t(like.componentType));
    REQUIRE(width * size > 0);
    if (stride == 0) stride = std::size_t(width * size);
    const std::size_t begin = view.byteOffset + offset;
    const bool is_inside = count == 0 || begin + (count - 1) * stride + std::size_t(width * size) <= bytes.size();
    REQUIRE(is_inside);
    Numbers numbers { std::size_t(width), {} };
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < width; ++c)
            numbers.values.push_back(
                number_at(bytes.data() + begin + i * stride + c * size, like.componentType, like.normalized));
    return numbers;
}

// The elements that a sparse accessor replaces.
inline void replace_sparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, Numbers& numbers)
{
    tinygltf::Accessor index;
    index.type = TINYGLTF_TYPE_SCALAR;
    index.componentType = accessor.sparse.indices.componentType;
    const auto count = std::size_t(accessor.sparse.count);
    const auto& indices = accessor.sparse.indices;
    const auto& values = accessor.sparse.values;
    const Numbers places = numbers_in_view(model, indices.bufferView, std::size_t(indices.byteOffset), 0, index, count),
                  others = numbers_in_view(model, values.bufferView, std::size_t(values.byteOffset), 0, accessor, count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t c = 0; c < numbers.width; ++c)
            numbers.values.at(std::size_t(places.values[i]) * numbers.width + c) = others.values[i * numbers.width + c];
}

// Normalised integers as what they stand for; what has no bytes is 0.
inline Numbers numbers_of(const tinygltf::Model& model, int number)
{
    const tinygltf::Accessor& accessor = model.accessors.at(std::size_t(number));
    Numbers numbers { std::size_t(tinygltf::GetNumComponentsInType(std::uint32_t(accessor.type))), {} };
    if (accessor.bufferView >= 0) {
        const int stride = accessor.ByteStride(model.bufferViews.at(std::size_t(accessor.bufferView)));
        REQUIRE(stride > 0);
        numbers = numbers_in_view(model, accessor.bufferView, accessor.byteOffset, std::size_t(stride), accessor,
                                  accessor.count);
    }
    numbers.values.resize(numbers.width * accessor.count);
    if (accessor.sparse.isSparse) replace_sparse(model, accessor, numbers);
    return numbers;
}

// The corners of a primitive's triangles, three a triangle.
inline std::vector<std::uint32_t> corners_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive)
{
    REQUIRE(primitive.mode == TINYGLTF_MODE_TRIANGLES);
    if (primitive.indices >= 0) {
        const Numbers numbers = numbers_of(model, primitive.indices);
        return { numbers.values.begin(), numbers.values.end() };
    }
    std::vector<std::uint32_t> corners(model.accessors.at(std::size_t(primitive.attributes.at("POSITION"))).count);
    std::iota(corners.begin(), corners.end(), 0u);
    return corners;
}

// The largest difference of two lists; infinite if one is longer or a number is not finite.
template <class List, class Other> double difference(const List& list, const Other& other)
{
    double largest = list.size() == other.size() ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min(list.size(), other.size()); ++i) {
        const double off = std::abs(double(list[i]) - double(other[i]));
        largest = std::isfinite(off) ? std::max(largest, off) : std::numeric_limits<double>::infinity();
    }
    return largest;
}

// The sides of the bounding box of points.
inline std::array<double, 3> sides_of(const std::vector<double>& points)
{
    std::array<double, 3> sides {};
    for (std::size_t c = 0; c < 3; ++c) {
        double low = points.at(c), high = low;
        for (std::size_t i = c; i < points.size(); i += 3) low = std::min(low, points[i]), high = std::max(high, points[i]);
        sides[c] = high - low;
    }
    return sides;
}

} // namespace pliant_test
