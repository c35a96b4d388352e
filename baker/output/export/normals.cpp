#include "output/export/normals.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Added to the Gram matrix (of numbers in [0,1], so of a size near the number of samples) relative to the number of samples:
// keeps deltas small along what the samples do not tell apart. On the creature of the samples (42 targets) 1e-6 costs
// nothing that shows (mean
// 0.04 degrees, as with 0), 1e-4 makes it 0.19 degrees.
constexpr double ridge = 1e-6;

// A base normal shorter than this, of normals that were of unit length, would blow up its deltas when it is brought to unit
// length.
constexpr double shortest_base = 0.1;

} // namespace

Eigen::VectorXd vertex_normals(const Eigen::VectorXd& positions, const std::vector<std::uint32_t>& triangles,
                               const std::vector<std::uint32_t>& groups)
{
    const auto at = [&](std::uint32_t v) -> Eigen::Vector3d { return positions.segment<3>(3 * Eigen::Index(v)); };
    const auto place = [&](std::size_t v) { return 3 * Eigen::Index(groups.empty() ? v : groups[v]); };
    const Eigen::Index most = groups.empty() ? 0 : 3 * (Eigen::Index(*std::max_element(groups.begin(), groups.end())) + 1);
    Eigen::VectorXd sums = Eigen::VectorXd::Zero(std::max(positions.size(), most));
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
        const Eigen::Vector3d corner = at(triangles[t]);
        const Eigen::Vector3d area = (at(triangles[t + 1]) - corner).cross(at(triangles[t + 2]) - corner);
        for (std::size_t c = 0; c < 3; ++c) sums.segment<3>(place(triangles[t + c])) += area;
    }
    Eigen::VectorXd normals(positions.size());
    for (Eigen::Index v = 0; v < normals.size() / 3; ++v) {
        const Eigen::Vector3d sum = sums.segment<3>(place(std::size_t(v)));
        const double length = sum.norm();
        normals.segment<3>(3 * v) = length > 0 ? Eigen::Vector3d(sum / length) : sum;
    }
    return normals;
}

NormalFit::NormalFit(std::size_t vertex_count, Eigen::Index target_count)
    : gram_(Eigen::MatrixXd::Zero(target_count + 1, target_count + 1))
    , moment_(Eigen::MatrixXd::Zero(3 * Eigen::Index(vertex_count), target_count + 1))
{
}

void NormalFit::add(const Eigen::MatrixXd& weights, const Eigen::MatrixXd& normals)
{
    Eigen::MatrixXd features(weights.rows() + 1, weights.cols());
    features << Eigen::RowVectorXd::Ones(weights.cols()), weights;
    gram_ += features * features.transpose();
    moment_.noalias() += normals * features.transpose();
    count_ += double(weights.cols());
}

// Where the fitted base is too short to be scaled to unit length, the base is the direction of the mean normal and the
// deltas alone are fitted: (w^T w) delta = moment - w^T 1 base.
NormalFit::Result NormalFit::solve() const
{
    const Eigen::Index d = gram_.cols() - 1;
    Eigen::MatrixXd gram = gram_;
    gram.diagonal().tail(d).array() += ridge * count_;
    const Eigen::MatrixXd fit = gram.ldlt().solve(moment_.transpose()).transpose();
    const auto fallback = Eigen::MatrixXd(gram.bottomRightCorner(d, d)).ldlt();
    Result result { fit.col(0), fit.rightCols(d) };
    for (Eigen::Index v = 0; v < result.base.size(); v += 3) {
        const double length = result.base.segment<3>(v).norm();
        if (length >= shortest_base) {
            result.base.segment<3>(v) /= length;
            result.deltas.middleRows<3>(v) /= length;
            continue;
        }
        const Eigen::Vector3d mean = moment_.block<3, 1>(v, 0);
        const Eigen::Vector3d base = mean.norm() > 0 ? mean.normalized().eval() : Eigen::Vector3d::UnitZ().eval();
        const Eigen::MatrixXd right = moment_.block(v, 1, 3, d).transpose() - gram_.col(0).tail(d) * base.transpose();
        result.base.segment<3>(v) = base;
        result.deltas.middleRows<3>(v) = fallback.solve(right).transpose();
    }
    return result;
}

void NormalErrorMeter::add(const NormalFit::Result& fit, const Eigen::VectorXd& weights, const Eigen::VectorXd& normals)
{
    const Eigen::VectorXd fitted = fit.base + fit.deltas * weights;
    for (Eigen::Index v = 0; v < normals.size(); v += 3) {
        const Eigen::Vector3d a = fitted.segment<3>(v), b = normals.segment<3>(v);
        if (b.squaredNorm() == 0) continue; // no area there, no normal
        const double degrees = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI;
        if (!(degrees >= 0)) continue; // of shapes without bounds
        ++histogram_[std::size_t(degrees * 100)];
        sum_ += degrees;
        worst_ = std::max(worst_, degrees);
        ++count_;
    }
}

NormalError NormalErrorMeter::error() const
{
    if (count_ == 0) return {};
    std::uint64_t below = 0;
    std::size_t bin = 0;
    while (bin + 1 < histogram_.size() && double(below += histogram_[bin]) < 0.999 * double(count_)) ++bin;
    return { sum_ / double(count_), worst_, double(bin + 1) / 100 };
}

} // namespace pliant
