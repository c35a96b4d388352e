#include "output/export/export_parts.h"
#include "output/export/skinning.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

using Json = Glb::Json;

// Shapes that bones and weights are fitted to, beside poses and mean: a multiple of the bones that are usual; as many
// others only judge.
constexpr std::size_t blend_count = 48;
constexpr std::uint64_t bone_fit_seed = 15485863, bone_judge_seed = 32452843;

Eigen::Matrix3Xd as_columns(const Eigen::VectorXd& positions)
{
    return Eigen::Map<const Eigen::Matrix3Xd>(positions.data(), 3, positions.size() / 3);
}

std::vector<Eigen::Matrix3Xd> shapes_of(const DrawnSpace& space, const Eigen::MatrixXf& coordinates)
{
    std::vector<Eigen::Matrix3Xd> shapes;
    for (Eigen::Index i = 0; i < coordinates.cols(); ++i) shapes.push_back(as_columns(space.shape(coordinates.col(i))));
    return shapes;
}

// The bones of the fitted shape whose coordinates are nearest.
const BonePose& nearest_pose(const SkinFit& fit, const Eigen::MatrixXf& fitted, const Eigen::VectorXf& q)
{
    Eigen::Index nearest = 0;
    (fitted.colwise() - q).colwise().squaredNorm().minCoeff(&nearest);
    return fit.poses[std::size_t(nearest)];
}

struct Distances {
    double square_sum = 0, largest = 0;
    std::size_t count = 0;

    void add(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b)
    {
        const Eigen::VectorXd squares = (a - b).colwise().squaredNorm();
        square_sum += squares.sum();
        largest = std::max(largest, std::sqrt(squares.maxCoeff()));
        count += std::size_t(squares.size());
    }
};

// JOINTS_0 and WEIGHTS_0 of a part. Sums of float weights are 1 to rounding, as glTF asks.
void add_influences(Glb& glb, const Skin& skin, const ScenePart& part, Json& attributes)
{
    std::vector<std::uint16_t> joints;
    std::vector<float> weights;
    for (std::size_t v = part.first_vertex; v < part.first_vertex + std::size_t(part.vertex_count); ++v)
        for (std::size_t i = 0; i < max_influences; ++i) {
            const float weight = float(skin.influences[v].weights[i]);
            weights.push_back(weight);
            joints.push_back(weight > 0 ? skin.influences[v].bones[i] : std::uint16_t(0));
        }
    attributes["JOINTS_0"] = glb.add_joints(joints);
    attributes["WEIGHTS_0"] = glb.add_floats(weights, 4, Glb::Target::vertices);
}

// A joint at rest stands at its bone's centre, unturned. Engines ignore the place of a skinned mesh's node, so the matrices
// lead from the grid of whole numbers to input units.
void add_joints(Glb& glb, const Skin& skin, const Grid& grid)
{
    Json& json = glb.json();
    std::vector<float> inverse;
    Json joints = Json::array(), children = Json::array();
    json["nodes"] = Json::array({ Json::object(), Json::object() }); // the mesh's, and the joints' parent
    for (std::size_t b = 0; b < skin.bone_count; ++b) {
        const Eigen::Vector3d centre = skin.centre(b);
        Eigen::Matrix4f bind = Eigen::Matrix4f::Identity();
        bind.topRightCorner<3, 1>() = (grid.origin - centre).cast<float>();
        if (grid.step > 0) bind.topLeftCorner<3, 3>() *= float(grid.step);
        inverse.insert(inverse.end(), bind.data(), bind.data() + 16);
        joints.push_back(b + 2);
        json["nodes"].push_back({ { "name", fmt::format("bone{}", b) },
                                  { "translation", { float(centre[0]), float(centre[1]), float(centre[2]) } } });
    }
    json["nodes"][1] = { { "name", "bones" }, { "children", joints } };
    const std::size_t matrices = glb.add_floats(inverse, 16, Glb::Target::none);
    json["skins"] = Json::array({ { { "inverseBindMatrices", matrices }, { "joints", joints }, { "skeleton", 1 } } });
}

