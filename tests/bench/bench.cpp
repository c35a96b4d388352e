// What a character costs: one row per set of poses. Bakes with the default options, then times the C runtime on one core.
//   pliant_bench NAME POSE... [-- NAME POSE...]... [--csv FILE] [--krylov] [--dim N] [--material NAME] [--checks N]
// --krylov bakes with Algorithm 1 of the paper (d = 64 for five poses) instead of the adaptive subspace; --checks N sets how
// many unreduced averages the error is measured on. Times are medians; ratios inside one run mean more than any of them
// alone.
#include "bake/bake.h"
#include "bake/certificate.h"
#include "cli/console.h"
#include "input/io/write_file.h"
#include "input/poses/load_poses.h"
#include "output/asset/asset_facts.h"
#include "output/asset/runtime_blender.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fmt/core.h>
#include <numeric>

using namespace pliant;

namespace {

using Clock = std::chrono::steady_clock;

double microseconds_since(Clock::time_point start)
{
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

double median(std::vector<double> values)
{
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
    return values[values.size() / 2];
}

struct Solves {
    double microseconds, iterations, evaluations; // median, means
    int unconverged;
};

// Solves along a list of weights, as a game would call it.
template <class NextWeights> Solves time_solves(RuntimeBlender& blender, int count, bool continuous, NextWeights next)
{
    std::vector<double> times;
    Solves result {};
    for (int i = 0; i < count; ++i) {
        const std::vector<float> w = next(i);
        pliant_solve_info info;
        const auto start = Clock::now();
        blender.solve(w, continuous, &info);
        times.push_back(microseconds_since(start));
        result.iterations += double(info.iterations) / count;
        result.evaluations += double(info.evaluations) / count;
        result.unconverged += info.status != PLIANT_STATUS_CONVERGED;
    }
    result.microseconds = median(times);
    return result;
}

std::vector<float> to_floats(const Weights& w)
{
    const Eigen::VectorXf f = w.cast<float>();
    return std::vector<float>(f.data(), f.data() + f.size());
}

// Reads a buffer far larger than the caches; bytes per second, best of a few: what one core can get.
double read_bandwidth()
{
    std::vector<std::uint64_t> buffer(64u << 20, 1); // 512 MiB
    double best = 0;
    volatile std::uint64_t sink = 0;
    for (int i = 0; i < 5; ++i) {
        const auto start = Clock::now();
        std::uint64_t sums[8] = {};
        for (std::size_t j = 0; j < buffer.size(); j += 8)
            for (int k = 0; k < 8; ++k) sums[k] += buffer[j + std::size_t(k)];
        sink = std::accumulate(sums, sums + 8, sink + 0);
        best = std::max(best, double(buffer.size() * 8) / microseconds_since(start) * 1e6);
    }
    return best;
}

struct Row {
    std::string name;
    BakeReport report;
    double bake_seconds = 0, megabytes = 0;
    Solves drag {}, jump {};
    double reconstruct_us = 0, bandwidth_share = 0;
};

Row measure(const std::string& name, const std::vector<std::string>& paths, const BakeOptions& options, double bandwidth)
{
    Row row;
    row.name = name;
    ConsoleProgress progress("bench " + name, false);
    const auto start = Clock::now();
    const BakedAsset baked = bake(load_poses(paths), options, progress);
    progress.clear_line();
    row.bake_seconds = microseconds_since(start) * 1e-6;
    row.report = baked.report;
    row.megabytes = double(baked.bytes.size()) / 1048576.0;

    RuntimeBlender blender(baked.bytes, name);
    const std::size_t m = row.report.input.pose_count;
    // Slow drag: once around the simplex in 2,000 frames, about half a minute of a hand on the mouse.
    const auto drag = [&](int i) {
        Weights w(m);
        for (std::size_t k = 0; k < m; ++k)
            w[Eigen::Index(k)] = 1.05 + std::cos(6.283185307 * (i / 2000.0 + double(k) / double(m)));
        return to_floats(w);
    };
    row.drag = time_solves(blender, 2000, true, drag);
    Random random(99);
    row.jump = time_solves(blender, 1000, true, [&](int i) { return to_floats(random.weights(m, i % 2 == 0)); });

    const std::vector<float> q = blender.solve(to_floats(equal_weights(m)), false);
    std::vector<float> positions(3 * row.report.input.vertex_count);
    std::vector<double> times;
    for (int i = 0; i < 21; ++i) {
        const auto begin = Clock::now();
        pliant_reconstruct(&blender.asset(), q.data(), 0, std::uint32_t(row.report.input.vertex_count), positions.data(),
                           12);
        times.push_back(microseconds_since(begin));
    }
    row.reconstruct_us = median(times);
    row.bandwidth_share = double(frame_size(blender.asset())) / (row.reconstruct_us * 1e-6) / bandwidth;
    return row;
}

double seconds_of(const BakeReport& report, const std::string& stage)
{
    for (const StageTime& s : report.stages)
        if (s.stage == stage) return s.seconds;
    return 0;
}

// Mean over the blends that nothing was chosen by.
std::string fresh_error(const CheckReport& report)
{
    double sum = 0;
    int count = 0;
    for (const BlendCheck& check : report.blends) {
        sum += check.is_fresh ? check.error.relative_l2 : 0;
        count += check.is_fresh;
    }
    return count ? fmt::format("{:.1e}", sum / count) : "-";
}

// One cell per column: for the table on screen and for the CSV file.
std::vector<std::pair<std::string, std::string>> cells(const Row& r)
{
    return { { "set", r.name },
             { "n", std::to_string(r.report.input.vertex_count) },
             { "m", std::to_string(r.report.input.pose_count) },
             { "d", std::to_string(r.report.fit.dimension) },
             { "elements", std::to_string(r.report.fit.element_count) },
             { "mean s", fmt::format("{:.1f}", seconds_of(r.report, "mean")) },
             { "subspace s", fmt::format("{:.1f}", seconds_of(r.report, "subspace")) },
             { "surrogate s", fmt::format("{:.1f}", seconds_of(r.report, name_of(r.report.fit.kind))) },
             { "check s", fmt::format("{:.1f}", seconds_of(r.report, "check")) },
             { "bake s", fmt::format("{:.1f}", r.bake_seconds) },
             { "MiB", fmt::format("{:.1f}", r.megabytes) },
             { "us/evaluation", fmt::format("{:.2f}", r.jump.microseconds / r.jump.evaluations) },
             { "drag it", fmt::format("{:.1f}", r.drag.iterations) },
             { "drag us", fmt::format("{:.1f}", r.drag.microseconds) },
             { "jump it", fmt::format("{:.1f}", r.jump.iterations) },
             { "jump us", fmt::format("{:.1f}", r.jump.microseconds) },
             { "not converged", std::to_string(r.drag.unconverged + r.jump.unconverged) },
             { "reconstruct us", fmt::format("{:.0f}", r.reconstruct_us) },
             { "of bandwidth", fmt::format("{:.0f} %", 100 * r.bandwidth_share) },
             { "fresh L2", fresh_error(r.report.check) } };
}

void print(const std::vector<Row>& rows, double bandwidth)
{
    fmt::print("read bandwidth of one core: {:.1f} GB/s\n\n", bandwidth * 1e-9);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::string head = "|", rule = "|", line = "|";
        for (const auto& [name, value] : cells(rows[i])) {
            head += " " + name + " |";
            rule += "---|";
            line += " " + value + " |";
        }
        if (i == 0) fmt::print("{}\n{}\n", head, rule);
        fmt::print("{}\n", line);
    }
}

std::string csv(const std::vector<Row>& rows)
{
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::string head, line;
        for (const auto& [name, value] : cells(rows[i])) {
            head += (head.empty() ? "" : ",") + name;
            line += (line.empty() ? "" : ",") + value;
        }
        if (i == 0) text += head + "\n";
        text += line + "\n";
    }
    return text;
}

