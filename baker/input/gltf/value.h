// The JSON of a glTF file. Every look into it is checked and every error names the place.
#pragma once

#include "base/common/diagnostics.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pliant {

using GltfJson = nlohmann::json;

// A value of the JSON. May be absent. Cheap to copy; the document must outlive it. All errors are Failure (bad_input): P2306
// (another type than expected), P2307 (an index out of range).
class GltfValue {
public:
    GltfValue(const std::string& file, const GltfJson& root)
        : file_(&file)
        , json_(&root)
    {
    }

    bool exists() const { return missing_.empty(); }
    const GltfJson& json() const { return *json_; } // of a value that exists
    std::string place() const;                      // as "meshes[0].primitives[1].indices"
    bool operator==(const GltfValue& other) const { return json_ == other.json_ && missing_ == other.missing_; }

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
    // An element, or a member if there is a key, which is that of the document.
    struct Step {
        const std::string* key;
        std::size_t index;
    };

    GltfValue step(const GltfJson& to, Step step) const;
    GltfValue absent(const std::string& step) const;
    [[noreturn]] void expect(const char* what) const;

    // Text of a place is made for messages only, which are rare. Only extensions that we do not know are deeper.
    static constexpr std::size_t longest_way = 16;

    const std::string* file_;
    const GltfJson* json_; // of an absent value the last one on the way to it that exists
    std::array<Step, longest_way> way_ {};
    std::size_t step_count_ = 0;
    bool is_cut_ = false; // steps before the last one are missing
    std::string missing_; // the rest of the way to an absent value: ".key[2]"
};

} // namespace pliant
