#include "cli/verbs.h"

#include "base/common/parallel.h"
#include "base/common/print.h"
#include "base/common/version.h"
#include "cli/kind_line.h"
#include "elastic/average/sparse_cholesky.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"
#include "output/page/certificate_facts.h"
#include "output/page/foreign_json.h"
#include "pliant_format.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/core.h>
#include <map>
#include <memory>

namespace pliant {

namespace {

using Json = nlohmann::ordered_json;

struct InfoArguments {
    std::string asset;
    bool is_json = false, is_build = false;
    Talk talk;
};

// Version, compiler, solver and BLAS of this tool.
ExitCode run_build_info(const InfoArguments& a)
{
#ifdef __clang__
    const std::string compiler = __VERSION__; // with its name
#else
    const std::string compiler = "GCC " __VERSION__;
#endif
    const Json build
        = { { "version", version },    { "format", fmt::format("{}.{}", PLIANT_FORMAT_MAJOR, PLIANT_FORMAT_MINOR) },
            { "compiler", compiler },  { "solver", version_of(default_solver()) },
            { "blas", blas_in_use() }, { "threads", worker_count() } };
    if (a.is_json) {
        print_to(stdout, "{}\n", build.dump(1));
        return ExitCode::done;
    }
    for (const auto& [key, value] : build.items())
        print_to(stdout, "{:<9} {}\n", key, value.is_string() ? value.get<std::string>() : value.dump());
    return ExitCode::done;
}

Json chunk_table(const pliant_asset& asset)
{
    Json table = Json::array();
    for (const ChunkFact& chunk : asset_chunks(asset))
        table.push_back({ { "tag", chunk.tag }, { "offset", chunk.offset }, { "size", chunk.size } });
    return table;
}

// How many columns of the basis take how many bits a number (rounded), of those that a compact one has.
Json column_bits(const pliant_asset& asset)
{
    std::map<int, int> counts;
    for (std::uint32_t j = 0; j < asset.dimension; ++j) {
        pliant_column column;
        if (pliant_asset_column(&asset, j, &column) == PLIANT_OK) ++counts[int(std::lround(column.bits))];
    }
    Json out = Json::array();
    for (const auto& [bits, count] : counts) out.push_back({ { "bits", bits }, { "columns", count } });
    return out;
}

// The basis, and what linear morph targets in single precision would take for as many poses: one pose and the differences of
// the others, positions only, and the same triangles. A frame reads rest positions and basis; of morph targets the first
// pose and the differences.
Json shape_costs(const pliant_asset& asset)
{
    const auto size_of = [&](std::uint32_t tag) {
        std::size_t size = 0;
        pliant_asset_chunk(&asset, tag, &size);
        return size;
    };
    const std::uint64_t basis = basis_size(asset);
    const std::size_t position = 3 * sizeof(float) * std::size_t(asset.vertex_count);
    const std::size_t morph = position * asset.pose_count;
    return { { "basis",
               { { "compact", asset.columns != nullptr },
                 { "bytes", basis },
                 { "bytes_per_number", double(basis) / (3.0 * double(asset.vertex_count) * double(asset.dimension)) },
                 { "columns", column_bits(asset) } } },
             { "frame_bytes", frame_size(asset) },
             { "morph_targets", { { "file_size", morph + size_of(PLIANT_CHUNK_TRIANGLES) }, { "frame_bytes", morph } } } };
}

Json describe(const RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    const pliant_solver_desc desc = pliant_solver_desc_default();
    Json info = { { "format", format_version(asset) },
                  { "vertices", asset.vertex_count },
                  { "triangles", asset.triangle_count },
                  { "dimension", asset.dimension },
                  { "poses", Json::array() },
                  { "file_size", asset.blob_size },
                  { "solver_memory", pliant_solver_memory(&asset, &desc) },
                  { "chunks", chunk_table(asset) } };
    info["shape"] = shape_costs(asset);
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) info["poses"].push_back(blender.pose_name(k));
    for (std::uint32_t i = 0; asset.has_layers && i < asset.weight_count; ++i) {
        pliant_weight weight {};
        pliant_asset_weight(&asset, i, &weight);
        info["layers"].push_back(
            { { "name", weight.name }, { "low", weight.low }, { "high", weight.high }, { "initial", weight.initial } });
    }
    const Json certificate = parse_foreign_json(blender.certificate());
    info["certificate"] = certificate.is_discarded() ? Json() : certificate;
    return info;
}

void print_shape(const Json& info)
{
    const Json &shape = info["shape"], &basis = shape["basis"], &morph = shape["morph_targets"];
    std::string columns;
    for (const Json& group : basis["columns"])
        columns
            += fmt::format("{}{} of {} bits", columns.empty() ? "" : ", ", group["columns"].dump(), group["bits"].dump());
    print_to(stdout, "basis: {:.2f} bytes per number; columns: {}\n", basis["bytes_per_number"].get<double>(), columns);
    print_to(
        stdout,
        "file {:.1f} KiB, read per frame {:.1f} KiB; linear morph targets of the same poses in single precision: {:.1f} and "
        "{:.1f} KiB\n",
        info["file_size"].get<double>() / 1024, shape["frame_bytes"].get<double>() / 1024,
        morph["file_size"].get<double>() / 1024, morph["frame_bytes"].get<double>() / 1024);
}

CertificateFacts facts_of(const Json& info)
{
    return read_certificate_facts(info["certificate"].dump(-1, ' ', false, Json::error_handler_t::replace),
                                  info["poses"].size(), info.contains("layers"));
}

// Whether the asset is any good.
std::string verdict_of(const CertificateFacts& facts)
{
    if (!facts.is_readable || !facts.mean_error) return "no errors were measured when it was baked";
    return fmt::format(
        "{} its tolerance: blends at {} weights are off by {:.2e} (mean, allowed {:.0e}) and {:.2e} (largest)",
        facts.meets_tolerance.value_or(false) ? "keeps" : "misses", facts.checks.size(), *facts.mean_error, facts.tolerance,
        facts.largest_error.value_or(0));
}

void print_file(const Json& info)
{
    for (const Json& chunk : info["chunks"])
        print_to(stdout, "  {}  {:>12} bytes at {}\n", chunk["tag"].get<std::string>(), chunk["size"].dump(),
                 chunk["offset"].dump());
    print_to(stdout, "certificate: {}\n", info["certificate"].dump(2, ' ', false, Json::error_handler_t::replace));
}

// The names of the poses; of layers with their ranges and errors.
void print_weights(const Json& info, const CertificateFacts& facts)
{
    if (!info.contains("layers")) {
        for (const Json& pose : info["poses"]) print_to(stdout, "  pose {}\n", pose.get<std::string>());
        return;
    }
    print_to(stdout, "  rest shape {}\n", info["poses"][0].get<std::string>());
    for (const Json& layer : info["layers"])
        print_to(stdout, "  layer {}, weights {:g} .. {:g}\n", layer["name"].get<std::string>(), layer["low"].get<float>(),
                 layer["high"].get<float>());
    for (const MixtureFact& m : facts.mixtures)
        print_to(stdout, "  {}\n",
                 kind_line({ m.kind, m.count, m.lost_count, m.mean, m.largest, m.linear_mean, m.linear_largest }));
}

ExitCode run_info(const InfoArguments& a)
{
    const RuntimeBlender blender = RuntimeBlender::from_file(a.asset);
    const Json info = describe(blender);
    if (a.is_json) {
        print_to(stdout, "{}\n", info.dump(1, ' ', false, Json::error_handler_t::replace));
        return ExitCode::done;
    }
    if (a.talk.is_quiet) return ExitCode::done;
    const CertificateFacts facts = facts_of(info);
    print_to(stdout, "{}: {}\n", a.asset, verdict_of(facts));
    print_to(stdout, "  {} vertices, {} triangles, d = {}, {:.2f} MiB, {:.1f} KiB of solver memory per character\n",
             info["vertices"].dump(), info["triangles"].dump(), info["dimension"].dump(),
             info["file_size"].get<double>() / 1048576.0, info["solver_memory"].get<double>() / 1024.0);
    print_weights(info, facts);
    print_shape(info);
    if (a.talk.is_verbose) print_file(info);
    return ExitCode::done;
}

struct Verdict {
    std::size_t answer_count = 0;
    double largest_difference = 0; // of q, relative to the largest q of the answers
};

// Solves the stored answers again (SPEC.md, ANSW).
Verdict solve_answers(RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    std::size_t size = 0;
    const auto* chunk = static_cast<const unsigned char*>(pliant_asset_chunk(&asset, PLIANT_CHUNK_ANSWERS, &size));
    pliant_format_count head;
    std::memcpy(&head, chunk, sizeof head);
    Verdict verdict;
    verdict.answer_count = head.count;
    const std::size_t m = asset.pose_count, d = asset.dimension, skipped = asset.has_layers; // of layers (1, v)
    double scale = 0, difference = 0;
    for (std::size_t i = 0; i < head.count; ++i) {
        std::vector<float> row(m + d);
        std::memcpy(row.data(), chunk + sizeof head + i * row.size() * sizeof(float), row.size() * sizeof(float));
        const std::vector<float> weights(row.begin() + std::ptrdiff_t(skipped), row.begin() + std::ptrdiff_t(m));
        const std::vector<float> q = blender.solve(weights, false);
        for (std::size_t j = 0; j < d; ++j) {
            difference = std::max(difference, double(std::abs(q[j] - row[m + j])));
            scale = std::max(scale, double(std::abs(row[m + j])));
        }
    }
    verdict.largest_difference = scale > 0 ? difference / scale : 0;
    return verdict;
}

// Another processor or compiler may round differently, a solver stops at 1e-3 of the energy metric: within this the asset
// behaves as it did for the baker.
constexpr double answer_tolerance = 1e-3;

ExitCode run_validate(const InfoArguments& a)
{
    RuntimeBlender blender = RuntimeBlender::from_file(a.asset, true);
    const Verdict verdict = solve_answers(blender);
    const bool is_good = verdict.largest_difference <= answer_tolerance;
    if (a.is_json)
        print_to(stdout, "{}\n",
                 Json({ { "valid", is_good },
                        { "answers", verdict.answer_count },
                        { "largest_difference", verdict.largest_difference } })
                     .dump(1));
    else if (is_good && !a.talk.is_quiet)
        print_to(stdout, "{}: valid; {} stored answers reproduced within {:.1e}\n", a.asset, verdict.answer_count,
                 verdict.largest_difference);
    if (!is_good)
        throw Failure(ExitCode::bad_input,
                      error_at(5105, a.asset,
                               fmt::format("stored answers are not reproduced: off by {:.1e}, allowed {:.1e}",
                                           verdict.largest_difference, answer_tolerance),
                               "the file is damaged or was baked for another solver: bake it again"));
    return ExitCode::done;
}

CLI::App* add_asset_verb(CLI::App& app, const char* name, const char* help, const char* example,
                         const std::shared_ptr<InfoArguments>& a)
{
    CLI::App* verb = app.add_subcommand(name, help);
    verb->footer(example);
    verb->add_option("asset", a->asset, "Asset")->required()->type_name("ASSET");
    add_json(*verb, a->is_json);
    add_talk(*verb, a->talk);
    return verb;
}

} // namespace

Verb add_info(CLI::App& app)
{
    auto a = std::make_shared<InfoArguments>();
    CLI::App* verb = add_asset_verb(app, "info", "Show the contents of an asset, or the build of this tool",
                                    "Examples:\n  pliant info hero.pliant\n  pliant info --build", a);
    CLI::Option* build = verb->add_flag(
        "--build", a->is_build, "Show version, compiler, sparse solver and the kernels of its BLAS instead of an asset");
    verb->get_option("asset")->required(false)->excludes(build);
    return [a] {
        if (a->is_build) return run_build_info(*a);
        if (a->asset.empty())
            throw Failure(ExitCode::usage,
                          error_at(1101, "", "asset is required", "`pliant info --help` lists the arguments"));
        return run_info(*a);
    };
}

Verb add_validate(CLI::App& app)
{
    auto a = std::make_shared<InfoArguments>();
    add_asset_verb(app, "validate",
                   "Check an asset: structure, checksums, and that the runtime reproduces its stored answers",
                   "Example:\n  pliant validate hero.pliant", a);
    return [a] { return run_validate(*a); };
}

} // namespace pliant
