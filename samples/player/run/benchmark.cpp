#include "run/benchmark.h"

#include "blend/control_polygon.h"
#include "blend/crowd.h"
#include "draw/gl_context.h"
#include "draw/gl_objects.h"
#include "draw/gpu_crowd.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pliant::player {
namespace {

struct Spread {
    double median = 0.0, high = 0.0; // high: the 95th percentile
};

template <typename Cost, typename Field> Spread spread(const std::vector<Cost>& costs, Field field)
{
    std::vector<double> values;
    for (const Cost& cost : costs) values.push_back(static_cast<double>(field(cost)));
    std::sort(values.begin(), values.end());
    return { values[values.size() / 2], values[values.size() * 95 / 100] };
}

void print_json_row(const char* name, const Spread& s)
{
    std::printf(",\n  \"%s\": { \"median\": %.3f, \"p95\": %.3f }", name, s.median, s.high);
}

void print_json_layers(const AssetFile& file)
{
    if (file.has_layers()) std::printf(",\n  \"layers\": %zu", file.weights().size());
}

void print_text_row(const char* name, const Spread& s) { std::printf("%-11s %8.1f   %8.1f  us\n", name, s.median, s.high); }

// Reconstructs crowds on the graphics card, with an offscreen context.
class GpuBench {
public:
    GpuBench(const AssetFile& file, const Options& options)
        : context_(make_offscreen_context())
        , canvas_(16, 16)
        , crowd_(file, options.to_world(), static_cast<std::uint32_t>(options.crowd), {}, context_->loader())
    {
    }
    void rebuild(const Crowd& crowd, CrowdCost& cost) { crowd_.rebuild(crowd, cost); }
    std::string driver() const { return context_->renderer_name(); }
    std::string path() const { return crowd_.path_name(); }

private:
    std::unique_ptr<GlContext> context_;
    Canvas canvas_; // transform feedback requires a framebuffer
    GpuCrowd crowd_;
};

using Row = std::pair<const char*, Spread>;

// The measured steps besides the solves; they differ between graphics card and processor.
std::vector<Row> rebuild_rows(const std::vector<CrowdCost>& costs, bool on_gpu)
{
    const auto row = [&](const char* name, double CrowdCost::*field) {
        return Row { name, spread(costs, [&](const CrowdCost& c) { return c.*field; }) };
    };
    if (on_gpu) return { row("placing", &CrowdCost::placing_us), row("update", &CrowdCost::update_us) };
    return { row("reconstruct", &CrowdCost::reconstruct_us), row("normals", &CrowdCost::normals_us) };
}

// Each frame blends the whole crowd and advances every character on its loop as in a window with 60 frames per second.
void run_crowd(const Options& options, const AssetFile& file)
{
    const pliant_asset& asset = file.view();
    const ControlPolygon polygon(asset.pose_count);
    const std::optional<WeightPath> path = path_for(options, file);
    const BlendMode mode = options.linear ? BlendMode::linear : BlendMode::elastic;
    Crowd crowd(file, options.to_world(), static_cast<std::uint32_t>(options.crowd));
    std::optional<GpuBench> gpu;
    if (options.rebuild == Rebuild::gpu) gpu.emplace(file, options);
    const double step = 1.0 / (60.0 * loop_seconds(polygon, path, options.fps));
    std::vector<CrowdCost> costs;
    std::uint64_t not_converged = 0;
    for (int frame = 0; frame < options.benchmark_frames; ++frame) {
        CrowdCost cost;
        crowd.solve(crowd_weights(crowd.count(), frame * step, polygon, path), mode, cost);
        if (gpu)
            gpu->rebuild(crowd, cost);
        else
            crowd.reconstruct(cost);
        costs.push_back(cost);
        not_converged += cost.not_converged;
    }
    const Spread solve = spread(costs, [](const CrowdCost& c) { return c.solve_us; });
    const std::vector<Row> rebuild = rebuild_rows(costs, gpu.has_value());
    const Spread evaluations = spread(costs, [](const CrowdCost& c) { return c.evaluations; });
    const char* blend = options.linear ? "linear" : "elastic";
    if (options.json) {
        std::printf(
            "{\n  \"blend\": \"%s\",\n  \"frames\": %d,\n  \"characters\": %u,\n  \"vertices\": %u,\n  \"poses\": %u", blend,
            options.benchmark_frames, crowd.count(), asset.vertex_count, asset.pose_count);
        print_json_layers(file);
        std::printf(",\n  \"dimension\": %u,\n  \"solver_bytes\": %zu,\n  \"solves_not_converged\": %llu", asset.dimension,
                    crowd.solver_bytes() * crowd.count(), static_cast<unsigned long long>(not_converged));
        if (gpu)
            std::printf(",\n  \"rebuilt_by\": \"%s\",\n  \"driver\": \"%s\"", gpu->path().c_str(), gpu->driver().c_str());
        print_json_row("solve_us", solve);
        for (const auto& [name, values] : rebuild) print_json_row((std::string(name) + "_us").c_str(), values);
        print_json_row("evaluations", evaluations);
        std::printf("\n}\n");
        return;
    }
    std::printf("%s: %s blend, %u characters, %d frames, %u vertices, %s, d = %u; all numbers are for the whole crowd\n",
                file.path().c_str(), blend, crowd.count(), options.benchmark_frames, asset.vertex_count,
                file.counted().c_str(), asset.dimension);
    if (gpu) std::printf("shapes rebuilt by pliant::gl: %s, %s\n", gpu->path().c_str(), gpu->driver().c_str());
    std::printf("              median        p95\n");
    print_text_row("solve", solve);
    for (const auto& [name, values] : rebuild) print_text_row(name, values);
    std::printf("evaluations %8.0f   %8.0f\n", evaluations.median, evaluations.high);
    std::printf("solves that did not converge: %llu\n", static_cast<unsigned long long>(not_converged));
}

} // namespace