void animate_joints(Glb& glb, const Skin& skin, const std::vector<BonePose>& frames, double frames_per_second)
{
    const std::size_t input = add_times(glb, frames.size(), frames_per_second);
    Json samplers = Json::array(), channels = Json::array();
    const auto add = [&](std::size_t bone, const char* path, const std::vector<float>& values, int width) {
        const std::size_t output = glb.add_floats(values, width, Glb::Target::none);
        channels.push_back({ { "sampler", samplers.size() }, { "target", { { "node", bone + 2 }, { "path", path } } } });
        samplers.push_back({ { "input", input }, { "interpolation", "LINEAR" }, { "output", output } });
    };
    for (std::size_t b = 0; b < skin.bone_count; ++b) {
        const Eigen::Vector3d centre = skin.centre(b);
        std::vector<float> places, turns;
        Eigen::Quaterniond last = Eigen::Quaterniond::Identity();
        for (const BonePose& frame : frames) {
            const Eigen::Vector3d place = frame[b] * centre;
            Eigen::Quaterniond turn(frame[b].rotation);
            if (turn.dot(last) < 0) turn.coeffs() *= -1; // the same rotation, on the side of the last frame's
            last = turn.normalized();
            for (int c = 0; c < 3; ++c) places.push_back(float(place[c]));
            for (int c = 0; c < 4; ++c) turns.push_back(float(last.coeffs()[c])); // x y z w, as glTF has them
        }
        add(b, "translation", places, 3);
        add(b, "rotation", turns, 4);
    }
    glb.json()["animations"] = Json::array({ { { "name", "path" }, { "samplers", samplers }, { "channels", channels } } });
}

// The bones that go on from the last frame, unless these are far from the shape: a path may jump.
BonePose better_bones(const Skin& skin, const Eigen::Matrix3Xd& shape, BonePose bones, const BonePose& last)
{
    constexpr double clearly = 0.8;
    BonePose going_on = fit_bones(skin, shape, last);
    const auto distance = [&](const BonePose& pose) { return (skin.shape(pose) - shape).norm(); };
    return distance(bones) < clearly * distance(going_on) ? std::move(bones) : std::move(going_on);
}

} // namespace

Json add_skinned_mesh(Glb& glb, RuntimeBlender& blender, const DrawnSpace& space, const RenderScene& scene,
                      const ExportOptions& options, ExportReport& report, Grid& grid)
{
    const Eigen::MatrixXf fitted = blend_coordinates(blender, blender.domain().covering(blend_count, bone_fit_seed));
    const Eigen::MatrixXf judged = blend_coordinates(blender, blender.domain().covering(blend_count, bone_judge_seed));
    const Eigen::MatrixXf path = path_coordinates(blender, options.path);
    const Eigen::VectorXd rest = space.rest();
    const SkinFit fit = fit_skin(as_columns(rest), shapes_of(space, fitted), std::size_t(options.bone_count));
    Distances distances;
    Box box;
    std::vector<BonePose> frames;
    for (Eigen::Index i = 0; i < judged.cols() + path.cols(); ++i) {
        const bool is_frame = i >= judged.cols();
        const Eigen::VectorXf q = is_frame ? path.col(i - judged.cols()) : judged.col(i);
        const Eigen::VectorXd shape = space.shape(q);
        BonePose bones = fit_bones(fit.skin, as_columns(shape), nearest_pose(fit, fitted, q));
        if (!frames.empty()) bones = better_bones(fit.skin, as_columns(shape), std::move(bones), frames.back());
        distances.add(as_columns(shape), fit.skin.shape(bones));
        box.include(shape);
        if (is_frame) frames.push_back(std::move(bones));
    }
    Json primitives = add_primitives(glb, scene, stored_rest(space, options, report, grid), {});
    for (std::size_t i = 0; i < scene.parts.size(); ++i)
        add_influences(glb, fit.skin, scene.parts[i], primitives[i]["attributes"]);
    add_joints(glb, fit.skin, grid);
    if (!frames.empty()) animate_joints(glb, fit.skin, frames, options.frames_per_second);
    report.bone_count = fit.skin.bone_count;
    report.frame_count = frames.size();
    report.diagonal = box.diagonal();
    report.skin_rms = std::sqrt(distances.square_sum / double(distances.count)) / report.diagonal;
    report.skin_largest = distances.largest / report.diagonal;
    return {
        { "primitives", primitives },
        { "extras",
          { { "pliant",
              { { "skin_error_of_diagonal", { { "rms", report.skin_rms }, { "largest", report.skin_largest } } } } } } }
    };
}

} // namespace pliant
