#include "elastic/parts/joints.h"

#include "elastic/parts/rotations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

namespace pliant {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Rigid is what keeps its shape to this (units of the diagonal) in all poses: a fifth of what parts may drift, which is how far ties of
// single vertices would know better.
constexpr double rigid_enough = 0.001;

// Below this angle between any two poses (radians) ties of single vertices do: the places of one that is a tenth of the diagonal from the
// joint are off the arc by a part of 1 - cos(t/2) of it, 0.1 % of the diagonal.
constexpr double min_rotation = 0.3;

// Of a cloud that is flatter than this (smallest to largest deviation) the normal is no direction that its points could carry.
constexpr double flat = 0.1;

// What a joint looks at of a part, and of its parent: so many tied vertices (those tied first lie farthest apart), and their anchors.
constexpr std::size_t max_vertices = 16;

// Points of a body: their mean shape, and its turn and its centre in every pose.
struct Body {
    std::vector<std::uint32_t> vertices;
    Eigen::Matrix3Xd shape; // around its centroid
    std::vector<Eigen::Matrix3d> rotations;
    Eigen::Matrix3Xd centres;
    double error = 0; // the farthest that a vertex is from where this has it
};

Eigen::Matrix3Xd cloud_of(const Shape& shape, const std::vector<std::uint32_t>& vertices)
{
    Eigen::Matrix3Xd out(3, Eigen::Index(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) out.col(Eigen::Index(i)) = point(shape, vertices[i]);
    return out;
}

Body make_body(const ShapeSet& set, std::vector<std::uint32_t> vertices)
{
    Body body;
    const Eigen::Index poses = Eigen::Index(set.pose_count()), count = Eigen::Index(vertices.size());
    body.centres.resize(3, poses);
    body.shape = Eigen::Matrix3Xd::Zero(3, count);
    const Eigen::Matrix3Xd first = cloud_of(set.shapes[0], vertices);
    std::vector<Eigen::Matrix3Xd> clouds;
    for (Eigen::Index k = 0; k < poses; ++k) {
        clouds.push_back(cloud_of(set.shapes[std::size_t(k)], vertices));
        body.centres.col(k) = clouds.back().rowwise().mean();
        clouds.back().colwise() -= body.centres.col(k);
        body.rotations.push_back(best_rotation(first, clouds.back()));
        body.shape += body.rotations.back().transpose() * clouds.back() / double(poses);
    }
    for (std::size_t k = 0; k < clouds.size(); ++k)
        body.error = std::max(body.error, (body.rotations[k] * body.shape - clouds[k]).colwise().norm().maxCoeff());
    body.vertices = std::move(vertices);
    return body;
}

// Directions of a body and how its points lie along them, largest first.
struct Axes {
    Eigen::Matrix3d directions;
    Eigen::Vector3d deviations; // sums of squares
    int count;                  // that the points can carry
};

Axes axes_of(const Body& body)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(body.shape * body.shape.transpose());
    Axes axes = { solver.eigenvectors().rowwise().reverse(), solver.eigenvalues().reverse(), 0 };
    while (axes.count < 3 && axes.deviations[axes.count] > flat * flat * axes.deviations[0]) ++axes.count;
    return axes;
}

// Factors of a body's points that make a direction of it, and a point of it, of where they are; the smallest that do. Of a flat body the
// point's foot in its plane.
Eigen::RowVectorXd direction_factors(const Body& body, const Axes& axes, int axis)
{
    return axes.directions.col(axis).transpose() * body.shape / axes.deviations[axis];
}

Eigen::RowVectorXd point_factors(const Body& body, const Axes& axes, const Eigen::Vector3d& at)
{
    const Eigen::Index n = body.shape.cols();
    Eigen::RowVectorXd out = Eigen::RowVectorXd::Constant(n, 1 / double(n));
    for (int i = 0; i < axes.count; ++i) out += axes.directions.col(i).dot(at) * direction_factors(body, axes, i);
    return out;
}

double largest_rotation(const std::vector<Eigen::Matrix3d>& rotations)
{
    double out = 0;
    for (const Eigen::Matrix3d& a : rotations)
        for (const Eigen::Matrix3d& b : rotations) out = std::max(out, Eigen::AngleAxisd(a.transpose() * b).angle());
    return out;
}

// Adds up the factors of vertices that are on both sides.
PenaltyTerm make_term(const ShapeSet& set, const Body& part, const Body& parent, const Eigen::Matrix3Xd& of_part,
                      const Eigen::Matrix3Xd& of_parent)
{
    PenaltyTerm term;
    term.vertices = part.vertices;
    term.vertices.insert(term.vertices.end(), parent.vertices.begin(), parent.vertices.end());
    std::sort(term.vertices.begin(), term.vertices.end());
    term.vertices.erase(std::unique(term.vertices.begin(), term.vertices.end()), term.vertices.end());
    term.factors = Eigen::Matrix3Xd::Zero(3, Eigen::Index(term.vertices.size()));
    const auto add = [&](const Body& body, const Eigen::Matrix3Xd& factors) {
        for (std::size_t i = 0; i < body.vertices.size(); ++i) {
            const auto found = std::lower_bound(term.vertices.begin(), term.vertices.end(), body.vertices[i]);
            term.factors.col(found - term.vertices.begin()) += factors.col(Eigen::Index(i));
        }
    };
    add(part, of_part);
    add(parent, of_parent);
    term.rest.resize(3, Eigen::Index(set.pose_count()));
    for (std::size_t k = 0; k < set.pose_count(); ++k)
        term.rest.col(Eigen::Index(k)) = tie_place(cloud_of(set.shapes[k], term.vertices) * term.factors.transpose());
    return term;
}

} // namespace

