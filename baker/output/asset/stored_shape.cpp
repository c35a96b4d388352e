#include "output/asset/stored_shape.h"

#include "output/asset/bounds.h"
#include "output/asset/factored_basis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

double largest_motion(const Eigen::VectorXd& column)
{
    double largest = 0;
    for (Eigen::Index i = 0; i < column.size(); i += 3) largest = std::max(largest, column.segment<3>(i).norm());
    return largest;
}

// As the asset has it.
Eigen::VectorXd rounded(const Eigen::VectorXd& values) { return values.cast<float>().cast<double>(); }

// The middle of the poses, if this one is far from them, as a single average far away makes it: the poses must not lose
// precision by large numbers that cancel.
Eigen::VectorXd near_poses(const Subspace& subspace, const Eigen::VectorXd& middle)
{
    const Eigen::MatrixXd& poses = subspace.pose_coordinates;
    const Eigen::VectorXd low = poses.rowwise().minCoeff(), high = poses.rowwise().maxCoeff(), centre = (low + high) / 2;
    return (middle - centre).norm() <= 4 * (high - low).norm() ? middle : centre;
}

} // namespace

Frame plain_frame(Eigen::Index dimension)
{
    return { Eigen::VectorXd::Zero(dimension), Eigen::MatrixXd::Identity(dimension, dimension) };
}

Frame principal_frame(const Subspace& subspace, const Eigen::MatrixXd& reachable)
{
    const Eigen::Index d = subspace.dimension();
    const Eigen::VectorXd mean = reachable.rowwise().mean();
    const Eigen::MatrixXd centred = reachable.colwise() - mean;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(centred * centred.transpose());
    const Eigen::MatrixXd along = axes.eigenvectors().transpose() * centred;
    const Eigen::VectorXd low = along.rowwise().minCoeff(), high = along.rowwise().maxCoeff();
    std::vector<Eigen::Index> order(static_cast<std::size_t>(d));
    std::iota(order.begin(), order.end(), 0);
    Eigen::VectorXd motion(d);
    for (Eigen::Index j = 0; j < d; ++j)
        motion[j] = (high[j] - low[j]) * largest_motion(subspace.basis * axes.eigenvectors().col(j));
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return motion[a] > motion[b]; });
    const Eigen::VectorXd middle = mean + axes.eigenvectors() * ((low + high) / 2);
    Frame frame = { near_poses(subspace, middle), Eigen::MatrixXd(d, d) };
    for (Eigen::Index j = 0; j < d; ++j) {
        frame.axes.col(j) = axes.eigenvectors().col(order[std::size_t(j)]);
        Eigen::Index largest = 0; // an axis has no direction of its own: one that does not depend on the solver's mood
        frame.axes.col(j).cwiseAbs().maxCoeff(&largest);
        if (frame.axes(largest, j) < 0) frame.axes.col(j) *= -1;
    }
    return frame;
}

StoredShape store_shape(const NormalizedPoses& set, const Subspace& subspace, const Embedding* embedding,
                        const Eigen::MatrixXd& reachable, double error, std::size_t boundary_count)
{
    const auto drawn = [&](const Eigen::MatrixXd& columns) { return embedding ? apply(*embedding, columns) : columns; };
    StoredShape out;
    Eigen::MatrixXd columns, samples;
    Eigen::VectorXd rest;
    if (error > 0) {
        out.frame = principal_frame(subspace, reachable);
        columns = set.length * drawn(subspace.basis * out.frame.axes);
        rest = set.length * Eigen::VectorXd(drawn(subspace.shape(out.frame.offset)));
        samples = reach_margin * (out.frame.axes.transpose() * (reachable.colwise() - out.frame.offset));
        if (std::optional<FactoredBasis> factored = factor_basis(rest, columns, samples, set.length * error, boundary_count);
            factored && factored->chunk.size() < std::size_t(columns.size()) * sizeof(float)) {
            out.basis = std::move(factored->chunk);
            out.largest_error = factored->largest_error / set.length;
        }
    }
    if (out.basis.empty()) {
        out.frame = plain_frame(subspace.dimension());
        samples = reachable;
        columns = (set.length * drawn(subspace.basis)).cast<float>().cast<double>();
        rest = rounded(set.length * Eigen::VectorXd(drawn(subspace.shape(out.frame.offset))));
    }
    out.rest = rest / set.length;
    out.bounds = encode_bounds(set.centre, rest, columns, samples);
    return out;
}

} // namespace pliant
