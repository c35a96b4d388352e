// A glTF 2.0 file in memory: its JSON, and the bytes of its buffers. Every look into the JSON is checked and every error
// names the place.
#pragma once

#include "base/common/diagnostics.h"

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
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

    // A member of an object; absent if this is. P2306 if this is no object.
    GltfValue operator[](const char* key) const;
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

class GltfDocument {
public:
    // Reads .glb or .gltf, whatever the extension says. Files that it names must lie in its folder or below; nothing else is
    // opened, no program started, no network used. Throws Failure (bad_input): P2001, P2002, P2008 (the file itself), P2301
    // to P2305 (container, JSON, version, extensions), P2306 to P2310 (buffers). Memory: a few times the size of the files.
    explicit GltfDocument(std::string path);
    // The same from bytes; `path` is for messages, and no other file is opened (P2309).
    GltfDocument(std::string path, std::string bytes);
    GltfDocument(const GltfDocument&) = delete;
    GltfDocument& operator=(const GltfDocument&) = delete;

    const std::string& path() const { return path_; }
    GltfValue root() const { return { path_, &json_, "" }; }
    GltfValue operator[](const char* key) const { return root()[key]; }

    // Bytes of a buffer view, which lies inside its buffer. P2307, P2308.
    std::string_view view(std::size_t index) const;
    // Bytes of an image, wherever they are; empty if it cannot be had (then `why` says so).
    std::string image(std::size_t index, std::string& why) const;
    // The files that it names for buffers and images, as paths; whether they are there is not asked.
    std::vector<std::string> named_files() const;
    // Of the file and all its buffers.
    std::size_t byte_count() const { return byte_count_; }

private:
    void read(std::string bytes);
    void read_container(std::string bytes);
    void parse(std::string_view text);
    void check_extensions() const;
    void read_buffers();
    std::string read_buffer(const GltfValue& buffer, std::size_t length) const;
    std::string read_beside(const GltfValue& uri_value, const std::string& uri) const;

    std::string path_;
    GltfJson json_;
    std::string binary_; // the BIN chunk of a .glb
    bool has_binary_ = false, is_alone_ = false;
    std::vector<std::string> buffers_;
    std::size_t byte_count_ = 0;
};

// True for names of files that are read as glTF: *.glb and *.gltf in any case.
bool is_gltf_name(std::string_view path);

} // namespace pliant
