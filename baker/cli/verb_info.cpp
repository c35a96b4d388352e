#include "cli/verbs.h"

#include "base/common/foreign_json.h"
#include "base/common/parallel.h"
#include "base/common/print.h"
#include "base/common/version.h"
#include "cli/certificate_lines.h"
#include "elastic/average/sparse_cholesky.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"
#include "output/page/certificate_facts.h"
#include "pipeline/batch.h"
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
    std::vector<std::string> assets;
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

CertificateFacts facts_of(const Json& info)
{
    return read_certificate_facts(info["certificate"].dump(-1, ' ', false, Json::error_handler_t::replace),
                                  info["poses"].size(), info.contains("layers"));
}

// What scripts ask for first; null where nothing was measured.
void add_verdict(Json& info)
{
    const CertificateFacts facts = facts_of(info);
    info["meets_tolerance"] = facts.meets_tolerance && facts.mean_error ? Json(*facts.meets_tolerance) : Json();
    info["tolerance"] = facts.tolerance;
    info["mean_error"] = facts.mean_error ? Json(*facts.mean_error) : Json();
    info["largest_error"] = facts.largest_error ? Json(*facts.largest_error) : Json();
}

Json describe(const RuntimeBlender& blender, const std::string& path)
{
    const pliant_asset& asset = blender.asset();
    const pliant_solver_desc desc = pliant_solver_desc_default();
    Json info = { { "asset", path },
                  { "format", format_version(asset) },
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
    add_verdict(info);
    return info;
}

void print_shape(const Json& info)
{
    const Json &shape = info["shape"], &basis = shape["basis"], &morph = shape["morph_targets"];
    std::string columns;
    for (const Json& group : basis["columns"])
        columns
            += fmt::format("{}{} of {} bits", columns.empty() ? "" : ", ", group["columns"].dump(), group["bits"].dump());
    print_to(stdout, "  basis: {:.2f} bytes per number; columns: {}\n", basis["bytes_per_number"].get<double>(), columns);
    print_to(stdout,
             "  file {:.1f} KiB, read per frame {:.1f} KiB; linear morph targets of the same poses in single precision: "
             "{:.1f} and "
             "{:.1f} KiB\n",
             info["file_size"].get<double>() / 1024, shape["frame_bytes"].get<double>() / 1024,
             morph["file_size"].get<double>() / 1024, morph["frame_bytes"].get<double>() / 1024);
}

void print_file(const Json& info)
{
    for (const Json& chunk : info["chunks"])
        print_to(stdout, "  {}  {:>12} bytes at {}\n", chunk["tag"].get<std::string>(), chunk["size"].dump(),
                 chunk["offset"].dump());
    // A stranger's text: as ASCII it has no characters that terminals obey.
    print_to(stdout, "certificate: {}\n", info["certificate"].dump(2, ' ', true, Json::error_handler_t::replace));
}

// The names of the poses; of layers with their ranges and errors.
void print_weights(const Json& info, const CertificateFacts& facts)
{
    if (!info.contains("layers")) {
        for (const Json& pose : info["poses"]) print_to(stdout, "  pose {}\n", printable(pose.get<std::string>()));
        return;
    }
    print_to(stdout, "  rest shape {}\n", printable(info["poses"][0].get<std::string>()));
    for (const Json& layer : info["layers"])
        print_to(stdout, "  layer {}, weights {:g} .. {:g}\n", printable(layer["name"].get<std::string>()),
                 layer["low"].get<float>(), layer["high"].get<float>());
    for (const MixtureFact& m : facts.mixtures)
        print_to(
            stdout, "  {}\n",
            kind_line({ printable(m.kind), m.count, m.lost_count, m.mean, m.largest, m.linear_mean, m.linear_largest }));
}

void print_info(const std::string& path, const Json& info, bool is_verbose)
{
    const CertificateFacts facts = facts_of(info);
    print_to(stdout, "{}: {}\n", printable(path), verdict_of(facts));
    print_to(stdout, "  {} vertices, {} triangles, d = {}, {}, {} of solver memory per character\n", info["vertices"].dump(),
             info["triangles"].dump(), info["dimension"].dump(), size_text(info["file_size"].get<double>()),
             size_text(info["solver_memory"].get<double>()));
    print_weights(info, facts);
    if (const std::string drift = drift_line(facts); !drift.empty()) print_to(stdout, "  {}\n", drift);
    print_shape(info);
    if (is_verbose) print_file(info);
}

// One asset is one JSON value, several are an array of them.
void print_values(const std::vector<Json>& values)
{
    const Json json = values.size() == 1 ? values[0] : Json(values);
    print_to(stdout, "{}\n", json.dump(1, ' ', true, Json::error_handler_t::replace));
}

ExitCode run_info(const InfoArguments& a)
{
    std::vector<Json> values;
    for (const std::string& path : a.assets) {
        values.push_back(describe(RuntimeBlender::from_file(path), path));
        if (!a.is_json && !a.talk.is_quiet) print_info(path, values.back(), a.talk.is_verbose);
    }
    if (a.is_json) print_values(values);
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
    verdict.largest_difference = scale > 0 ? difference / scale : 0; // the answers of a still shape are arbitrary
    return verdict;
}

// Another processor or compiler may round differently, a solver stops at 1e-3 of the energy metric: within this the asset
// behaves as it did for the baker.
constexpr double answer_tolerance = 1e-3;

Failure not_reproduced(const std::string& path, const Verdict& verdict)
{
    return Failure(ExitCode::bad_input,
                   error_at(5105, path,
                            fmt::format("stored answers are not reproduced: off by {:.1e}, allowed {:.1e}",
                                        verdict.largest_difference, answer_tolerance),
                            "the file is damaged or was baked for another solver: bake it again"));
}

// Prints what is wrong, or the verdict as text if `is_text`; returns the verdict as JSON.
Json validate(const std::string& path, bool is_text)
{
    Json json = { { "asset", path }, { "valid", true } };
    try {
        RuntimeBlender blender = RuntimeBlender::from_file(path);
        const Verdict verdict = solve_answers(blender);
        json["answers"] = verdict.answer_count;
        json["largest_difference"] = verdict.largest_difference;
        if (!(verdict.largest_difference <= answer_tolerance)) throw not_reproduced(path, verdict);
        if (is_text)
            print_to(stdout, "{}: valid; {} stored answers reproduced within {:.1e}\n", printable(path),
                     verdict.answer_count, verdict.largest_difference);
    } catch (const Failure& failure) {
        if (failure.code() != ExitCode::bad_input) throw;
        for (const Diagnostic& diagnostic : failure.diagnostics()) print_finding("validate", diagnostic);
        json["valid"] = false;
        json["number"] = failure.diagnostics().front().number;
        json["what"] = failure.diagnostics().front().what;
    }
    return json;
}

ExitCode run_validate(const InfoArguments& a)
{
    std::vector<Json> values;
    for (const std::string& path : a.assets) values.push_back(validate(path, !a.is_json && !a.talk.is_quiet));
    if (a.is_json) print_values(values);
    const bool all_valid = std::all_of(values.begin(), values.end(), [](const Json& v) { return v["valid"] == true; });
    return all_valid ? ExitCode::done : ExitCode::bad_input;
}

CLI::App* add_asset_verb(CLI::App& app, const char* name, const char* help, const char* example,
                         const std::shared_ptr<InfoArguments>& a)
{
    CLI::App* verb = app.add_subcommand(name, help);
    verb->footer(example);
    verb->add_option("asset", a->assets, "One or more assets")->required()->type_name("ASSET")->expected(1, -1);
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
        if (a->assets.empty())
            throw Failure(ExitCode::usage, error_at(1101, "", "ASSET is missing", "for example: pliant info hero.pliant"));
        return run_info(*a);
    };
}

Verb add_validate(CLI::App& app)
{
    auto a = std::make_shared<InfoArguments>();
    CLI::App* verb = add_asset_verb(
        app, "validate", "Check an asset: structure, checksums, and that the runtime reproduces its stored answers",
        "Example:\n  pliant validate hero.pliant", a);
    verb->get_option("--json")->description("Print the verdict as JSON to standard output, also on failure");
    return [a] { return run_validate(*a); };
}

} // namespace pliant
