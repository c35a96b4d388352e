// A glTF 2.0 file in memory: its JSON, and the bytes of its buffers.
#pragma once

#include "input/gltf/meshopt.h"
#include "input/gltf/value.h"

#include <deque>
#include <filesystem>
#include <map>
#include <string_view>

namespace pliant {

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
    GltfValue root() const { return { path_, json_ }; }
    GltfValue operator[](const char* key) const { return root()[key]; }

    // Bytes of a buffer view, which lies inside its buffer or is unpacked at its first use (EXT_meshopt_compression: P2331).
    // P2306 to P2308. Not from several threads.
    std::string_view view(std::size_t index) const;
    // Of the floats in that view, if they are stored with exponents; else empty.
    const std::vector<std::int8_t>& exponents(std::size_t index) const;
    // Bytes of an image, wherever they are; empty if it cannot be had (then `why` says so).
    std::string image(std::size_t index, std::string& why) const;
    // The same for images of the same bytes: a buffer view or the place of a file. Empty for others.
    std::string image_source(std::size_t index) const;
    // Notes an image that is not read, since one of the same source was, for stamps (read_log.h).
    void note_image(std::size_t index) const;
    // The files that it names for buffers and images, as paths; whether they are there is not asked.
    std::vector<std::string> named_files() const;
    // Of the file and of those that it names for buffers, each once.
    std::size_t byte_count() const { return byte_count_; }

private:
    void read(std::string bytes);
    void read_container(std::string bytes);
    void parse(std::string_view text);
    void check_extensions() const;
    void read_buffers();
    bool is_placeholder(const GltfValue& buffer, bool needs_meshopt) const;
    std::string_view read_buffer(const GltfValue& buffer);
    // A file that it names: how it is opened, and where the links of that name lead.
    struct FileBeside {
        std::string path, place;
    };
    // Of a URI; looked up once.
    const FileBeside& file_beside(const GltfValue& uri_value, const std::string& uri) const;
    // Where the links of an absolute path lead, empty if it cannot be looked up. Folders are looked up once.
    const std::filesystem::path& place_of_folder(const std::filesystem::path& folder) const;
    std::filesystem::path place_of(const std::filesystem::path& file) const;
    std::string read_beside(const GltfValue& uri_value, const std::string& uri) const;
    // Null for views that are not compressed.
    const UnpackedView* unpacked(std::size_t index) const;

    std::string path_;
    GltfJson json_;
    std::string binary_; // the BIN chunk of a .glb
    bool has_binary_ = false, is_alone_ = false;
    std::map<std::string, std::string> files_;                     // by place: many buffers may name one file
    mutable std::map<std::string, FileBeside> beside_;             // by URI
    mutable std::map<std::string, std::filesystem::path> folders_; // where their links lead
    std::deque<std::string> decoded_;                              // buffers in the JSON itself
    std::vector<std::string_view> buffers_;                        // of binary_, files_, decoded_
    mutable std::map<std::size_t, UnpackedView> unpacked_;         // views at their first use, by number
    mutable std::uint64_t unpacked_left_ = 0;                      // bytes that other views may have
    std::size_t byte_count_ = 0;
};

// True for names of files that are read as glTF: *.glb, *.gltf and *.vrm (a .glb by another name) in any case.
bool is_gltf_name(std::string_view path);

} // namespace pliant
