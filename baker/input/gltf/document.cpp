#include "input/gltf/document.h"

#include "base/common/foreign_json.h"
#include "input/gltf/uri.h"
#include "input/io/read_log.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

// Real files nest to about ten; what follows may go down once per level.
constexpr int nesting_limit = 64;

constexpr std::size_t json_size_limit = std::size_t(1) << 29;

// Of the parsed JSON: real files take about twelve times their text, empty objects forty times.
constexpr std::size_t json_memory_ratio = 16, json_memory_floor = std::size_t(1) << 26;

// A mesh at the limits of the asset format has fewer.
constexpr std::uint64_t buffer_size_limit = std::uint64_t(1) << 32;

// What changes the meaning of the geometry and is understood, and what only says how to paint it.
constexpr std::array<std::string_view, 5> known_extensions
    = { "KHR_draco_mesh_compression", "KHR_mesh_quantization", meshopt_extension, "KHR_texture_transform",
        "KHR_lights_punctual" };
constexpr std::array<std::string_view, 5> ignored_prefixes
    = { "KHR_materials_", "KHR_texture_basisu", "EXT_texture_", "MSFT_texture_dds", "ADOBE_materials_" };

bool is_known(const std::string& extension)
{
    if (std::find(known_extensions.begin(), known_extensions.end(), extension) != known_extensions.end()) return true;
    return std::any_of(ignored_prefixes.begin(), ignored_prefixes.end(),
                       [&](std::string_view prefix) { return extension.compare(0, prefix.size(), prefix) == 0; });
}

std::uint32_t u32_at(std::string_view bytes, std::size_t offset)
{
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
    return value;
}

} // namespace

bool is_gltf_name(std::string_view path)
{
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos) return false;
    std::string extension(path.substr(dot));
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return extension == ".glb" || extension == ".gltf" || extension == ".vrm";
}

GltfDocument::GltfDocument(std::string path)
    : path_(std::move(path))
{
    DiagnosticList diagnostics;
    std::optional<std::string> bytes = read_bytes(path_, diagnostics);
    if (!bytes) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    read(std::move(*bytes));
}

GltfDocument::GltfDocument(std::string path, std::string bytes)
    : path_(std::move(path))
    , is_alone_(true)
{
    read(std::move(bytes));
}

void GltfDocument::read(std::string bytes)
{
    byte_count_ = bytes.size();
    if (bytes.empty())
        throw Failure(ExitCode::bad_input, error_at(2005, path_, "is empty: has no vertices", "export the file again"));
    read_container(std::move(bytes));
    check_extensions();
    read_buffers();
    unpacked_left_ = std::min<std::uint64_t>(buffer_size_limit, meshopt_bytes_a_byte * byte_count_);
}

void GltfDocument::read_container(std::string bytes)
{
    if (bytes.compare(0, 3, "\xef\xbb\xbf") == 0) bytes.erase(0, 3);
    if (bytes.compare(0, 4, "glTF") != 0) {
        const std::size_t start = bytes.find_first_not_of(" \t\r\n");
        if (start == std::string::npos || bytes[start] != '{')
            root().fail(2301, "is not glTF: neither binary glTF nor JSON", "export it as glTF 2.0 (.glb or .gltf)");
        return parse(bytes);
    }
    constexpr const char* cut_off = "the file is cut off or damaged: export or copy it again";
    const auto broken = [&](const std::string& what) { root().fail(2301, "binary glTF: " + what, cut_off); };
    if (bytes.size() < 20) broken(fmt::format("ends at byte {} inside the header", bytes.size()));
    if (const std::uint32_t version = u32_at(bytes, 4); version != 2)
        root().fail(2304, fmt::format("is glTF {}, only 2.0 is read", version), "export it as glTF 2.0");
    if (u32_at(bytes, 8) > bytes.size())
        broken(fmt::format("has {} bytes, its header says {}", bytes.size(), u32_at(bytes, 8)));
    constexpr std::uint32_t json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;
    const std::size_t json_size = u32_at(bytes, 12), end = u32_at(bytes, 8);
    if (u32_at(bytes, 16) != json_chunk) broken("its first part is not JSON");
    if (end < 20 || json_size > end - 20)
        broken(fmt::format("its JSON of {} bytes does not end inside the file", json_size));
    const std::size_t rest = 20 + json_size;
    if (end - rest >= 8 && u32_at(bytes, rest + 4) == binary_chunk) {
        const std::size_t size = u32_at(bytes, rest);
        if (size > end - rest - 8) broken(fmt::format("its binary part of {} bytes does not end inside the file", size));
        binary_ = bytes.substr(rest + 8, size);
        has_binary_ = true;
    }
    parse(std::string_view(bytes).substr(20, json_size));
}

