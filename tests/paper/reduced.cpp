#include "reduced.h"

#include "base/common/diagnostics.h"
#include "elastic/average/rigid_modes.h"

#include <Eigen/Dense>
#include <fmt/core.h>

namespace pliant {

namespace {

// Coordinates of the point of the subspace nearest to the reference average, rigidly moved as suits it best.
Eigen::VectorXd nearest_point(const NormalizedPoses& set, const Subspace& subspace, const Shape& reference)
{
    // Over q and the rigid motion of the reference average at once, since a space may hold turned shapes better:
    // Gauss-Newton with the rigid modes as further columns. It converges quadratically; from a copy aligned with pose 0
    // three turns are plenty.
    const Eigen::Index d = subspace.dimension();
    Eigen::MatrixXd columns(set.dof_count(), d + 6);
    columns.leftCols(d) = subspace.basis;
    Shape moved = reference;
    for (int turn = 0; turn < 3; ++turn) {
        columns.rightCols<6>() = rigid_modes(moved, set.masses);
        const Eigen::MatrixXd weighted = times_mass(columns, set.masses);
        // Rank-revealing: a basis may contain rigid motions itself.
        const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> gram(columns.transpose() * weighted);
        const Eigen::VectorXd q = gram.solve(weighted.transpose() * (moved - subspace.rest)).head(d);
        moved = reference;
        apply(best_rigid_motion(reference, subspace.shape(q), set.masses), moved);
    }
    return project(subspace, moved, set.masses);
}

} // namespace

std::string weights_cell(const Weights& w)
{
    std::string text;
    for (double value : w) text += fmt::format("{}{:.6g}", text.empty() ? "" : ";", value);
    return text;
}

Eigen::MatrixXd solve_reduced(const Energy& energy, const NormalizedPoses& set, const Subspace& subspace,
                              const std::vector<Reference>& references)
{
    const ReducedEnergy reduced(energy, subspace);
    Eigen::MatrixXd out(subspace.dimension(), Eigen::Index(references.size()));
    for (std::size_t i = 0; i < references.size(); ++i) {
        const Eigen::VectorXd start = nearest_point(set, subspace, references[i].shape);
        out.col(Eigen::Index(i)) = minimize_newton(reduced, references[i].weights, start, 1e-6, 40).q;
    }
    return out;
}

double projection_error(const NormalizedPoses& set, const Subspace& subspace, const Shape& reference)
{
    return relative_distance(set, subspace.shape(nearest_point(set, subspace, reference)), reference);
}

Subspace leading_part(const Subspace& subspace, Eigen::Index d)
{
    return { subspace.rest, subspace.basis.leftCols(d), subspace.pose_coordinates.topRows(d) };
}

Subspace subspace_of(const RuntimeBlender& blender, const NormalizedPoses& set, const std::string& path)
{
    const pliant_asset& asset = blender.asset();
    const auto refuse = [&](const char* why) {
        throw Failure(ExitCode::bad_input,
                      error_at(5104, path, why, "bake it from these poses, in this order, with --position-error 0"));
    };
    if (asset.pose_count != set.pose_count() || Eigen::Index(asset.vertex_count) * 3 != set.dof_count())
        refuse("has other poses or another mesh");
    const auto shape_at = [&](const std::vector<float>& q) { return from_input_units(set, blender.positions(q)); };
    Subspace subspace;
    subspace.rest = shape_at(std::vector<float>(asset.dimension, 0.0f));
    subspace.basis.resize(set.dof_count(), asset.dimension);
    for (std::uint32_t j = 0; j < asset.dimension; ++j) {
        std::vector<float> q(asset.dimension, 0.0f);
        q[j] = 1;
        subspace.basis.col(j) = shape_at(q) - subspace.rest;
    }
    subspace.pose_coordinates.resize(asset.dimension, Eigen::Index(set.pose_count()));
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        subspace.pose_coordinates.col(Eigen::Index(k)) = project(subspace, set.shapes[k], set.masses);
        // Leading parts must hold the poses too, so the first columns span the differences.
        const Subspace differences = leading_part(subspace, Eigen::Index(set.pose_count()) - 1);
        const Shape pose = differences.shape(project(differences, set.shapes[k], set.masses));
        if ((pose - set.shapes[k]).norm() > 1e-4 * set.shapes[k].norm()) // single precision leaves 1e-6
            refuse("does not hold these poses in its first columns");
    }
    return subspace;
}

} // namespace pliant
