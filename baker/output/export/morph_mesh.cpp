#include "output/export/morph_mesh.h"

#include <fmt/format.h>

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

// Of coordinates (d x blends).
Eigen::MatrixXf weights_of(const MorphMesh& mesh, const Eigen::MatrixXf& coordinates)
{
    Eigen::MatrixXf all(coordinates.rows(), coordinates.cols());
    for (Eigen::Index i = 0; i < all.cols(); ++i) all.col(i) = mesh.weights(coordinates.col(i));
    return all;
}

// The weights of as many mixed blends, the poses and their mean.
Eigen::MatrixXf blend_weights(RuntimeBlender& blender, const MorphMesh& mesh, std::size_t count, std::uint64_t seed)
{
    return weights_of(mesh, blend_coordinates(blender, blender.domain().covering(count, seed)));
}

Box box_of_blends(const MorphMesh& mesh)
{
    Box box;
    for (const Eigen::MatrixXf* weights : { &mesh.fitted, &mesh.judged, &mesh.frames })
        for_each_batch(mesh.base.size(), weights->cols(), [&](Eigen::Index first, Eigen::Index count) {
            const Eigen::MatrixXd shapes = mesh.shapes(weights->middleCols(first, count));
            for (Eigen::Index i = 0; i < count; ++i) box.include(shapes.col(i));
        });
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(box_margin * box.diagonal());
    box.low -= margin;
    box.high += margin;
    return box;
}

NormalFit::Result fit_normals(const DrawnSpace& space, const MorphMesh& mesh)
{
    NormalFit fit(space.vertex_count(), mesh.deltas.cols());
    for_each_batch(mesh.base.size(), mesh.fitted.cols(), [&](Eigen::Index first, Eigen::Index count) {
        const Eigen::MatrixXf weights = mesh.fitted.middleCols(first, count);
        Eigen::MatrixXd normals = mesh.shapes(weights);
        for (Eigen::Index i = 0; i < count; ++i) normals.col(i) = drawn_normals(space, normals.col(i));
        fit.add(weights.cast<double>(), normals);
    });
    return fit.solve();
}

template <class Numbers> bool are_drawable(const Numbers& numbers)
{
    constexpr float largest = 1e18f;                 // of the coordinates of meshes
    return (numbers.array().abs() <= largest).all(); // false for nan
}

// The format allows any numbers, glTF does not.
[[noreturn]] void refuse(const std::string& path, const char* what)
{
    throw Failure(
        ExitCode::bad_input,
        error_at(5102, path, fmt::format("not a usable asset: its {}", what), "the file is damaged: copy or bake it again"));
}

void require_drawable(bool is_drawable, const std::string& path)
{
    if (!is_drawable) refuse(path, "shapes have coordinates that are not finite or beyond 1e18");
}

} // namespace

void require_usable_weights(const Eigen::MatrixXf& weights, const std::string& path)
{
    constexpr float largest = 1e6f;                // within their ranges they are in [0, 1]
    if (!(weights.array().abs() <= largest).all()) // nan, too
        refuse(path, "morph ranges give weights that are not finite or beyond 1e6");
}

void Box::include(const Eigen::VectorXd& positions)
{
    const auto points = Eigen::Map<const Eigen::Matrix3Xd>(positions.data(), 3, positions.size() / 3);
    low = low.cwiseMin(points.rowwise().minCoeff());
    high = high.cwiseMax(points.rowwise().maxCoeff());
}

DrawnSpace drawn_space(const RuntimeBlender& blender, const std::string& path)
{
    const pliant_asset& asset = blender.asset();
    DrawnSpace space;
    space.path = path;
    space.triangles.assign(asset.triangles, asset.triangles + 3 * std::size_t(asset.triangle_count));
    if (asset.smoothing_groups)
        space.groups.assign(asset.smoothing_groups, asset.smoothing_groups + asset.boundary_vertex_count);
    space.at_zero = boundary_positions(blender, std::vector<float>(asset.dimension, 0.0f));
    space.first_pose = Eigen::Map<const Eigen::VectorXf>(pliant_asset_pose_coordinates(&asset, 0), asset.dimension);
    space.columns.resize(space.at_zero.size(), asset.dimension);
    for (std::uint32_t j = 0; j < asset.dimension; ++j) space.columns.col(j) = column_of(blender, j, space.at_zero);
    bool is_drawable = are_drawable(space.at_zero) && are_drawable(space.columns);
    for (std::uint32_t k = 0; is_drawable && k < asset.pose_count; ++k)
        is_drawable = are_drawable(boundary_positions(blender, blender.pose_coordinates(k)));
    require_drawable(is_drawable, path);
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

Eigen::MatrixXd MorphMesh::shapes(const Eigen::MatrixXf& weights) const
{
    Eigen::MatrixXf moved = deltas * weights;
    moved.colwise() += base;
    return moved.cast<double>();
}

MorphMesh make_morph_mesh(RuntimeBlender& blender, const DrawnSpace& space, const Eigen::MatrixXf& path, bool with_normals)
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
    const Eigen::VectorXd base = space.shape(mesh.ranges.low);
    const Eigen::MatrixXd deltas = space.columns * width.cast<double>().asDiagonal();
    require_drawable(are_drawable(base) && are_drawable(deltas), space.path);
    mesh.base = base.cast<float>();
    mesh.deltas = deltas.cast<float>();
    mesh.fitted = blend_weights(blender, mesh, fitted_count(d), fit_seed);
    mesh.judged = blend_weights(blender, mesh, judged_count, judge_seed);
    mesh.frames = weights_of(mesh, path);
    mesh.poses.resize(d, asset.pose_count);
    for (std::uint32_t k = 0; k < asset.pose_count; ++k)
        mesh.poses.col(k) = mesh.weights(Eigen::Map<const Eigen::VectorXf>(pliant_asset_pose_coordinates(&asset, k), d));
    for (const Eigen::MatrixXf* weights : { &mesh.fitted, &mesh.judged, &mesh.frames, &mesh.poses })
        require_usable_weights(*weights, space.path);
    mesh.reachable = box_of_blends(mesh);
    if (!with_normals) return mesh;
    mesh.normals = fit_normals(space, mesh);
    mesh.normal_error = normal_error_of(mesh.normals, mesh, space);
    return mesh;
}

NormalError normal_error_of(const NormalFit::Result& normals, const MorphMesh& mesh, const DrawnSpace& space)
{
    NormalErrorMeter meter;
    for_each_batch(mesh.base.size(), mesh.judged.cols(), [&](Eigen::Index first, Eigen::Index count) {
        const Eigen::MatrixXf weights = mesh.judged.middleCols(first, count);
        const Eigen::MatrixXd shapes = mesh.shapes(weights);
        for (Eigen::Index i = 0; i < count; ++i)
            meter.add(normals, weights.col(i).cast<double>(), drawn_normals(space, shapes.col(i)));
    });
    return meter.error();
}

} // namespace pliant