void run_benchmark(const Options& options, const AssetFile& file)
{
    if (options.crowd > 0) {
        run_crowd(options, file);
        return;
    }
    const std::optional<WeightPath> path = path_for(options, file);
    const pliant_asset& asset = file.view();
    const ControlPolygon polygon(asset.pose_count);
    const BlendMode mode = options.linear ? BlendMode::linear : BlendMode::elastic;
    Character character(file, options.to_world());
    std::vector<BlendCost> costs;
    int not_converged = 0;
    float outside = 0.0f;
    for (int frame = 0; frame < options.benchmark_frames; ++frame) {
        const double phase = static_cast<double>(frame) / options.benchmark_frames;
        const std::vector<double> weights
            = path ? path->at(phase * static_cast<double>(path->count())) : polygon.weights(polygon.idle_point(phase));
        costs.push_back(character.blend(weights, mode));
        outside = std::max(outside, costs.back().info.outside);
        if (costs.back().info.status != PLIANT_STATUS_CONVERGED) ++not_converged;
    }
    const Spread solve = spread(costs, [](const BlendCost& c) { return c.solve_us; });
    const Spread reconstruct = spread(costs, [](const BlendCost& c) { return c.reconstruct_us; });
    const Spread normals = spread(costs, [](const BlendCost& c) { return c.normals_us; });
    const Spread iterations = spread(costs, [](const BlendCost& c) { return c.info.iterations; });
    const Spread evaluations = spread(costs, [](const BlendCost& c) { return c.info.evaluations; });
    const char* blend = options.linear ? "linear" : "elastic";
    if (options.json) {
        std::printf("{\n  \"blend\": \"%s\",\n  \"frames\": %d,\n  \"vertices\": %u,\n  \"poses\": %u,\n  \"dimension\": %u",
                    blend, options.benchmark_frames, asset.vertex_count, asset.pose_count, asset.dimension);
        print_json_layers(file);
        std::printf(",\n  \"frames_not_converged\": %d", not_converged);
        if (file.has_layers()) std::printf(",\n  \"largest_outside\": %.6g", outside);
        print_json_row("solve_us", solve);
        print_json_row("reconstruct_us", reconstruct);
        print_json_row("normals_us", normals);
        print_json_row("iterations", iterations);
        print_json_row("evaluations", evaluations);
        std::printf("\n}\n");
        return;
    }
    std::printf("%s: %s blend, %d frames along the %s path, %u vertices, %s, d = %u\n", file.path().c_str(), blend,
                options.benchmark_frames, options.path.empty() ? "idle" : "given", asset.vertex_count,
                file.counted().c_str(), asset.dimension);
    std::printf("              median        p95\n");
    print_text_row("solve", solve);
    print_text_row("reconstruct", reconstruct);
    print_text_row("normals", normals);
    std::printf("iterations  %8.0f   %8.0f\n", iterations.median, iterations.high);
    std::printf("evaluations %8.0f   %8.0f\n", evaluations.median, evaluations.high);
    std::printf("frames that did not converge: %d\n", not_converged);
    if (outside > 0.0f) std::printf("weights outside the measured ranges: by up to %.3g of their width\n", outside);
}

} // namespace pliant::player
