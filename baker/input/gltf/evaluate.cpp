#include "input/gltf/evaluate.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

GltfValue find_deltas(const GltfValue& target, const char* attribute, GltfAllowance& allowance)
{
    constexpr std::uint64_t numbers_of_lookup = 16, numbers_of_deltas = 256; // what these cost, besides those read
    GltfValue deltas = target[attribute];
    allowance.take(target, deltas.exists() ? numbers_of_deltas : numbers_of_lookup);
    return deltas;
}

// Positions or normals in the mesh's own space.
GltfNumbers morphed(const GltfDocument& document, const GltfPrimitive& primitive, const std::vector<double>& weights,
                    const GltfNumbers& base, const char* attribute, GltfAllowance& allowance)
{
    GltfNumbers out = base;
    for (std::size_t k = 0; k < primitive.targets.size() && k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        const GltfValue deltas = find_deltas(primitive.targets.at(k), attribute, allowance);
        if (!deltas.exists()) continue;
        allowance.take_all_of(deltas);
        out += weights[k] * read_numbers(document, deltas, { 3 }, primitive.stored_count).topRows(out.rows());
    }
    return out;
}

// The primitives of a mesh at the weights that a node showed it with last; most nodes show it with the same.
struct MorphedMesh {
    std::vector<double> weights;
    std::vector<GltfNumbers> positions, normals; // a primitive; no normals: none are wanted, or it has none
};

void morph(const GltfDocument& document, const GltfMesh& mesh, const std::vector<double>& weights, bool has_normals,
           GltfAllowance& allowance, MorphedMesh& out)
{
    if (!out.positions.empty() && out.weights == weights) return;
    out = { weights, {}, {} };
    for (const GltfPrimitive& primitive : mesh.primitives) {
        out.positions.push_back(morphed(document, primitive, weights, primitive.positions, "POSITION", allowance));
        const auto normal = primitive.attributes.find("NORMAL");
        out.normals.push_back(has_normals && normal != primitive.attributes.end()
                                  ? morphed(document, primitive, weights, normal->second, "NORMAL", allowance)
                                  : GltfNumbers());
    }
}

// Of the grids of a mesh's primitives with those of its targets, at the weights that a node showed it with last.
struct MorphedSteps {
    std::vector<double> weights, steps;
};

// In whole numbers targets have the grid of the positions.
double step_of_target(const GltfDocument& document, const GltfPrimitive& primitive, const GltfValue& deltas,
                      GltfAllowance& allowance)
{
    if (accessor_shape(document, deltas).component_type != gltf_float32) return primitive.position_step;
    allowance.take_all_of(deltas);
    return step_of(document, deltas);
}

std::vector<double> morphed_steps(const GltfDocument& document, const GltfMesh& mesh, const std::vector<double>& weights,
                                  GltfAllowance& allowance)
{
    std::vector<double> steps;
    for (const GltfPrimitive& primitive : mesh.primitives) {
        steps.push_back(primitive.position_step);
        for (std::size_t k = 0; k < primitive.targets.size() && k < weights.size(); ++k) {
            if (weights[k] == 0) continue;
            const GltfValue deltas = find_deltas(primitive.targets.at(k), "POSITION", allowance);
            if (deltas.exists())
                steps.back() += std::abs(weights[k]) * step_of_target(document, primitive, deltas, allowance);
        }
    }
    return steps;
}

// Of normals: what keeps them at right angles, whatever the matrix does to lengths.
Eigen::Matrix3d cofactors(const Eigen::Matrix3d& m)
{
    Eigen::Matrix3d out;
    out << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
    return out;
}

// Rows of `out` from `first` on.
struct Rows {
    Positions& positions;
    Positions* normals;
    Eigen::Index first;

    void put(Eigen::Index v, const Eigen::Matrix4d& m, const GltfNumbers& p, const GltfNumbers* n) const
    {
        const Eigen::Vector3d position = p.row(v).transpose();
        positions.row(first + v) = (m.topLeftCorner<3, 3>() * position + m.topRightCorner<3, 1>()).transpose();
        if (!normals || !n) return;
        const Eigen::Vector3d normal = n->row(v).transpose();
        const Eigen::Matrix3d turn = m.topLeftCorner<3, 3>();
        // A mirrored instance has its triangles turned round, too.
        const double side = turn.determinant() < 0 ? -1 : 1;
        normals->row(first + v) = (side * (cofactors(turn) * normal)).normalized().transpose();
    }
};

// The matrices that place vertices, in a state of the nodes.
class Placing {
public:
    Placing(const GltfScene& scene, const GltfState& state)
        : world_(world_matrices(scene, state))
    {
        for (const GltfSkin& skin : scene.skins) { // nodes share them
            of_skins_.emplace_back();
            of_skins_.back().reserve(skin.joints.size());
            for (std::size_t j = 0; j < skin.joints.size(); ++j)
                of_skins_.back().push_back(world_[skin.joints[j]] * skin.inverse_bind[j]);
        }
    }

    // Of a vertex: of the joints of its skin, or of the node.
    Eigen::Matrix4d at(const GltfInstance& instance, const GltfPrimitive& primitive, Eigen::Index v) const
    {
        if (instance.skin < 0) return world_[instance.node];
        const std::vector<Eigen::Matrix4d>& matrices = of_skins_[static_cast<std::size_t>(instance.skin)];
        const Eigen::Index columns = primitive.weights.cols();
        Eigen::Matrix4d blend = Eigen::Matrix4d::Zero();
        for (Eigen::Index c = 0; c < columns; ++c)
            if (primitive.weights(v, c) != 0)
                blend += primitive.weights(v, c) * matrices[primitive.joints[static_cast<std::size_t>(v * columns + c)]];
        return blend;
    }

