#include "base/mesh/align.h"

#include "base/mesh/tets.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

namespace {

using RowPoints = Eigen::Map<const Positions>;

// Of a pose against the mean of all. Poses that turn by 90 degrees to both sides leave no linear blend to lie at.
constexpr double most_turned = 75; // degrees

RowPoints rows(const Shape& shape) { return RowPoints(shape.data(), shape.size() / 3, 3); }

Eigen::Vector3d centroid(const Shape& shape, const Eigen::VectorXd& masses)
{
    return rows(shape).transpose() * masses / masses.sum();
}

} // namespace

RigidMotion best_rigid_motion(const Shape& from, const Shape& to, const Eigen::VectorXd& masses)
{
    const Eigen::Vector3d from_centre = centroid(from, masses), to_centre = centroid(to, masses);
    const Positions a = rows(from).rowwise() - from_centre.transpose();
    const Positions b = rows(to).rowwise() - to_centre.transpose();
    const Eigen::Matrix3d covariance = b.transpose() * masses.asDiagonal() * a;
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, 1);
    if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs[2] = -1;
    RigidMotion motion;
    motion.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
    motion.translation = to_centre - motion.rotation * from_centre;
    return motion;
}

double degrees_of(const RigidMotion& motion) { return Eigen::AngleAxisd(motion.rotation).angle() * 57.29577951308232; }

void apply(const RigidMotion& motion, Shape& shape)
{
    for (Eigen::Index i = 0; i < shape.size(); i += 3)
        shape.segment<3>(i) = (motion.rotation * shape.segment<3>(i) + motion.translation).eval();
}

void align_to(const NormalizedPoses& set, const Shape& target, Shape& shape)
{
    if (set.is_free()) apply(best_rigid_motion(shape, target, set.masses), shape);
}

Shape linear_blend(const NormalizedPoses& set, const Weights& w)
{
    const Weights shares = linear_shares(w, set.pose_count());
    Shape sum = Shape::Zero(set.dof_count());
    for (std::size_t k = 0; k < set.pose_count(); ++k)
        if (shares[Eigen::Index(k)] != 0) sum += shares[Eigen::Index(k)] * set.shapes[k];
    return sum;
}

// Closest means that sum_v m_v target_v x shape_v = 0; the turn keeps that zero.
void keep_aligned(const NormalizedPoses& set, const Shape& target, const Shape& shape, Eigen::MatrixXd& displacements)
{
    if (!set.is_free()) return;
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(3, displacements.cols());
    for (Eigen::Index v = 0; v < set.masses.size(); ++v) {
        const Eigen::Matrix3d arm = set.masses[v] * cross_matrix(target.segment<3>(3 * v));
        inertia += arm * cross_matrix(shape.segment<3>(3 * v));
        moments += arm * displacements.middleRows<3>(3 * v);
    }
    const Eigen::MatrixXd turns = inertia.partialPivLu().solve(moments);
    for (Eigen::Index v = 0; v < set.masses.size(); ++v)
        displacements.middleRows<3>(3 * v) -= cross_matrix(shape.segment<3>(3 * v)) * turns;
}

