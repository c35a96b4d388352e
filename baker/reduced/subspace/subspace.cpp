#include "reduced/subspace/subspace.h"

#include "elastic/average/rigid_modes.h"
#include "elastic/average/shape_error.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

namespace {

// Vectors are unit: what is left of one below this after projection is rounding.
constexpr double rank_tolerance = 1e-9;

// Two poses whose vertices are all nearer to each other than this, in units of the character, are one pose in single
// precision. What is left of their difference is mostly a turn.
constexpr double least_difference = 1e-7;

// Orthonormal columns spanning `vectors`, after everything in `done` has been projected out, and the triangular factor:
// (vectors without done) = result * factor. Gram-Schmidt twice is as good as Householder here (Giraud et al. 2005) and works
// in any inner product. Vectors of which no component above `least` is left are left out.
struct Factored {
    Eigen::MatrixXd columns, factor;
};

Factored orthonormalise(const Eigen::MatrixXd& vectors, const Eigen::MatrixXd& done, const Eigen::VectorXd& masses,
                        double least)
{
    Factored out;
    out.columns.resize(vectors.rows(), vectors.cols());
    out.factor.setZero(vectors.cols(), vectors.cols());
    const Eigen::MatrixXd weighted_done = times_mass(done, masses);
    Eigen::Index rank = 0;
    for (Eigen::Index j = 0; j < vectors.cols(); ++j) {
        Eigen::VectorXd v = vectors.col(j);
        const double norm = mass_norm(v, masses);
        if (v.lpNorm<Eigen::Infinity>() <= least) continue;
        v /= norm;
        for (int pass = 0; pass < 2; ++pass) {
            v -= done * (weighted_done.transpose() * v);
            const Eigen::VectorXd along = out.columns.leftCols(rank).transpose() * times_mass(v, masses).col(0);
            v -= out.columns.leftCols(rank) * along;
            out.factor.col(j).head(rank) += along;
        }
        const double left = mass_norm(v, masses);
        if (left < rank_tolerance || norm * v.lpNorm<Eigen::Infinity>() <= least) continue;
        out.columns.col(rank) = v / left;
        out.factor(rank++, j) = left;
    }
    out.columns.conservativeResize(Eigen::NoChange, rank);
    out.factor.conservativeResize(rank, Eigen::NoChange);
    return out;
}

} // namespace

Subspace build_subspace(const NormalizedPoses& set, const Eigen::MatrixXd& vectors, Eigen::Index max_dimension)
{
    const Eigen::Index m = Eigen::Index(set.pose_count());
    Eigen::MatrixXd differences(set.dof_count(), m - 1);
    for (Eigen::Index k = 1; k < m; ++k) differences.col(k - 1) = set.shapes[std::size_t(k)] - set.shapes[0];
    const Eigen::MatrixXd none(set.dof_count(), 0);
    const Eigen::MatrixXd kept = orthonormalise(differences, none, set.masses, least_difference).columns;

    const Factored rest = orthonormalise(vectors, kept, set.masses, 0);
    Subspace subspace;
    subspace.rest = set.shapes[0];
    Eigen::Index extra = 0;
    Eigen::MatrixXd directions;
    if (rest.columns.cols() > 0) {
        const Eigen::BDCSVD<Eigen::MatrixXd> svd(rest.factor, Eigen::ComputeThinU);
        while (extra < svd.singularValues().size() && svd.singularValues()[extra] > rank_tolerance) ++extra;
        extra = std::min(extra, std::max<Eigen::Index>(0, max_dimension - kept.cols()));
        directions = rest.columns * svd.matrixU().leftCols(extra);
    }
    subspace.basis.resize(set.dof_count(), kept.cols() + extra);
    subspace.basis.leftCols(kept.cols()) = kept;
    if (extra > 0) subspace.basis.rightCols(extra) = directions;
    // Sums of equal coordinates are rounded, and fixed vertices are to be still to the bit.
    for (const std::uint32_t v : set.fixed_vertices) subspace.basis.middleRows(3 * Eigen::Index(v), 3).setZero();

    subspace.pose_coordinates.setZero(subspace.dimension(), m);
    if (m > 1) subspace.pose_coordinates.rightCols(m - 1) = subspace.basis.transpose() * times_mass(differences, set.masses);
    return subspace;
}

Subspace leading(const Subspace& subspace, Eigen::Index dimension)
{
    return { subspace.rest, subspace.basis.leftCols(dimension), subspace.pose_coordinates.topRows(dimension) };
}

Eigen::VectorXd project(const Subspace& subspace, const Shape& shape, const Eigen::VectorXd& masses)
{
    return subspace.basis.transpose() * times_mass(shape - subspace.rest, masses);
}

SubspaceError subspace_error(const Subspace& subspace, const NormalizedPoses& set, const std::vector<CheckPoint>& checks)
{
    SubspaceError out;
    for (const CheckPoint& check : checks) {
        const Shape nearest = subspace.shape(project(subspace, check.reference, set.masses));
        const double error = relative_error(set, nearest, check.reference);
        out.mean += error / double(checks.size());
        out.largest = std::max(out.largest, error);
    }
    return out;
}

} // namespace pliant