void GltfDocument::parse(std::string_view text)
{
    if (text.size() > json_size_limit)
        root().fail(2008, fmt::format("has {} bytes of JSON, the limit is {}", text.size(), json_size_limit),
                    "store the buffers in a separate file, or use .glb");
    const JsonShape shape = json_shape(text);
    if (shape.nesting > nesting_limit)
        root().fail(2303, fmt::format("its JSON is nested {} deep, the limit is {}", shape.nesting, nesting_limit),
                    "no known exporter writes such files");
    if (shape.memory > json_memory_floor && shape.memory / json_memory_ratio > text.size())
        root().fail(2332,
                    fmt::format("its {} bytes of JSON would take {} MiB of memory, the limit is {} times the text",
                                text.size(), shape.memory >> 20, json_memory_ratio),
                    "leave out extras, or export it again: no known exporter writes such files");
    try {
        json_ = GltfJson::parse(text.begin(), text.end());
    } catch (const GltfJson::parse_error& error) {
        root().fail(2302, fmt::format("its JSON is not understood at byte {}", error.byte),
                    "the file is cut off or damaged: export or copy it again");
    } catch (const GltfJson::out_of_range&) {
        root().fail(2302, "its JSON holds a number beyond 1.8e308", "the file is damaged: export or copy it again");
    }
    if (!json_.is_object()) root().fail(2302, "its JSON is not an object", "export it as glTF 2.0 (.glb or .gltf)");
    const std::string version = (*this)["asset"]["version"].text_or("missing");
    if (version.compare(0, 2, "2.") != 0)
        root().fail(2304, fmt::format("its glTF version is {}, only 2.x is read", excerpt(version)),
                    "export it as glTF 2.0");
    const std::string least = (*this)["asset"]["minVersion"].text_or("2.0");
    if (least != "2.0")
        root().fail(2304, fmt::format("it asks for readers of glTF {}, only 2.0 is read", excerpt(least)),
                    "export it as glTF 2.0");
}

void GltfDocument::check_extensions() const
{
    const GltfValue required = (*this)["extensionsRequired"];
    for (std::size_t i = 0; i < required.size(); ++i) {
        const std::string extension = required.at(i).text();
        if (is_known(extension)) continue;
        root().fail(2305, fmt::format("needs the extension {}, which is not read", excerpt(extension)),
                    "export the file without this extension");
    }
}

const std::filesystem::path& GltfDocument::place_of_folder(const std::filesystem::path& folder) const
{
    const auto [known, is_new] = folders_.try_emplace(folder.string());
    std::error_code error;
    if (is_new) known->second = std::filesystem::weakly_canonical(folder, error); // empty after an error
    return known->second;
}

std::filesystem::path GltfDocument::place_of(const std::filesystem::path& file) const
{
    const std::filesystem::path& folder = place_of_folder(file.parent_path());
    if (folder.empty()) return {};
    std::error_code error;
    const std::filesystem::path place = folder / file.filename();
    return std::filesystem::is_symlink(place, error) ? std::filesystem::weakly_canonical(place, error) : place;
}

