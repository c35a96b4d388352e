#include "elastic/parts/tie_set.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Where the places in the poses differ by this much from their mean (root mean square, in units of the diagonal), a tie has
// half of the largest stiffness. baker/THEORY.md has the measured effect of other values.
constexpr double half_stiffness_spread = 0.005;

// Mean over the poses of the 2 x 2 metric of the edges (b - a, c - a).
Eigen::Matrix2d mean_metric(const NormalizedPoses& set, std::uint32_t a, std::uint32_t b, std::uint32_t c)
{
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    for (const Shape& shape : set.shapes) {
        Eigen::Matrix<double, 3, 2> edges;
        edges << point(shape, b) - point(shape, a), point(shape, c) - point(shape, a);
        sum += edges.transpose() * edges;
    }
    return sum / double(set.pose_count());
}

} // namespace

double tie_stiffness(const Eigen::Matrix3Xd& rest, double diagonal)
{
    const Eigen::Vector3d mean = rest.rowwise().mean();
    const double spread2 = (rest.colwise() - mean).squaredNorm() / double(rest.cols());
    const double softening = 1 + spread2 / std::pow(half_stiffness_spread * diagonal, 2);
    return std::max(max_stiffness / softening, min_stiffness);
}

Tie make_tie(const NormalizedPoses& set, std::size_t part, const std::array<std::uint32_t, 4>& vertices)
{
    Tie tie;
    tie.vertices = vertices;
    tie.part = part;
    // If L L^T is the metric of (b - a, c - a), the columns of (b - a, c - a) L^-T have the identity as their metric.
    const Eigen::Matrix2d lower = mean_metric(set, vertices[1], vertices[2], vertices[3]).llt().matrixL();
    tie.frame = lower.transpose().inverse();
    tie.frame(1, 0) = 0;
    tie.rest.resize(3, Eigen::Index(set.pose_count()));
    for (std::size_t k = 0; k < set.pose_count(); ++k) {
        const Shape& shape = set.shapes[k];
        tie.rest.col(Eigen::Index(k)) = tie_place(tie_vectors(tie, point(shape, vertices[0]), point(shape, vertices[1]),
                                                              point(shape, vertices[2]), point(shape, vertices[3])));
    }
    tie.stiffness = tie_stiffness(tie.rest, set.diagonal);
    return tie;
}

PenaltyTerm penalty_term_of(const Tie& tie)
{
    const Eigen::Matrix2d& f = tie.frame;
    PenaltyTerm term
        = { { tie.vertices.begin(), tie.vertices.end() }, Eigen::Matrix3Xd(3, 4), tie.stiffness, tie.rest, tie.part };
    term.factors << 1, -1, 0, 0, //
        0, -f(0, 0), f(0, 0), 0, //
        0, -f(0, 1) - f(1, 1), f(0, 1), f(1, 1);
    return term;
}

Eigen::Matrix3d tie_vectors(const Tie& tie, const Eigen::Vector3d& vertex, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
    Eigen::Matrix3d out;
    out.col(0) = vertex - a;
    out.col(1) = tie.frame(0, 0) * (b - a);
    out.col(2) = tie.frame(0, 1) * (b - a) + tie.frame(1, 1) * (c - a);
    return out;
}

Eigen::Vector3d tie_place(const Eigen::Matrix3d& vectors)
{
    const Eigen::Vector3d r = vectors.col(0), e1 = vectors.col(1), e2 = vectors.col(2);
    return { r.dot(e1), r.dot(e2), r.dot(e1.cross(e2)) };
}

const Joint* joint_of(const TieSet& ties, std::size_t first_tie)
{
    for (const Joint& joint : ties.joints)
        if (joint.first_tie == first_tie) return &joint;
    return nullptr;
}

std::size_t end_of_part(const TieSet& ties, std::size_t first)
{
    std::size_t end = first;
    while (end < ties.ties.size() && ties.ties[end].part == ties.ties[first].part) ++end;
    return end;
}

} // namespace pliant
