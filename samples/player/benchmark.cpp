#include "benchmark.h"

#include "control_polygon.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace pliant::player {

namespace {

struct Spread {
    double median = 0.0, high = 0.0; // high: 95 of 100 are below
};

template <typename Field> Spread spread(const std::vector<BlendCost>& costs, Field field)
{
    std::vector<double> values;
    for (const BlendCost& cost : costs) values.push_back(static_cast<double>(field(cost)));
    std::sort(values.begin(), values.end());
    return { values[values.size() / 2], values[values.size() * 95 / 100] };
}

void print_json_row(const char* name, const Spread& s)
{
    std::printf(",\n  \"%s\": { \"median\": %.3f, \"p95\": %.3f }", name, s.median, s.high);
}

} // namespace

void run_benchmark(const Options& options, const AssetFile& file)
{
    const pliant_asset& asset = file.view();
    const ControlPolygon polygon(asset.pose_count);
    const BlendMode mode = options.linear ? BlendMode::linear : BlendMode::elastic;
    Character character(file, options.to_world());
    std::vector<BlendCost> costs;
    int not_converged = 0;
    for (int frame = 0; frame < options.benchmark_frames; ++frame) {
        const double phase = static_cast<double>(frame) / options.benchmark_frames;
        costs.push_back(character.blend(polygon.weights(polygon.idle_point(phase)), mode));
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
        std::printf(",\n  \"frames_not_converged\": %d", not_converged);
        print_json_row("solve_us", solve);
        print_json_row("reconstruct_us", reconstruct);
        print_json_row("normals_us", normals);
        print_json_row("iterations", iterations);
        print_json_row("evaluations", evaluations);
        std::printf("\n}\n");
        return;
    }
    std::printf("%s: %s blend, %d frames along the idle path, %u vertices, %u poses, d = %u\n", file.path().c_str(), blend,
                options.benchmark_frames, asset.vertex_count, asset.pose_count, asset.dimension);
    std::printf("              median        p95\n");
    std::printf("solve       %8.1f   %8.1f  us\n", solve.median, solve.high);
    std::printf("reconstruct %8.1f   %8.1f  us\n", reconstruct.median, reconstruct.high);
    std::printf("normals     %8.1f   %8.1f  us\n", normals.median, normals.high);
    std::printf("iterations  %8.0f   %8.0f\n", iterations.median, iterations.high);
    std::printf("evaluations %8.0f   %8.0f\n", evaluations.median, evaluations.high);
    std::printf("frames that did not converge: %d\n", not_converged);
}

} // namespace pliant::player