std::vector<PenaltyTerm> find_joint_terms(const ShapeSet& set, const Tie* first, const Tie* last)
{
    const std::size_t count = std::min(std::size_t(last - first), max_vertices), poses = set.pose_count();
    std::vector<std::uint32_t> tied, anchors;
    for (const Tie* tie = first; tie != first + count; ++tie) {
        tied.push_back(tie->vertices[0]);
        anchors.insert(anchors.end(), tie->vertices.begin() + 1, tie->vertices.end());
    }
    std::sort(anchors.begin(), anchors.end());
    anchors.erase(std::unique(anchors.begin(), anchors.end()), anchors.end());
    if (tied.size() < 3) return {};
    const Body part = make_body(set, tied), parent = make_body(set, anchors);
    if (std::max(part.error, parent.error) > rigid_enough * set.diagonal) return {};
    std::vector<Eigen::Matrix3d> rotations; // of the part in the frame of its parent
    Eigen::Matrix3Xd centres(3, Eigen::Index(poses));
    for (std::size_t k = 0; k < poses; ++k) {
        rotations.push_back(parent.rotations[k].transpose() * part.rotations[k]);
        centres.col(Eigen::Index(k))
            = parent.rotations[k].transpose() * (part.centres.col(Eigen::Index(k)) - parent.centres.col(Eigen::Index(k)));
    }
    const Axes part_axes = axes_of(part), parent_axes = axes_of(parent);
    if (largest_rotation(rotations) < min_rotation || part_axes.count < 2 || parent_axes.count < 2) return {};

    // Rows r, e1, e2.
    Eigen::Matrix3Xd of_part = Eigen::Matrix3Xd::Zero(3, part.shape.cols()), of_parent(3, parent.shape.cols());
    const Eigen::Vector3d pivot = pivot_point(rotations, centres, part.shape.colwise().norm().maxCoeff());
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < poses; ++k) place += (rotations[k] * pivot + centres.col(Eigen::Index(k))) / double(poses);
    of_part.row(0) = point_factors(part, part_axes, pivot);
    of_parent.row(0) = -point_factors(parent, parent_axes, place);
    for (int i = 0; i < 2; ++i) of_parent.row(1 + i) = direction_factors(parent, parent_axes, i);
    std::vector<PenaltyTerm> out = { make_term(set, part, parent, of_part, of_parent) };
    out[0].stiffness = double(count) * tie_stiffness(out[0].rest, set.diagonal);

    const double radius = std::sqrt(part.shape.squaredNorm() / double(count));
    of_parent.row(0).setZero();
    double stiffness = infinity; // the same for all: only then the mean of rotations is where these pull to
    for (int i = 0; i < part_axes.count; ++i) {
        of_part.row(0) = radius * direction_factors(part, part_axes, i);
        out.push_back(make_term(set, part, parent, of_part, of_parent));
        stiffness = std::min(stiffness, double(count) / 3 * tie_stiffness(out.back().rest, set.diagonal));
    }
    for (std::size_t i = 1; i < out.size(); ++i) out[i].stiffness = stiffness;
    for (PenaltyTerm& term : out) term.part = first->part;
    return out;
}

} // namespace pliant