    // How far a vertex moves, at most, by a step of the grid of a primitive's positions and by one of its weights.
    double move_of_step(const GltfInstance& instance, const GltfPrimitive& primitive, double step) const
    {
        if (step == 0 && primitive.weight_step == 0) return 0;
        if (instance.skin < 0) return step * stretch(world_[instance.node]);
        double most_stretch = 0, most_spread = 0;
        for (Eigen::Index v = 0; v < primitive.positions.rows(); ++v) {
            most_stretch = std::max(most_stretch, stretch(at(instance, primitive, v)));
            if (primitive.weight_step > 0) most_spread = std::max(most_spread, spread(instance, primitive, v));
        }
        return step * most_stretch + primitive.weight_step * most_spread;
    }

private:
    static double stretch(const Eigen::Matrix4d& m) { return m.topLeftCorner<3, 3>().colwise().norm().maxCoeff(); }

    // How far apart its joints move a vertex.
    double spread(const GltfInstance& instance, const GltfPrimitive& primitive, Eigen::Index v) const
    {
        const std::vector<Eigen::Matrix4d>& matrices = of_skins_[static_cast<std::size_t>(instance.skin)];
        const Eigen::Vector4d from = primitive.positions.row(v).homogeneous();
        const Eigen::Index columns = primitive.weights.cols();
        Eigen::AlignedBox3d images;
        for (Eigen::Index c = 0; c < columns; ++c)
            if (primitive.weights(v, c) != 0)
                images.extend((matrices[primitive.joints[static_cast<std::size_t>(v * columns + c)]] * from).head<3>());
        return images.isEmpty() ? 0 : images.diagonal().norm();
    }

    std::vector<Eigen::Matrix4d> world_;
    std::vector<std::vector<Eigen::Matrix4d>> of_skins_;
};

} // namespace

Positions evaluate(const GltfScene& scene, const GltfState& state, GltfAllowance& allowance, Positions* normals)
{
    const Eigen::Index count = static_cast<Eigen::Index>(scene.vertex_count());
    Positions positions(count, 3);
    if (normals) *normals = Positions::Zero(count, 3);
    const Placing placing(scene, state);
    std::vector<MorphedMesh> meshes(scene.meshes.size());
    Eigen::Index first = 0;
    for (const GltfInstance& instance : scene.instances) {
        const GltfMesh& mesh = scene.meshes[instance.mesh];
        MorphedMesh& shape = meshes[instance.mesh];
        morph(*scene.document, mesh, state.weights[instance.node], normals != nullptr, allowance, shape);
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i) {
            const GltfNumbers &p = shape.positions[i], &n = shape.normals[i];
            const Rows rows { positions, normals, first };
            for (Eigen::Index v = 0; v < p.rows(); ++v)
                rows.put(v, placing.at(instance, mesh.primitives[i], v), p, n.size() == 0 ? nullptr : &n);
            first += p.rows();
        }
    }
    return positions;
}

std::vector<double> position_steps(const GltfScene& scene, const GltfState& state, GltfAllowance& allowance)
{
    const auto is_rounded = [](const GltfPrimitive& p) { return p.position_step > 0 || p.weight_step > 0; };
    const auto has_rounded
        = [&](const GltfMesh& m) { return std::any_of(m.primitives.begin(), m.primitives.end(), is_rounded); };
    if (std::none_of(scene.meshes.begin(), scene.meshes.end(), has_rounded)) return {};
    const Placing placing(scene, state);
    std::vector<double> steps;
    std::vector<MorphedSteps> meshes(scene.meshes.size());
    for (const GltfInstance& instance : scene.instances) {
        const GltfMesh& mesh = scene.meshes[instance.mesh];
        MorphedSteps& morphed = meshes[instance.mesh];
        const std::vector<double>& weights = state.weights[instance.node];
        if (morphed.steps.empty() || morphed.weights != weights)
            morphed = { weights, morphed_steps(*scene.document, mesh, weights, allowance) };
        for (std::size_t i = 0; i < mesh.primitives.size(); ++i)
            steps.push_back(placing.move_of_step(instance, mesh.primitives[i], morphed.steps[i]));
    }
    return steps;
}

std::vector<Triangle> triangles_of(const GltfScene& scene)
{
    std::vector<Triangle> out;
    std::uint32_t first = 0;
    const std::vector<Eigen::Matrix4d> world = world_matrices(scene, scene.rest);
    for (const GltfInstance& instance : scene.instances) {
        // Of a skinned mesh, too: "the determinant of the node's global transform defines the winding order".
        const bool is_turned = world[instance.node].topLeftCorner<3, 3>().determinant() < 0;
        for (const GltfPrimitive& primitive : scene.meshes[instance.mesh].primitives) {
            for (Triangle t : primitive.triangles) {
                for (std::uint32_t& v : t) v += first;
                if (is_turned) std::swap(t[1], t[2]);
                out.push_back(t);
            }
            first += static_cast<std::uint32_t>(primitive.vertex_count());
        }
    }
    return out;
}

} // namespace pliant
