#include "output/export/morph_mesh.h"

namespace pliant {

namespace {

// Shapes that normals are fitted to: some more than there are unknowns of a vertex.
std::size_t fitted_count(Eigen::Index dimension) { return 200 + 8 * std::size_t(dimension); }
constexpr std::size_t judged_count = 100; // shapes that only judge
constexpr std::uint64_t fit_seed = 104729, judge_seed = 1299709;

// Added to the box of the sampled shapes on each side, relative to its diagonal: samples miss the outermost point of an arc.
constexpr double box_margin = 0.02;

// A column is measured where it moves vertices this many times farther than they lie from the origin: the float positions of
// the runtime then resolve the column and not the place.
constexpr double magnification = 1024;

Eigen::VectorXd boundary_positions(const RuntimeBlender& blender, const std::vector<float>& q)
{
    const pliant_asset& asset = blender.asset();
    Eigen::VectorXf positions(3 * Eigen::Index(asset.boundary_vertex_count));
    pliant_reconstruct(&asset, q.data(), 0, asset.boundary_vertex_count, positions.data(), 3 * sizeof(float));
    return positions.cast<double>();
}

// What coordinate j moves per unit. The coordinate that moves far enough is found by trying: a basis may be of any scale,
// and a column may be zero, which takes all rounds. The runtime's floats may then overflow: infinity times zero.
Eigen::VectorXd column_of(const RuntimeBlender& blender, std::uint32_t j, const Eigen::VectorXd& at_zero)
{
    std::vector<float> q(blender.asset().dimension, 0.0f);
    const double far = magnification * std::max(at_zero.cwiseAbs().maxCoeff(), 1e-30);
    const auto moved = [&] { return (boundary_positions(blender, q) - at_zero).eval(); };
    q[j] = 1;
    for (int round = 0; round < 6; ++round) {
        const double most = moved().cwiseAbs().maxCoeff();
        if (most > 0.1 * far && most < 10 * far) break;
        q[j] *= float(most > 0 ? std::min(far / most, 1e6) : 1e6);
    }
    const Eigen::VectorXd far_moved = moved();
    return far_moved.allFinite() ? Eigen::VectorXd(far_moved / double(q[j])) : Eigen::VectorXd::Zero(far_moved.size());
}

Box box_of_targets(const MorphMesh& mesh)
{
    Box box;
    box.include(mesh.base.cast<double>());
    Eigen::Vector3d most = Eigen::Vector3d::Zero();
    for (Eigen::Index j = 0; j < mesh.deltas.cols(); ++j) {
        const auto delta = Eigen::Map<const Eigen::Matrix3Xf>(mesh.deltas.col(j).data(), 3, mesh.deltas.rows() / 3);
        most = most.cwiseMax(delta.cwiseAbs().rowwise().maxCoeff().cast<double>());
    }
    box.low -= most;
    box.high += most;
    return box;
}

void fit_normals(RuntimeBlender& blender, const DrawnSpace& space, MorphMesh& mesh)
{
    const Eigen::Index d = space.columns.cols();
    const std::size_t poses = blender.asset().pose_count;
    const auto fitted = blend_coordinates(blender, covering_weights(poses, fitted_count(d), fit_seed));
    const auto judged = blend_coordinates(blender, covering_weights(poses, judged_count, judge_seed));
    NormalFit fit(space.vertex_count(), d);
    const auto visit = [&](const Eigen::VectorXf& q, auto&& use) {
        const Eigen::VectorXd shape = space.shape(q);
        mesh.reachable.include(shape);
        use(mesh.weights(q).cast<double>().eval(), drawn_normals(space, shape));
    };
    for (Eigen::Index i = 0; i < fitted.cols(); ++i)
        visit(fitted.col(i), [&](const Eigen::VectorXd& w, const Eigen::VectorXd& normals) { fit.add(w, normals); });
    mesh.normals = fit.solve();
    NormalErrorMeter meter;
    for (Eigen::Index i = 0; i < judged.cols(); ++i)
        visit(judged.col(i),
              [&](const Eigen::VectorXd& w, const Eigen::VectorXd& normals) { meter.add(mesh.normals, w, normals); });
    mesh.normal_error = meter.error();
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(box_margin * mesh.reachable.diagonal());
    mesh.reachable.low -= margin;
    mesh.reachable.high += margin;
}

} // namespace

void Box::include(const Eigen::VectorXd& positions)
{
    const auto points = Eigen::Map<const Eigen::Matrix3Xd>(positions.data(), 3, positions.size() / 3);
    low = low.cwiseMin(points.rowwise().minCoeff());
    high = high.cwiseMax(points.rowwise().maxCoeff());
}

bool Box::contains(const Box& other) const
{
    return (low.array() <= other.low.array()).all() && (high.array() >= other.high.array()).all();
}

DrawnSpace drawn_space(const RuntimeBlender& blender)
{
    const pliant_asset& asset = blender.asset();
    DrawnSpace space;
    space.triangles.assign(asset.triangles, asset.triangles + 3 * std::size_t(asset.triangle_count));
    if (asset.smoothing_groups)
        space.groups.assign(asset.smoothing_groups, asset.smoothing_groups + asset.boundary_vertex_count);
    space.at_zero = boundary_positions(blender, std::vector<float>(asset.dimension, 0.0f));
    space.first_pose = Eigen::Map<const Eigen::VectorXf>(pliant_asset_pose_coordinates(&asset, 0), asset.dimension);
    space.columns.resize(space.at_zero.size(), asset.dimension);
    for (std::uint32_t j = 0; j < asset.dimension; ++j) space.columns.col(j) = column_of(blender, j, space.at_zero);
    return space;
}

Eigen::VectorXd drawn_normals(const DrawnSpace& space, const Eigen::VectorXd& shape)
{
    return vertex_normals(shape, space.triangles, space.groups);
}

Eigen::VectorXf MorphMesh::weights(const Eigen::VectorXf& q) const
{
    Eigen::VectorXf w(q.size());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
        const float width = ranges.high[j] - ranges.low[j];
        w[j] = width > 0 ? (q[j] - ranges.low[j]) / width : 0.0f;
    }
    return w;
}

MorphMesh make_morph_mesh(RuntimeBlender& blender, const DrawnSpace& space)
{
    MorphMesh mesh;
    const pliant_asset& asset = blender.asset();
    const Eigen::Index d = asset.dimension;
    mesh.has_stored_ranges = asset.morph_ranges != nullptr;
    if (mesh.has_stored_ranges) {
        mesh.ranges.low = Eigen::Map<const Eigen::VectorXf>(asset.morph_ranges, d);
        mesh.ranges.high = Eigen::Map<const Eigen::VectorXf>(asset.morph_ranges + asset.padded_dimension, d);
    } else {
        mesh.ranges = find_morph_ranges(blender);
    }
    const Eigen::VectorXf width = mesh.ranges.high - mesh.ranges.low;
    mesh.base = space.shape(mesh.ranges.low).cast<float>();
    mesh.deltas = (space.columns * width.cast<double>().asDiagonal()).cast<float>();
    mesh.engine_box = box_of_targets(mesh);
    fit_normals(blender, space, mesh);
    return mesh;
}

} // namespace pliant