Material material_named(const std::string& name)
{
    for (Material m : { Material::discrete_shells, Material::arap, Material::stvk, Material::mooney_rivlin })
        if (name == name_of(m)) return m;
    throw Failure(ExitCode::usage, error_at(1101, "", "unknown material " + name, "as `pliant bake --help` lists them"));
}

} // namespace

int main(int argc, char** argv)
try {
    BakeOptions options;
    std::string csv_path;
    std::vector<std::vector<std::string>> sets(1);
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--"))
            sets.emplace_back();
        else if (!std::strcmp(argv[i], "--csv") && i + 1 < argc)
            csv_path = argv[++i];
        else if (!std::strcmp(argv[i], "--krylov"))
            options.subspace = SubspaceKind::krylov;
        else if (!std::strcmp(argv[i], "--dim") && i + 1 < argc)
            options.dimension = std::stoi(argv[++i]);
        else if (!std::strcmp(argv[i], "--material") && i + 1 < argc)
            options.energy.material = material_named(argv[++i]);
        else if (!std::strcmp(argv[i], "--checks") && i + 1 < argc)
            options.check_count = std::stoi(argv[++i]);
        else
            sets.back().push_back(argv[i]);
    }
    const double bandwidth = read_bandwidth();
    std::vector<Row> rows;
    for (const auto& set : sets) {
        if (set.size() < 3) {
            fmt::print(stderr,
                       "usage: pliant_bench NAME POSE POSE... [-- NAME POSE POSE...]... [--csv FILE] [--krylov] [--dim N] "
                       "[--material NAME] [--checks N]\n");
            return int(ExitCode::usage);
        }
        rows.push_back(measure(set[0], { set.begin() + 1, set.end() }, options, bandwidth));
    }
    print(rows, bandwidth);
    if (!csv_path.empty()) write_file_atomically(csv_path, csv(rows));
    return 0;
} catch (const Failure& failure) {
    for (const Diagnostic& branch : failure.branches()) print_finding("bench", branch);
    return int(failure.code());
}