const GltfDocument::FileBeside& GltfDocument::file_beside(const GltfValue& uri_value, const std::string& uri) const
{
    if (const auto known = beside_.find(uri); known != beside_.end()) return known->second;
    const std::optional<std::string> name = decode_file_uri(uri);
    if (!name || is_alone_)
        uri_value.fail(
            2309, fmt::format("{} is not a file in the folder of this one", excerpt(uri)),
            "only files in the folder of the .gltf or below it are opened: put the file there, or pack everything into "
            "one .glb");
    const std::filesystem::path inside = std::filesystem::path(*name).lexically_normal(),
                                folder = std::filesystem::absolute(path_).parent_path();
    // Not where a link leads: that may change, and whoever builds again has to notice.
    const std::string path = (std::filesystem::path(path_).parent_path() / inside).string();
    // A link inside the folder may still lead out of it.
    const std::filesystem::path home = place_of_folder(folder), place = place_of(folder / inside);
    if (home.empty() || place.empty()) {
        note_reading(path, std::nullopt, {});
        uri_value.fail(2310, fmt::format("{} cannot be looked up", excerpt(uri)),
                       "its name is too long, or its links go in circles: give it another name");
    }
    if (std::mismatch(home.begin(), home.end(), place.begin(), place.end()).first != home.end()) {
        note_link(path);
        uri_value.fail(
            2309, fmt::format("{} leads out of the folder of this one", excerpt(uri)),
            "only files in the folder of the .gltf or below it are opened: put the file there, or pack everything into "
            "one .glb");
    }
    return beside_[uri] = { path, place.string() };
}

std::string GltfDocument::read_beside(const GltfValue& uri_value, const std::string& uri) const
{
    DiagnosticList diagnostics;
    std::optional<std::string> bytes = read_bytes(file_beside(uri_value, uri).path, diagnostics);
    if (!bytes)
        uri_value.fail(2310, fmt::format("{} {}", excerpt(uri), diagnostics.diagnostics().at(0).what), "put the file there");
    return std::move(*bytes);
}

std::string_view GltfDocument::read_buffer(const GltfValue& buffer)
{
    const GltfValue uri = buffer["uri"];
    if (!uri.exists()) {
        if (buffer == root()["buffers"].at(0) && has_binary_) return binary_;
        // Allowed for buffers that an extension fills; whoever looks into it is told that it is short.
        buffer.fail(2310, "has neither a uri nor a binary part in the file", "export the file again");
    }
    const std::string text = uri.text();
    if (!is_data_uri(text)) {
        const FileBeside& file = file_beside(uri, text);
        const auto known = files_.find(file.place);
        if (known == files_.end()) return files_[file.place] = read_beside(uri, text);
        note_link(file.path);
        return known->second;
    }
    std::optional<std::string> bytes = decode_data_uri(text);
    if (!bytes) uri.fail(2310, fmt::format("{} is not base64 data", excerpt(text)), "export the file again, or as .glb");
    return decoded_.emplace_back(std::move(*bytes));
}

void GltfDocument::read_buffers()
{
    const GltfValue buffers = (*this)["buffers"], required = (*this)["extensionsRequired"];
    bool needs_meshopt = false;
    for (std::size_t i = 0; i < required.size(); ++i) needs_meshopt |= required.at(i).text() == meshopt_extension;
    std::uint64_t total = 0;
    std::map<const void*, std::uint64_t> beside; // what is used of each file: many buffers may name one
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const GltfValue buffer = buffers.at(i);
        const std::uint64_t length = buffer["byteLength"].whole();
        if (length > buffer_size_limit)
            buffer.fail(2008, fmt::format("has {} bytes, the limit is {}", length, buffer_size_limit), "simplify the mesh");
        if (is_placeholder(buffer, needs_meshopt)) {
            buffers_.emplace_back();
            continue;
        }
        const std::string_view bytes = read_buffer(buffer);
        if (bytes.size() < length)
            buffer.fail(2310, fmt::format("holds {} bytes, {} declared", bytes.size(), length),
                        "the file is cut off: export or copy it again");
        total += length;
        if (total > buffer_size_limit)
            buffer.fail(2008, fmt::format("makes the buffers {} bytes, the limit is {}", total, buffer_size_limit),
                        "simplify the mesh");
        buffers_.push_back(bytes.substr(0, static_cast<std::size_t>(length))); // a BIN part is padded
        if (buffer["uri"].exists() && !is_data_uri(buffer["uri"].text()))
            beside[bytes.data()] = std::max(beside[bytes.data()], length);
    }
    for (const auto& file : beside) byte_count_ += static_cast<std::size_t>(file.second);
}

