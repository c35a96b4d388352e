#include "output/asset/asset_facts.h"

#include "base/common/foreign_json.h"
#include "pliant_format.h"

#include <cstring>
#include <fmt/format.h>

namespace pliant {

namespace {

std::uint64_t size_of(const pliant_asset& asset, std::uint32_t tag)
{
    std::size_t size = 0;
    pliant_asset_chunk(&asset, tag, &size);
    return size;
}

pliant_format_header header_of(const pliant_asset& asset)
{
    pliant_format_header header;
    std::memcpy(&header, asset.blob, sizeof header);
    return header;
}

} // namespace

std::vector<ChunkFact> asset_chunks(const pliant_asset& asset)
{
    const pliant_format_header header = header_of(asset);
    std::vector<ChunkFact> table;
    for (std::uint32_t i = 0; i < header.chunk_count; ++i) {
        pliant_format_chunk chunk;
        std::memcpy(&chunk, asset.blob + sizeof header + i * sizeof chunk, sizeof chunk);
        std::string tag(reinterpret_cast<const char*>(&chunk.tag), 4);
        for (char& c : tag)
            if (c < ' ' || c > '~') c = '?'; // an unknown optional chunk may be called anything
        table.push_back({ tag, chunk.offset, chunk.size });
    }
    return table;
}

std::uint64_t basis_size(const pliant_asset& asset)
{
    return size_of(asset, PLIANT_CHUNK_FACTORED) + size_of(asset, PLIANT_CHUNK_COMPACT) + size_of(asset, PLIANT_CHUNK_BASIS);
}

std::uint64_t frame_size(const pliant_asset& asset) { return basis_size(asset) + size_of(asset, PLIANT_CHUNK_REST); }

std::string format_version(const pliant_asset& asset)
{
    const pliant_format_header header = header_of(asset);
    return fmt::format("{}.{}", header.format_major, header.format_minor);
}

bool has_render_mesh(const std::string& certificate)
{
    const auto json = parse_foreign_json(certificate);
    return json.is_object() && json.contains("surface");
}

} // namespace pliant
