// The JSON of a glTF file. Every look into it is checked and every error names the place.
#pragma once

#include "base/common/diagnostics.h"

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant {

using GltfJson = nlohmann::json;

// A value of the JSON and its place, as "meshes[0].primitives[1].indices". May be absent. Cheap to copy; the document must
// outlive it. All errors are Failure (bad_input): P2306 (another type than expected), P2307 (an index out of range).
class GltfValue {
public:
    GltfValue(const std::string& file, const GltfJson* json, std::string place)
        : file_(&file)
        , json_(json)
        , place_(std::move(place))
    {
    }

    bool exists() const { return json_ != nullptr; }
    const GltfJson& json() const { return *json_; } // of a value that exists
    const std::string& place() const { return place_; }

    // A member of an object, whose key may hold zeros; absent if this is. P2306 if this is no object.
    GltfValue operator[](const std::string& key) const;
    // Elements of an array; none if this is absent. P2306 if this is no array.
    std::size_t size() const;
    GltfValue at(std::size_t i) const;

    // A whole number from 0 to 2^53. Without a default the value must exist.
    std::uint64_t whole() const;
    std::uint64_t whole_or(std::uint64_t missing) const { return exists() ? whole() : missing; }
    // A whole number below `count`, for which `things` is the word; P2307 for others.
    std::size_t index(std::size_t count, const char* things) const;
    std::ptrdiff_t index_or_none(std::size_t count, const char* things) const; // -1: absent
    double number() const;                                                     // finite
    std::vector<double> numbers(std::size_t count) const;                      // exactly so many
    std::string text() const;
    std::string text_or(const char* missing) const { return exists() ? text() : missing; }
    bool reference_or(bool missing) const;

    [[noreturn]] void fail(int number, const std::string& what, const std::string& hint = {}) const;

private:
    [[noreturn]] void expect(const char* what) const;

    const std::string* file_;
    const GltfJson* json_;
    std::string place_;
};

} // namespace pliant