// Without bytes: its views are all compressed.
bool GltfDocument::is_placeholder(const GltfValue& buffer, bool needs_meshopt) const
{
    if (buffer["uri"].exists() || (buffer == root()["buffers"].at(0) && has_binary_)) return false;
    return needs_meshopt || buffer["extensions"][meshopt_extension]["fallback"].reference_or(false);
}

const UnpackedView* GltfDocument::unpacked(std::size_t index) const
{
    if (const auto known = unpacked_.find(index); known != unpacked_.end()) return &known->second;
    const GltfValue view = (*this)["bufferViews"].at(index), extension = view["extensions"][meshopt_extension];
    if (!extension.exists()) return nullptr;
    const std::size_t buffer = extension["buffer"].index(buffers_.size(), "buffers");
    const UnpackedView& out = unpacked_.emplace(index, decode_meshopt(view, buffers_[buffer], unpacked_left_)).first->second;
    unpacked_left_ -= out.bytes.size();
    return &out;
}

const std::vector<std::int8_t>& GltfDocument::exponents(std::size_t index) const
{
    static const std::vector<std::int8_t> none;
    const UnpackedView* found = unpacked(index);
    return found ? found->exponents : none;
}

std::string_view GltfDocument::view(std::size_t index) const
{
    if (const UnpackedView* found = unpacked(index)) return found->bytes;
    const GltfValue view = (*this)["bufferViews"].at(index);
    const std::string_view buffer = buffers_[view["buffer"].index(buffers_.size(), "buffers")];
    const std::uint64_t offset = view["byteOffset"].whole_or(0), length = view["byteLength"].whole();
    if (offset > buffer.size() || length > buffer.size() - offset)
        view.fail(2308, fmt::format("bytes {} to {} of a buffer of {}", offset, offset + length, buffer.size()));
    return buffer.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

std::string GltfDocument::image(std::size_t index, std::string& why) const
{
    const GltfValue image = (*this)["images"].at(index);
    try {
        if (const GltfValue place = image["bufferView"]; place.exists()) {
            const GltfValue views = (*this)["bufferViews"];
            const std::size_t number = place.index(views.size(), "buffer views");
            if (!views.at(number)["extensions"][meshopt_extension].exists()) return std::string(view(number));
            why = "its view is compressed as one of meshes";
            return {};
        }
        const std::string uri = image["uri"].text();
        if (!is_data_uri(uri)) return read_beside(image["uri"], uri);
        if (std::optional<std::string> bytes = decode_data_uri(uri)) return std::move(*bytes);
        why = "it is not base64 data";
    } catch (const Failure& failure) {
        why = failure.diagnostics().at(0).what;
    }
    return {};
}

std::string GltfDocument::image_source(std::size_t index) const
{
    const GltfValue image = (*this)["images"].at(index);
    try {
        if (const GltfValue place = image["bufferView"]; place.exists()) return fmt::format("view {}", place.whole());
        const std::string uri = image["uri"].text();
        return is_data_uri(uri) ? std::string() : file_beside(image["uri"], uri).place;
    } catch (const Failure&) {
        return {};
    }
}

void GltfDocument::note_image(std::size_t index) const
{
    const GltfValue uri = (*this)["images"].at(index)["uri"];
    if (uri.exists() && !is_data_uri(uri.text())) note_link(file_beside(uri, uri.text()).path);
}

std::vector<std::string> GltfDocument::named_files() const
{
    std::vector<std::string> files;
    for (const char* list : { "buffers", "images" }) {
        const GltfValue entries = (*this)[list];
        for (std::size_t i = 0; i < entries.size(); ++i) {
            const std::string uri = entries.at(i)["uri"].text_or("data:");
            if (is_data_uri(uri)) continue;
            if (const std::optional<std::string> name = decode_file_uri(uri))
                files.push_back((std::filesystem::absolute(path_).parent_path() / *name).string());
        }
    }
    return files;
}

} // namespace pliant
