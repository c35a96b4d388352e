#include "blend/character.h"

#include "blend/error.h"
#include "blend/layer_walk.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace pliant::player {

void CostHistory::add(const BlendCost& cost)
{
    costs_[count_ % costs_.size()] = cost;
    ++count_;
}

double CostHistory::median(double BlendCost::*field) const
{
    const std::size_t count = std::min(count_, costs_.size());
    if (count == 0) return 0.0;
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(costs_[i].*field);
    std::nth_element(values.begin(), values.begin() + count / 2, values.end());
    return values[count / 2];
}

Character::Character(const AssetFile& file, const glm::mat3& to_world)
    : file_(file)
    , to_world_(to_world)
    , q_(file.view().dimension)
    , positions_(file.view().vertex_count)
    , vertices_(file.view().vertex_count)
{
    const pliant_solver_desc desc = pliant_solver_desc_default();
    solver_memory_.resize(pliant_solver_memory(&file.view(), &desc));
    const pliant_result result
        = pliant_solver_init(&solver_, &file.view(), &desc, solver_memory_.data(), solver_memory_.size());
    if (result != PLIANT_OK) {
        throw Error(ErrorNumber::asset_refused, ExitCode::bad_input, file.path() + ": " + pliant_result_text(result),
                    "bake the asset again");
    }
}

void Character::forget() { pliant_solver_reset(solver_); }

BlendCost Character::blend(const std::vector<double>& weights, BlendMode mode)
{
    BlendCost cost;
    const Stopwatch solve;
    if (mode == BlendMode::linear) {
        blend_linearly(file_.view(), weights, q_);
    } else {
        const std::vector<float> weights_f32(weights.begin(), weights.end());
        const pliant_result result = pliant_solve(solver_, weights_f32.data(), q_.data(), &cost.info);
        if (result != PLIANT_OK) refuse_weights(file_.view(), result);
    }
    cost.solve_us = solve.microseconds();

    const Stopwatch reconstruct;
    pliant_reconstruct(&file_.view(), q_.data(), 0, file_.view().vertex_count, &positions_[0].x, sizeof positions_[0]);
    cost.reconstruct_us = reconstruct.microseconds();

    const Stopwatch normals;
    compute_normals(file_.view(), positions_, vertices_);
    cost.normals_us = normals.microseconds();
    stand_on_floor(to_world_, positions_, vertices_);
    return cost;
}

void Character::show(const std::vector<glm::vec3>& positions)
{
    std::copy(positions.begin(), positions.end(), positions_.begin());
    std::fill(positions_.begin() + static_cast<std::ptrdiff_t>(positions.size()), positions_.end(), positions.front());
    compute_normals(file_.view(), positions_, vertices_);
    stand_on_floor(to_world_, positions_, vertices_);
}

void Character::set_heat(const std::vector<float>& heat)
{
    for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v].heat = heat.empty() ? -1.0f : heat[v];
}

ExtentOfShapes::ExtentOfShapes()
    : furthest_(direction_count, std::numeric_limits<float>::lowest())
    , extent_ { glm::vec3(std::numeric_limits<float>::max()), glm::vec3(std::numeric_limits<float>::lowest()), {} }
{
    for (int i = 0; i < direction_count; ++i) { // evenly over the sphere: a Fibonacci spiral
        const float up = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / direction_count;
        const float level = std::sqrt(1.0f - up * up), angle = static_cast<float>(i) * 2.39996323f;
        directions_.emplace_back(level * std::cos(angle), up, level * std::sin(angle));
    }
    extent_.outline.resize(direction_count);
}

void ExtentOfShapes::add(const std::vector<Vertex>& vertices)
{
    for (const Vertex& vertex : vertices) {
        extent_.lowest = glm::min(extent_.lowest, vertex.position);
        extent_.highest = glm::max(extent_.highest, vertex.position);
        for (int i = 0; i < direction_count; ++i) {
            const float reach = glm::dot(directions_[i], vertex.position);
            if (reach <= furthest_[i]) continue;
            furthest_[i] = reach;
            extent_.outline[i] = vertex.position;
        }
    }
}

Extent extent_of_poses(Character& character)
{
    const pliant_asset& asset = character.file().view();
    ExtentOfShapes shapes;
    for (std::uint32_t k = 0; k < asset.pose_count; ++k) {
        character.blend(weights_of_pose(asset, k), BlendMode::linear);
        shapes.add(character.vertices());
    }
    if (!character.file().has_layers()) return shapes.extent();
    for (const std::vector<double>& weights : layer_keys(character.file().weights())) {
        character.forget();
        character.blend(weights, BlendMode::elastic);
        shapes.add(character.vertices());
    }
    character.forget();
    return shapes.extent();
}

void refuse_weights(const pliant_asset& asset, pliant_result result)
{
    throw Error(ErrorNumber::weights, ExitCode::usage, std::string("weights: ") + pliant_result_text(result),
                asset.has_layers ? "give one finite number per layer" : "give one number >= 0 per pose, not all zero");
}

} // namespace pliant::player
