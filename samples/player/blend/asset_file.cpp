#include "blend/asset_file.h"

#include "blend/error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

namespace pliant::player {
namespace {

// A cache line: fastest for the runtime's inner loops, and a multiple of the 16 bytes that it requires.
constexpr std::align_val_t blob_alignment { 64 };

constexpr char bake_hint[] = "make an asset with: pliant bake rest.ply pose1.ply ... -o character.pliant";

[[noreturn]] void refuse_file(const std::string& path, const std::string& reason)
{
    throw Error(ErrorNumber::file_unreadable, ExitCode::bad_input, path + ": " + reason, bake_hint);
}

std::string hint_for(pliant_result result)
{
    switch (result) {
    case PLIANT_ERROR_VERSION: return "bake the asset again with this version of the pliant tool";
    case PLIANT_ERROR_NOT_PLIANT: return bake_hint;
    case PLIANT_ERROR_ABSENT: return "only .glb files of `pliant export --embed` contain an asset";
    default:
        return "the file is damaged: copy it again (as binary) or bake it again; `pliant validate` names the broken rule";
    }
}

// Finds the asset in a file: the whole file, or the part embedded in a GLB file.
pliant_result find_asset(const std::byte* bytes, std::size_t size, std::size_t& offset, std::size_t& asset_size)
{
    offset = 0;
    asset_size = size;
    if (size < 4 || std::memcmp(bytes, "glTF", 4) != 0) return PLIANT_OK;
    return pliant_glb_find(bytes, size, &offset, &asset_size);
}

// A name may fill a file; the panels measure each letter.
std::string cut(std::string name)
{
    constexpr std::size_t size_limit = 200;
    if (name.size() <= size_limit) return name;
    std::size_t end = size_limit;
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0) == 0x80) --end; // inside a letter of UTF-8
    return name.substr(0, end) + "…";
}

} // namespace

void AssetFile::AlignedDelete::operator()(std::byte* bytes) const { ::operator delete[](bytes, blob_alignment); }

AssetFile::AssetFile(const std::string& path)
    : path_(path)
{
    std::error_code error;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error)) // a pipe would never end
        refuse_file(path, "is a folder or a device, not an asset");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    if (!file) refuse_file(path, std::strerror(errno));
    const auto size = std::filesystem::file_size(path, error);
    if (error) refuse_file(path, error.message());

    blob_.reset(static_cast<std::byte*>(::operator new[](size > 0 ? size : 1, blob_alignment)));
    if (std::fread(blob_.get(), 1, size, file.get()) != size) refuse_file(path, "ended before all of it was read");
    std::size_t offset = 0, asset_size = 0;
    pliant_result result = find_asset(blob_.get(), size, offset, asset_size);
    if (result == PLIANT_OK) {
        // `pliant export` aligns the asset to a page; another writer may have put it anywhere.
        if (offset % static_cast<std::size_t>(blob_alignment) != 0) {
            std::memmove(blob_.get(), blob_.get() + offset, asset_size);
            offset = 0;
        }
        result = pliant_asset_open(&asset_, blob_.get() + offset, asset_size, PLIANT_OPEN_VERIFY_CHECKSUMS);
    }
    if (result != PLIANT_OK) {
        throw Error(ErrorNumber::asset_refused, ExitCode::bad_input, path + ": " + pliant_result_text(result),
                    hint_for(result));
    }
    for (std::uint32_t k = 0; k < asset_.pose_count; ++k) {
        const std::string name = cut(pliant_asset_pose_name(&asset_, k));
        pose_names_.push_back(name.empty() ? "pose " + std::to_string(k) : name);
    }
    short_names_ = without_common_prefix(pose_names_);
    read_weights();
}

void AssetFile::read_weights()
{
    for (std::uint32_t i = 0; i < asset_.weight_count; ++i) {
        if (!asset_.has_layers) {
            weights_.push_back({ short_names_[i], 0.0, 1.0, 1.0 / asset_.weight_count });
            continue;
        }
        pliant_weight weight {};
        pliant_asset_weight(&asset_, i, &weight);
        weights_.push_back({ pose_names_[i + 1], weight.low, weight.high, weight.initial });
    }
}

std::vector<std::string> without_common_prefix(const std::vector<std::string>& names)
{
    std::size_t shared = names.front().size();
    for (const std::string& name : names)
        while (name.compare(0, shared, names.front(), 0, shared) != 0) --shared;
    const std::size_t separator = names.front().substr(0, shared).find_last_of("_-. ");
    const std::size_t cut = separator == std::string::npos ? 0 : separator + 1;
    std::vector<std::string> result;
    for (const std::string& name : names) {
        if (name.size() == cut) return names;
        result.push_back(name.substr(cut));
    }
    return result;
}

std::string AssetFile::counted() const
{
    return has_layers() ? std::to_string(weights_.size()) + (weights_.size() == 1 ? " layer" : " layers")
                        : std::to_string(asset_.pose_count) + " poses";
}

std::string AssetFile::letters() const
{
    std::string all = title();
    for (const std::string& name : pose_names_) all += name;
    return all;
}

std::string AssetFile::title() const { return std::filesystem::path(path_).stem().string(); }

} // namespace pliant::player
