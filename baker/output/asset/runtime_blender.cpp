#include "output/asset/runtime_blender.h"

#include "base/common/diagnostics.h"
#include "input/io/source_file.h"
#include "pliant_format.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace pliant {

Failure open_failure(pliant_result result, const std::string& path)
{
    const char* hint = "";
    switch (result) {
    case PLIANT_ERROR_VERSION: hint = "bake it again with this version, or use a newer tool"; break;
    case PLIANT_ERROR_NOT_PLIANT: hint = "`pliant bake` writes .pliant files; meshes are for `pliant check`"; break;
    default: hint = "the file is damaged: copy it again (in binary mode) or bake it again"; break;
    }
    return Failure(ExitCode::bad_input,
                   error_at(5102, path, fmt::format("not a usable asset: {}", pliant_result_text(result)), hint));
}

std::string certificate_of(const pliant_asset& asset)
{
    std::size_t size = 0;
    const void* text = pliant_asset_chunk(&asset, PLIANT_CHUNK_CERTIFICATE, &size);
    return std::string(static_cast<const char*>(text), size);
}

Polygons faces_of(const pliant_asset& asset)
{
    Polygons faces;
    std::size_t size = 0;
    const auto* words = static_cast<const std::uint32_t*>(pliant_asset_chunk(&asset, PLIANT_CHUNK_POLYGONS, &size));
    if (words) { // open has checked that sizes and indices add up
        const std::uint32_t face_count = words[0], index_count = words[1];
        for (std::uint32_t f = 0; f < face_count; ++f) faces.offsets.push_back(faces.offsets.back() + words[2 + f]);
        faces.indices.assign(words + 2 + face_count, words + 2 + face_count + index_count);
        return faces;
    }
    for (std::uint32_t f = 0; f < asset.triangle_count; ++f) faces.offsets.push_back(3 * (f + 1));
    faces.indices.assign(asset.triangles, asset.triangles + 3 * std::size_t(asset.triangle_count));
    return faces;
}

namespace {

Asset opened(const std::vector<std::uint8_t>& bytes, const std::string& path, bool verify_checksums)
{
    try {
        return Asset(bytes, verify_checksums ? PLIANT_OPEN_VERIFY_CHECKSUMS : PLIANT_OPEN_DEFAULT);
    } catch (const Error& error) {
        throw open_failure(error.result(), path);
    }
}

} // namespace

RuntimeBlender::RuntimeBlender(const std::vector<std::uint8_t>& bytes, const std::string& path, bool verify_checksums)
    : asset_(opened(bytes, path, verify_checksums))
{
    configure(pliant_solver_desc_default());
}

// The asset in a file: the one that `pliant export --embed` put into a GLB, else all bytes.
static std::vector<std::uint8_t> asset_bytes(const std::string& file, const std::string& path)
{
    if (file.empty())
        throw Failure(ExitCode::bad_input,
                      error_at(5102, path, "not a usable asset: the file is empty", "copy it again or bake it again"));
    std::size_t offset = 0, size = file.size();
    const pliant_result result = pliant_glb_find(file.data(), file.size(), &offset, &size);
    if (result == PLIANT_ERROR_ABSENT)
        throw Failure(ExitCode::bad_input,
                      error_at(5102, path, "not a usable asset: a GLB without one",
                               "`pliant export --embed` puts an asset into a GLB; meshes are for `pliant check`"));
    if (result != PLIANT_OK) return std::vector<std::uint8_t>(file.begin(), file.end());
    const auto begin = file.begin() + std::ptrdiff_t(offset);
    return std::vector<std::uint8_t>(begin, begin + std::ptrdiff_t(size));
}

RuntimeBlender RuntimeBlender::from_file(const std::string& path)
{
    DiagnosticList diagnostics;
    const std::optional<std::string> bytes = read_bytes(path, diagnostics);
    if (!bytes) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    return RuntimeBlender(asset_bytes(*bytes, path), path, true);
}

void RuntimeBlender::configure(const pliant_solver_desc& desc)
{
    try {
        solver_.emplace(asset_, desc);
    } catch (const Error&) {
        throw Failure(ExitCode::failed, error_at(4504, "", "the runtime rejects the solver settings"));
    }
}

void RuntimeBlender::solve_tightly()
{
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-5f;
    configure(desc);
}

WeightDomain RuntimeBlender::domain() const
{
    if (!asset_->has_layers) return WeightDomain::simplex(asset_->pose_count);
    std::vector<WeightRange> ranges;
    for (std::uint32_t i = 0; i < asset_->weight_count; ++i) {
        const pliant_weight weight = asset_.weight(i);
        ranges.push_back({ weight.low, weight.high, weight.initial });
    }
    return WeightDomain::box(std::move(ranges));
}

std::vector<float> RuntimeBlender::pose_coordinates(std::uint32_t pose) const
{
    const Span<const float> q = asset_.pose_coordinates(pose);
    return std::vector<float>(q.begin(), q.end());
}

std::vector<float> RuntimeBlender::solve(const std::vector<float>& weights, bool continuous, pliant_solve_info* info)
{
    if (weights.size() != asset_->weight_count) {
        const char* of = asset_->has_layers ? "layer" : "pose";
        std::vector<std::string> names;
        for (std::uint32_t i = 0; i < asset_->weight_count; ++i) names.push_back(asset_.weight(i).name);
        throw Failure(
            ExitCode::usage,
            error_at(1203, "",
                     fmt::format("{} weights given, the asset has {} {}s", weights.size(), asset_->weight_count, of),
                     fmt::format("give one weight per {}, separated by commas: {}{}", of, fmt::join(names, ", "),
                                 asset_->has_layers ? " (the rest shape has none)" : "")));
    }
    if (!continuous) solver_->reset();
    try {
        const pliant_solve_info found = solver_->solve(weights);
        if (info) *info = found;
    } catch (const Error& error) {
        throw Failure(ExitCode::usage,
                      error_at(1204, "", fmt::format("weights {}: {}", fmt::join(weights, ","), error.what()),
                               asset_->has_layers ? "weights must be finite"
                                                  : "weights must be finite, not negative and not all zero"));
    }
    return std::vector<float>(solver_->coordinates().begin(), solver_->coordinates().end());
}

std::vector<float> RuntimeBlender::positions(const std::vector<float>& q) const
{
    std::vector<float> out(3 * std::size_t(asset_->vertex_count));
    reconstruct(asset_, q, out);
    return out;
}

std::string RuntimeBlender::pose_name(std::uint32_t pose) const
{
    const char* name = pliant_asset_pose_name(asset_.get(), pose);
    return name ? name : "";
}

std::vector<std::uint32_t> RuntimeBlender::source_vertices() const
{
    const std::uint32_t* sources = asset_->source_vertices;
    return sources ? std::vector<std::uint32_t>(sources, sources + asset_->vertex_count) : std::vector<std::uint32_t>();
}

} // namespace pliant
