#include "blend/crowd.h"

#include "blend/error.h"
#include "blend/motion.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace pliant::player {
namespace {

constexpr std::size_t cache_line = 64; // each solver starts on its own line

// Width of the crowd over its depth: about the proportions of the floor in a picture from a low angle.
constexpr double breadth = 1.5;

} // namespace

Crowd::Crowd(const AssetFile& file, const glm::mat3& to_world, std::uint32_t count)
    : file_(file)
    , to_world_(to_world)
    , q_(count, std::vector<float>(file.view().dimension))
    , weights_(file.view().weight_count)
    , positions_(file.view().vertex_count)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    solver_bytes_ = pliant_solver_memory(&file.view(), &desc);
    const std::size_t stride = (solver_bytes_ + cache_line - 1) / cache_line * cache_line;
    memory_.resize(stride * count + cache_line);
    void* first = memory_.data();
    std::size_t room = memory_.size();
    std::align(cache_line, stride * count, first, room);
    for (std::uint32_t i = 0; i < count; ++i) {
        pliant_solver* solver = nullptr;
        const pliant_result result
            = pliant_solver_init(&solver, &file.view(), &desc, static_cast<std::byte*>(first) + i * stride, solver_bytes_);
        if (result != PLIANT_OK) {
            throw Error(ErrorNumber::asset_refused, ExitCode::bad_input, file.path() + ": " + pliant_result_text(result),
                        "bake the asset again");
        }
        solvers_.push_back(solver);
    }
}

void Crowd::solve(const std::vector<std::vector<double>>& weights, BlendMode mode, CrowdCost& cost)
{
    const Stopwatch watch;
    cost.evaluations = cost.not_converged = 0;
    for (std::uint32_t i = 0; i < count(); ++i) {
        if (mode == BlendMode::linear) {
            blend_linearly(file_.view(), weights[i], q_[i]);
            continue;
        }
        std::copy(weights[i].begin(), weights[i].end(), weights_.begin());
        pliant_solve_info info {};
        const pliant_result result = pliant_solve(solvers_[i], weights_.data(), q_[i].data(), &info);
        if (result != PLIANT_OK) refuse_weights(file_.view(), result);
        cost.evaluations += info.evaluations;
        cost.not_converged += info.status != PLIANT_STATUS_CONVERGED;
    }
    cost.solve_us = watch.microseconds();
}

void Crowd::reconstruct(CrowdCost& cost)
{
    cost.reconstruct_us = cost.normals_us = 0.0;
    vertices_.resize(count(), std::vector<Vertex>(file_.view().vertex_count));
    for (std::uint32_t i = 0; i < count(); ++i) {
        const Stopwatch reconstruct;
        pliant_reconstruct(&file_.view(), q_[i].data(), 0, file_.view().vertex_count, &positions_[0].x,
                           sizeof positions_[0]);
        cost.reconstruct_us += reconstruct.microseconds();
        const Stopwatch normals;
        compute_normals(file_.view(), positions_, vertices_[i]);
        stand_on_floor(to_world_, positions_, vertices_[i]);
        cost.normals_us += normals.microseconds();
    }
}

std::vector<std::vector<double>> crowd_weights(std::uint32_t count, double phase, const ControlPolygon& polygon,
                                               const std::optional<WeightPath>& path)
{
    std::vector<std::vector<double>> weights;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double own = phase + i * 0.6180339887498949; // the golden ratio: neighbours start far apart
        weights.push_back(path ? path->at(own * static_cast<double>(path->count()))
                               : polygon.weights(polygon.idle_point(own)));
    }
    return weights;
}

double loop_seconds(const ControlPolygon& polygon, const std::optional<WeightPath>& path, double fps)
{
    return path ? static_cast<double>(path->count()) / fps : seconds_per_edge * polygon.corner_count();
}

std::vector<glm::vec3> crowd_places(std::uint32_t count, glm::vec2 room)
{
    const double across = std::sqrt(static_cast<double>(count) * breadth * room.y / std::max(room.x, 1e-30f));
    const std::uint32_t columns = std::clamp(static_cast<std::uint32_t>(std::lround(across)), 1u, count);
    std::vector<glm::vec3> places;
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t row = i / columns;
        const float shift = row % 2 == 1 ? 0.5f : 0.0f;
        places.emplace_back((static_cast<float>(i % columns) + shift) * room.x, 0.0f, -static_cast<float>(row) * room.y);
        sum += places.back();
    }
    for (glm::vec3& place : places) place -= sum / static_cast<float>(count);
    return places;
}

float crowd_variation(std::uint32_t character)
{
    const double share = std::fmod(character * 0.7548776662466927, 1.0); // another irrational number than that of the phases
    return static_cast<float>(2.0 * (share < 0.5 ? share : share - 1.0));
}

Extent extent_with_turns(const Extent& one)
{
    const glm::vec3 axis = (one.lowest + one.highest) * 0.5f, half = (one.highest - one.lowest) * 0.5f;
    const float c = std::cos(largest_crowd_turn), s = std::sin(largest_crowd_turn);
    const glm::vec3 reach { half.x + s * half.z, half.y, half.z + s * half.x }; // at least that of each turn
    Extent all { axis - reach, axis + reach, one.outline };
    for (const float side : { s, -s }) {
        for (const glm::vec3& point : one.outline) {
            const glm::vec3 from = point - axis;
            all.outline.push_back(axis + glm::vec3(c * from.x + side * from.z, from.y, c * from.z - side * from.x));
        }
    }
    return all;
}

Extent extent_of_crowd(const Extent& one, const std::vector<glm::vec3>& places)
{
    glm::vec3 nearest(std::numeric_limits<float>::max()), farthest(std::numeric_limits<float>::lowest());
    for (const glm::vec3& place : places) {
        nearest = glm::min(nearest, place);
        farthest = glm::max(farthest, place);
    }
    // The corners of the box around all places outline whatever stands in it.
    Extent all { one.lowest + nearest, one.highest + farthest, {} };
    for (float x : { nearest.x, farthest.x }) {
        for (float z : { nearest.z, farthest.z })
            for (const glm::vec3& point : one.outline) all.outline.push_back(point + glm::vec3(x, 0.0f, z));
    }
    return all;
}

} // namespace pliant::player
