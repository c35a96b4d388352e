// Which layout the basis gets: bytes a number, error, and time to rebuild all positions, for the layouts that were tried,
// next to the read bandwidth of one core. Asserts nothing.
//     pliant_bench_basis ASSET... [--vertices 160000] [--error 1e-5]
// Takes shape, basis and blends (stored answers and poses, and the predictor's centres as weights of more) from assets that
// were baked with --position-error 0, and repeats their vertices up to the number asked for.
#include "cli/console.h"
#include "output/asset/bounds.h"
#include "output/asset/compact_basis.h"
#include "output/asset/runtime_blender.h"
#include "output/asset/stored_shape.h"
#include "pliant_format.h"

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fmt/core.h>
#include <functional>
#include <stdexcept>

using namespace pliant;

namespace {

#if defined(__x86_64__) && defined(__GNUC__)
#define FOR_AVX2 __attribute__((target_clones("avx2", "default")))
#else
#define FOR_AVX2
#endif

constexpr std::size_t lanes = PLIANT_FORMAT_TILE_FLOATS;
constexpr std::size_t buffer_words = std::size_t(1) << 26; // 512 MiB: more than the last cache

double seconds(const std::function<void()>& work, int rounds)
{
    double best = 1e30;
    for (int i = 0; i < rounds; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

FOR_AVX2 std::uint64_t sum_words(const std::uint64_t* words, std::size_t count)
{
    std::uint64_t sums[16] = {};
    for (std::size_t i = 0; i < count; i += 16)
        for (std::size_t l = 0; l < 16; ++l) sums[l] += words[i + l];
    std::uint64_t sum = 0;
    for (std::uint64_t s : sums) sum += s;
    return sum;
}

// Of the fastest piece of a walk through more than the last cache holds: other work on the machine interrupts the others.
double read_bandwidth()
{
    constexpr std::size_t piece = std::size_t(1) << 19;
    const std::vector<std::uint64_t> words(buffer_words, 1);
    volatile std::uint64_t sink = 0;
    double best = 1e30;
    for (int round = 0; round < 4; ++round)
        for (std::size_t at = 0; at < words.size(); at += piece)
            best = std::min(best, seconds([&] { sink = sum_words(words.data() + at, piece); }, 1));
    return double(piece * sizeof(std::uint64_t)) / best;
}

// What is blended: columns and rest in input units, the coordinates that blends have.
struct Shape {
    Eigen::MatrixXd columns, samples;
    Eigen::VectorXd rest;
    double diagonal = 0;
};

Eigen::MatrixXd untile(const float* tiles, std::size_t n, std::size_t columns)
{
    Eigen::MatrixXd out(Eigen::Index(3 * n), Eigen::Index(columns));
    for (std::size_t j = 0; j < columns; ++j)
        for (std::size_t i = 0; i < 3 * n; ++i)
            out(Eigen::Index(i), Eigen::Index(j)) = double(tiles[(i / lanes * columns + j) * lanes + i % lanes]);
    return out;
}

// Stored answers, poses, and the runtime's blends at weights all over the simplex.
Eigen::MatrixXd blends_of(RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    const Eigen::Index d = asset.dimension;
    Eigen::MatrixXd out(d, 0);
    const auto add = [&](const float* q) {
        out.conservativeResize(Eigen::NoChange, out.cols() + 1);
        out.rightCols(1) = Eigen::Map<const Eigen::VectorXf>(q, d).cast<double>();
    };
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) add(pliant_asset_pose_coordinates(&asset, k));
    std::uint64_t state = 1;
    for (int i = 0; i < 64; ++i) {
        std::vector<float> weights(asset.pose_count);
        for (float& w : weights) {
            state = state * 6364136223846793005U + 1442695040888963407U;
            w = -std::log((float(state >> 40) + 0.5F) / 16777216.0F);
        }
        add(blender.solve(weights, false).data());
    }
    return out;
}

Shape load(const std::string& path, std::size_t vertex_count, RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    if (!asset.basis) throw std::runtime_error(path + " has a compact basis: bake it with --position-error 0");
    const std::size_t n = asset.vertex_count, d = asset.dimension;
    const Eigen::MatrixXd rest = untile(asset.rest, n, 1), basis = untile(asset.basis, n, d);
    Shape shape;
    Subspace subspace { rest, basis, Eigen::MatrixXd() };
    const Eigen::MatrixXd reachable = blends_of(blender);
    const Frame frame = principal_frame(subspace, reachable);
    const Eigen::MatrixXd turned = basis * frame.axes, middle = rest + basis * frame.offset;
    shape.samples = reach_margin * (frame.axes.transpose() * (reachable.colwise() - frame.offset));
    shape.columns.resize(Eigen::Index(3 * vertex_count), Eigen::Index(d));
    shape.rest.resize(shape.columns.rows());
    for (std::size_t v = 0; v < vertex_count; ++v) {
        shape.columns.middleRows(Eigen::Index(3 * v), 3) = turned.middleRows(Eigen::Index(3 * (v % n)), 3);
        shape.rest.segment(Eigen::Index(3 * v), 3) = middle.block(Eigen::Index(3 * (v % n)), 0, 3, 1);
    }
    const Eigen::Map<const Eigen::Matrix3Xd> points(rest.data(), 3, Eigen::Index(n));
    shape.diagonal = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
    return shape;
}

double largest_error(const Eigen::MatrixXd& exact, const Eigen::MatrixXd& packed, const Eigen::MatrixXd& samples)
{
    double largest = 0;
    for (Eigen::Index s = 0; s < samples.cols(); ++s) {
        const Eigen::VectorXd off = (exact - packed) * samples.col(s);
        for (Eigen::Index i = 0; i < off.size(); i += 3) largest = std::max(largest, off.segment<3>(i).norm());
    }
    return largest;
}

template <class T> std::vector<T> tile(const Eigen::MatrixXd& columns)
{
    const std::size_t tiles = (std::size_t(columns.rows()) + lanes - 1) / lanes, d = std::size_t(columns.cols());
    std::vector<T> out(tiles * d * lanes, T(0));
    for (std::size_t i = 0; i < std::size_t(columns.rows()); ++i)
        for (std::size_t j = 0; j < d; ++j)
            out[(i / lanes * d + j) * lanes + i % lanes] = T(columns(Eigen::Index(i), Eigen::Index(j)));
    return out;
}

// ------------------------------------------------------------------------------------------------ layouts with whole
// columns --

// Columns of one width each, 0, 8 or 16 bits, a scale for the whole mesh; a tile holds its 16-bit columns, then those of 8.
struct ColumnLayout {
    std::vector<std::int16_t> wide;
    std::vector<std::int8_t> narrow;
    std::vector<float> wide_scales, narrow_scales;
    Eigen::MatrixXd packed;
    std::vector<Eigen::Index> wide_columns, narrow_columns;

    // Widths by amplitude: half a unit of a column moves no vertex of a blend by more than `unit`.
    ColumnLayout(const Shape& shape, double unit, bool use_8)
        : packed(Eigen::MatrixXd::Zero(shape.columns.rows(), shape.columns.cols()))
    {
        Eigen::MatrixXd wide_numbers(shape.columns.rows(), 0), narrow_numbers(shape.columns.rows(), 0);
        for (Eigen::Index j = 0; j < shape.columns.cols(); ++j) {
            const double largest = shape.columns.col(j).cwiseAbs().maxCoeff(),
                         moved = largest * shape.samples.row(j).cwiseAbs().maxCoeff();
            if (moved < unit && use_8) continue;
            const bool is_narrow = use_8 && moved / 127 / 2 < unit;
            const double scale = largest / (is_narrow ? 127 : 32767);
            const Eigen::VectorXd numbers = (shape.columns.col(j) / scale).array().round();
            packed.col(j) = numbers * scale;
            Eigen::MatrixXd& out = is_narrow ? narrow_numbers : wide_numbers;
            out.conservativeResize(Eigen::NoChange, out.cols() + 1);
            out.rightCols(1) = numbers;
            (is_narrow ? narrow_scales : wide_scales).push_back(float(scale));
            (is_narrow ? narrow_columns : wide_columns).push_back(j);
        }
        wide = tile<std::int16_t>(wide_numbers);
        narrow = tile<std::int8_t>(narrow_numbers);
    }
    double bytes() const { return 2.0 * double(wide.size()) + double(narrow.size()); }
};

FOR_AVX2 void rebuild_columns(const float* rest, std::size_t tiles, const std::int16_t* wide, const float* wide_q,
                              std::size_t wide_count, const std::int8_t* narrow, const float* narrow_q,
                              std::size_t narrow_count, float* out)
{
    for (std::size_t t = 0; t < tiles; ++t, rest += lanes, out += lanes) {
        float sum[lanes];
        std::memcpy(sum, rest, sizeof sum);
        for (std::size_t j = 0; j < wide_count; ++j, wide += lanes)
            for (std::size_t i = 0; i < lanes; ++i) sum[i] += wide_q[j] * float(wide[i]);
        for (std::size_t j = 0; j < narrow_count; ++j, narrow += lanes)
            for (std::size_t i = 0; i < lanes; ++i) sum[i] += narrow_q[j] * float(narrow[i]);
        std::memcpy(out, sum, sizeof sum);
    }
}

void print_row(const char* layout, const Shape& shape, double bytes, double error, double time, double bandwidth)
{
    const double numbers = double(shape.columns.size()), shape_size = 4.0 * double(shape.rest.size());
    const double read = bytes + shape_size, moved = read + shape_size;
    fmt::print("| {:<32} | {:5.2f} | {:8.1e} | {:7.3f} | {:5.1f} | {:4.0f} % | {:4.0f} % |\n", layout, bytes / numbers,
               error / shape.diagonal, 1e3 * time, 1e-9 * read / time, 100 * read / time / bandwidth,
               100 * moved / time / bandwidth);
}

void measure_columns(const char* name, const Shape& shape, double unit, bool use_8, double bandwidth)
{
    const ColumnLayout layout(shape, unit, use_8);
    const std::vector<float> rest = tile<float>(shape.rest);
    std::vector<float> out(rest.size()), wide_q(layout.wide_scales), narrow_q(layout.narrow_scales);
    const double time = seconds(
        [&] {
            rebuild_columns(rest.data(), rest.size() / lanes, layout.wide.data(), wide_q.data(), wide_q.size(),
                            layout.narrow.data(), narrow_q.data(), narrow_q.size(), out.data());
        },
        50);
    print_row(name, shape, layout.bytes(), largest_error(shape.columns, layout.packed, shape.samples), time, bandwidth);
}

// ---------------------------------------------------------------------------------------------------- the runtime's layouts
// --

// An asset of nothing but a shape.
double time_runtime(const Shape& shape, pliant_asset& asset)
{
    const std::vector<float> rest = tile<float>(shape.rest);
    asset.vertex_count = std::uint32_t(shape.rest.size() / 3);
    asset.dimension = std::uint32_t(shape.columns.cols());
    asset.rest = rest.data();
    const Eigen::VectorXf q = shape.samples.col(0).cast<float>();
    std::vector<float> out(3 * std::size_t(asset.vertex_count));
    return seconds([&] { pliant_reconstruct(&asset, q.data(), 0, asset.vertex_count, out.data(), 12); }, 50);
}

void measure_single(const Shape& shape, double bandwidth)
{
    const std::vector<float> basis = tile<float>(shape.columns);
    pliant_asset asset {};
    asset.basis = basis.data();
    const double time = time_runtime(shape, asset);
    print_row("single precision (BASI)", shape, 4.0 * double(basis.size()),
              largest_error(shape.columns, shape.columns.cast<float>().cast<double>(), shape.samples), time, bandwidth);
}

void measure_compact(const Shape& shape, double error, double bandwidth)
{
    Eigen::MatrixXd packed = shape.columns;
    const std::optional<CompactBasis> compact = pack_basis(packed, shape.samples, error);
    if (!compact) {
        fmt::print("| tiles of fields (BASC): more than 24 bits |\n");
        return;
    }
    std::vector<std::uint64_t> aligned(compact->chunk.size() / 8 + 1);
    std::memcpy(aligned.data(), compact->chunk.data(), compact->chunk.size());
    const auto* start = reinterpret_cast<const unsigned char*>(aligned.data());
    pliant_format_compact head;
    std::memcpy(&head, start, sizeof head);
    const std::uint32_t d = std::uint32_t(packed.cols());
    pliant_asset asset {};
    asset.columns = reinterpret_cast<const pliant_format_column*>(start + sizeof head);
    asset.tiles = reinterpret_cast<const pliant_format_tile*>(start + pliant_format_compact_tiles(d));
    asset.fields = reinterpret_cast<const pliant_format_field*>(start + pliant_format_compact_fields(d, head.tile_count));
    asset.data = reinterpret_cast<const std::uint32_t*>(start + pliant_format_compact_data(d, head.tile_count));
    const double time = time_runtime(shape, asset);
    print_row("tiles of fields (BASC)", shape, double(compact->chunk.size()),
              largest_error(shape.columns, packed, shape.samples), time, bandwidth);
}

// How much wider the boxes are than the shapes, on each side, and what they cost.
void measure_bounds(const Shape& shape)
{
    const std::vector<std::uint8_t> chunk = encode_bounds(Eigen::Vector3d::Zero(), shape.rest, shape.columns, shape.samples);
    pliant_format_count head;
    std::memcpy(&head, chunk.data(), sizeof head);
    pliant_asset asset {};
    asset.dimension = std::uint32_t(shape.columns.cols());
    asset.cluster_count = head.count;
    asset.bounds = reinterpret_cast<const pliant_format_interval*>(chunk.data() + sizeof head);
    asset.rest = reinterpret_cast<const float*>(asset.bounds); // open, as far as boxes can tell
    float low[3], high[3];
    double mean = 0, largest = 0;
    for (Eigen::Index s = 0; s < shape.samples.cols(); ++s) {
        const Eigen::VectorXf q = shape.samples.col(s).cast<float>();
        pliant_bounds(&asset, q.data(), low, high);
        const Eigen::VectorXd exact = shape.rest + shape.columns * shape.samples.col(s);
        const Eigen::Map<const Eigen::Matrix3Xd> points(exact.data(), 3, exact.size() / 3);
        for (Eigen::Index c = 0; c < 3; ++c) {
            const double below = points.row(c).minCoeff() - double(low[c]),
                         above = double(high[c]) - points.row(c).maxCoeff();
            mean += (below + above) / double(6 * shape.samples.cols());
            largest = std::max({ largest, below, above });
        }
    }
    const Eigen::VectorXf q = shape.samples.col(0).cast<float>();
    const double time = seconds([&] { pliant_bounds(&asset, q.data(), low, high); }, 2000);
    fmt::print(
        "\nbox of {} clusters: wider by {:.2f} % of the diagonal a side (mean), {:.2f} % (largest); {:.1f} us, {:.1f} KiB\n",
        head.count, 100 * mean / shape.diagonal, 100 * largest / shape.diagonal, 1e6 * time, double(chunk.size()) / 1024);
}

void measure(const std::string& path, std::size_t vertex_count, double relative_error, double bandwidth)
{
    RuntimeBlender blender = RuntimeBlender::from_file(path);
    const Shape shape = load(path, vertex_count, blender);
    const double error = relative_error * shape.diagonal;
    fmt::print("\n{}: d = {}, {} vertices repeated to {}\n\n", path, shape.columns.cols(), blender.asset().vertex_count,
               vertex_count);
    fmt::print(
        "| layout | bytes a number | error / diagonal | ms | GB/s read | of the bandwidth | with the shape written |\n"
        "|---|---|---|---|---|---|---|\n");
    measure_single(shape, bandwidth);
    measure_columns("16 bits, a scale a column", shape, 0, false, bandwidth);
    measure_columns("0, 8 or 16 bits by amplitude", shape, error, true, bandwidth);
    measure_columns("0, 8 or 16 bits, a quarter of it", shape, error / 4, true, bandwidth);
    measure_compact(shape, error, bandwidth);
    measure_bounds(shape);
}

} // namespace

int main(int argc, char** argv)
{
    std::size_t vertex_count = 160000;
    double error = 1e-5;
    std::vector<std::string> paths;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--vertices" && i + 1 < argc)
            vertex_count = std::stoul(argv[++i]);
        else if (argument == "--error" && i + 1 < argc)
            error = std::stod(argv[++i]);
        else
            paths.push_back(argument);
    }
    try {
        const double bandwidth = read_bandwidth();
        fmt::print("one core reads {:.1f} GB/s\n", 1e-9 * bandwidth);
        for (const std::string& path : paths) measure(path, vertex_count, error, bandwidth);
    } catch (const Failure& failure) {
        for (const Diagnostic& branch : failure.branches()) print_finding("bench", branch);
        return 1;
    } catch (const std::exception& error_found) {
        fmt::print(stderr, "{}\n", error_found.what());
        return 1;
    }
    return 0;
}