namespace {

Shape mean_shape(const std::vector<Shape>& shapes)
{
    Shape sum = shapes[0];
    for (std::size_t k = 1; k < shapes.size(); ++k) sum += shapes[k];
    return sum / double(shapes.size());
}

NormalizedPoses normalized(const PoseSet& poses, bool keep_placement)
{
    NormalizedPoses set;
    set.triangles = poses.triangles;
    set.tets = poses.tets;
    set.regions = poses.regions;
    set.source_vertices = poses.source_vertices;
    set.fixed_vertices = poses.fixed_vertices;
    const Eigen::Index n = Eigen::Index(poses.vertex_count());

    // Shapes relative to the middle of pose 0, so that a far-away origin costs no digits in what follows.
    const Eigen::Vector3d middle
        = 0.5 * (poses.positions[0].colwise().minCoeff() + poses.positions[0].colwise().maxCoeff()).transpose();
    double size = 0; // area or volume
    set.masses = Eigen::VectorXd::Zero(n);
    for (const Positions& positions : poses.positions) {
        const Eigen::Vector3d pose_middle = keep_placement
            ? middle
            : Eigen::Vector3d(0.5 * (positions.colwise().minCoeff() + positions.colwise().maxCoeff()).transpose());
        const Positions centred = positions.rowwise() - pose_middle.transpose();
        set.shapes.emplace_back(Eigen::Map<const Shape>(centred.data(), 3 * n));
        set.motions.emplace_back();
        set.motions.back().translation = -pose_middle;
        const Shape& shape = set.shapes.back();
        set.masses += cell_masses(set, shape) / double(poses.pose_count());
        size += cell_sizes(set, shape).sum() / double(poses.pose_count());
    }
    set.length = set.is_solid() ? std::cbrt(size) : std::sqrt(size);
    set.masses /= poses.repairs.lone_vertex_count == 0 ? size : set.masses.sum(); // of cells, the same but for rounding

    // The runtime adds the origin in single precision: round it once, here, so that both sides mean the same point.
    const Eigen::Vector3d centre = centroid(set.shapes[0], set.masses);
    set.centre = (middle + centre).cast<float>().cast<double>();
    const Eigen::Vector3d shift = middle - set.centre;
    const Shape rest = set.shapes[0]; // the loop moves and scales shapes[0] before the others are fitted to it
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        RigidMotion fit;
        if (!keep_placement && k > 0) fit = best_rigid_motion(set.shapes[k], rest, set.masses);
        apply(fit, set.shapes[k]);
        set.motions[k].rotation = fit.rotation;
        set.motions[k].translation = fit.rotation * set.motions[k].translation + fit.translation + middle;
        for (Eigen::Index i = 0; i < 3 * n; i += 3)
            set.shapes[k].segment<3>(i) = (set.shapes[k].segment<3>(i) + shift) / set.length;
    }
    const auto first = rows(set.shapes[0]);
    set.diagonal = (first.colwise().maxCoeff() - first.colwise().minCoeff()).norm();
    return set;
}

// The directions of edges of `from` against those of `to`, where both are long: by edges, not by moments, since a thin body
// that bends to both sides has a mean without width as well.
Eigen::Matrix3d edge_covariance(const NormalizedPoses& set, const Shape& from, const Shape& to)
{
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
        const Eigen::Vector3d x = from.segment<3>(3 * b) - from.segment<3>(3 * a),
                              y = to.segment<3>(3 * b) - to.segment<3>(3 * a);
        const double length2 = y.squaredNorm();
        if (length2 > 0) sum += (set.masses[a] + set.masses[b]) / length2 * x * y.transpose();
    };
    for (const Triangle& t : set.triangles)
        for (int i = 0; i < 3; ++i) add(t[std::size_t(i)], t[std::size_t((i + 1) % 3)]);
    return sum;
}

// A mean of poses that turn by half a turn against each other has collapsed, and how a pose turns against it is rounding.
bool is_collapsed(const NormalizedPoses& set, const Shape& mean, const Shape& pose)
{
    constexpr double least = 0.2; // of the pose's own; turns by most_turned to both sides leave 0.26
    const auto across = [](const Eigen::Matrix3d& covariance) {
        const Eigen::Vector3d values = covariance.jacobiSvd().singularValues();
        return values[1] + (covariance.determinant() < 0 ? -values[2] : values[2]);
    };
    return across(edge_covariance(set, mean, pose)) < least * across(edge_covariance(set, pose, pose));
}

bool is_frame(const NormalizedPoses& set, const Shape& mean)
{
    return std::all_of(set.shapes.begin(), set.shapes.end(), [&](const Shape& shape) {
        return degrees_of(best_rigid_motion(mean, shape, set.masses)) <= most_turned && !is_collapsed(set, mean, shape);
    });
}

} // namespace

NormalizedPoses normalize(const PoseSet& poses, bool keep_placement)
{
    if (!poses.fixed_vertices.empty()) return normalized(poses, true);
    if (!keep_placement && !poses.share_frame && poses.blend != Blend::layers) return normalized(poses, false);
    NormalizedPoses set = normalized(poses, true);
    set.frame = poses.blend == Blend::layers ? set.shapes[0] : mean_shape(set.shapes);
    const bool has_frame = poses.blend == Blend::layers || is_frame(set, set.frame);
    return has_frame ? set : normalized(poses, false);
}

double turned_degrees(const NormalizedPoses& set, std::size_t pose) { return degrees_of(set.motions[pose]); }

Positions to_input_units(const NormalizedPoses& set, const Shape& shape)
{
    Positions positions = set.length * rows(shape);
    positions.rowwise() += set.centre.transpose();
    return positions;
}

Shape from_input_units(const NormalizedPoses& set, const std::vector<float>& positions)
{
    Shape shape(Eigen::Index(positions.size()));
    for (Eigen::Index i = 0; i < shape.size(); ++i)
        shape[i] = (double(positions[std::size_t(i)]) - set.centre[i % 3]) / set.length;
    return shape;
}

} // namespace pliant
