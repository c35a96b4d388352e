#include "elastic/parts/joints.h"

#include "elastic/energy/blend.h"
#include "elastic/parts/rotations.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

namespace pliant {

namespace {

// A body is rigid if it keeps its shape to this (units of the diagonal) in all poses: a fifth of the drift limit. Where it
// deforms by more, ties of single vertices are more accurate.
constexpr double rigid_error = 0.001;

// A cloud whose extent along an axis is below this share of the largest does not define a direction along that axis.
constexpr double min_extent = 0.1;

// The number of ties a joint uses. The first ones are the farthest apart.
constexpr std::size_t max_vertices = 16;

// Points that move rigidly: their mean shape, and its rotation and centroid in every pose.
struct Body {
    std::vector<std::uint32_t> vertices;
    Eigen::Matrix3Xd shape; // about its centroid
    std::vector<Eigen::Matrix3d> rotations;
    Eigen::Matrix3Xd centres;
    double error = 0; // largest distance of a vertex from its place in the rigid motion, over all poses
};

Eigen::Matrix3Xd cloud_of(const Shape& shape, const std::vector<std::uint32_t>& vertices)
{
    Eigen::Matrix3Xd out(3, Eigen::Index(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) out.col(Eigen::Index(i)) = point(shape, vertices[i]);
    return out;
}

Body make_body(const NormalizedPoses& set, std::vector<std::uint32_t> vertices)
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

// Principal axes of a body, longest extent first.
struct Axes {
    Eigen::Matrix3d directions;
    Eigen::Vector3d deviations; // sums of squares along them
    int count;                  // of the axes long enough to define a direction
};

Axes axes_of(const Body& body)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(body.shape * body.shape.transpose());
    Axes axes = { solver.eigenvectors().rowwise().reverse(), solver.eigenvalues().reverse(), 0 };
    while (axes.count < 3 && axes.deviations[axes.count] > min_extent * min_extent * axes.deviations[0]) ++axes.count;
    return axes;
}

// The smallest factors with which the body's vertices combine to one of its axes.
Eigen::RowVectorXd direction_factors(const Body& body, const Axes& axes, int axis)
{
    return axes.directions.col(axis).transpose() * body.shape / axes.deviations[axis];
}

// The same for a point of the body, or, for a flat body, the foot of the point in its plane.
Eigen::RowVectorXd point_factors(const Body& body, const Axes& axes, const Eigen::Vector3d& at)
{
    const Eigen::Index n = body.shape.cols();
    Eigen::RowVectorXd out = Eigen::RowVectorXd::Constant(n, 1 / double(n));
    for (int i = 0; i < axes.count; ++i) out += axes.directions.col(i).dot(at) * direction_factors(body, axes, i);
    return out;
}

// The motion of a part in the frame of its parent.
struct RelativeMotion {
    std::vector<Eigen::Matrix3d> rotations;
    Eigen::Matrix3Xd centres;
};

RelativeMotion motion_in_parent(const Body& part, const Body& parent)
{
    RelativeMotion out = { {}, Eigen::Matrix3Xd(3, part.centres.cols()) };
    for (std::size_t k = 0; k < part.rotations.size(); ++k) {
        out.rotations.push_back(parent.rotations[k].transpose() * part.rotations[k]);
        out.centres.col(Eigen::Index(k))
            = parent.rotations[k].transpose() * (part.centres.col(Eigen::Index(k)) - parent.centres.col(Eigen::Index(k)));
    }
    return out;
}

// Makes the terms of a joint between two bodies. Rows of the factors are r, e1, e2; e1 and e2 are axes of the parent.
class JointMaker {
public:
    JointMaker(const NormalizedPoses& set, const Body& part, const Body& parent)
        : set_(set)
        , part_(part)
        , parent_(parent)
        , part_axes_(axes_of(part))
        , parent_axes_(axes_of(parent))
        , of_part_(Eigen::Matrix3Xd::Zero(3, part.shape.cols()))
        , of_parent_(3, parent.shape.cols())
    {
        for (int i = 0; i < 2 && have_directions(); ++i) of_parent_.row(1 + i) = direction_factors(parent_, parent_axes_, i);
    }

    bool have_directions() const { return part_axes_.count >= 2 && parent_axes_.count >= 2; }

    // Holds the pivot of the part at its mean place in the parent.
    PenaltyTerm pivot_term(const RelativeMotion& motion)
    {
        const Eigen::Vector3d pivot = pivot_point(motion.rotations, motion.centres, part_.shape.colwise().norm().maxCoeff());
        const std::size_t poses = motion.rotations.size();
        Eigen::Vector3d place = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < poses; ++k)
            place += (motion.rotations[k] * pivot + motion.centres.col(Eigen::Index(k))) / double(poses);
        of_part_.row(0) = point_factors(part_, part_axes_, pivot);
        of_parent_.row(0) = -point_factors(parent_, parent_axes_, place);
        PenaltyTerm term = make_term();
        term.stiffness = double(part_.vertices.size()) * tie_stiffness(term.rest, set_.diagonal);
        return term;
    }

    // One term per axis of the part, scaled by its radius. They share one stiffness: only then they pull to the mean
    // rotation.
    std::vector<PenaltyTerm> rotation_terms()
    {
        const double count = double(part_.vertices.size()), radius = std::sqrt(part_.shape.squaredNorm() / count);
        std::vector<PenaltyTerm> terms;
        of_parent_.row(0).setZero();
        double stiffness = std::numeric_limits<double>::infinity();
        for (int i = 0; i < part_axes_.count; ++i) {
            of_part_.row(0) = radius * direction_factors(part_, part_axes_, i);
            terms.push_back(make_term());
            stiffness = std::min(stiffness, count / 3 * tie_stiffness(terms.back().rest, set_.diagonal));
        }
        for (PenaltyTerm& term : terms) term.stiffness = stiffness;
        return terms;
    }

private:
    // A term with the present factors. Adds up the factors of vertices that belong to both bodies.
    PenaltyTerm make_term() const
    {
        PenaltyTerm term;
        term.vertices = part_.vertices;
        term.vertices.insert(term.vertices.end(), parent_.vertices.begin(), parent_.vertices.end());
        std::sort(term.vertices.begin(), term.vertices.end());
        term.vertices.erase(std::unique(term.vertices.begin(), term.vertices.end()), term.vertices.end());
        term.factors = Eigen::Matrix3Xd::Zero(3, Eigen::Index(term.vertices.size()));
        add_factors(part_, of_part_, term);
        add_factors(parent_, of_parent_, term);
        term.rest.resize(3, Eigen::Index(set_.pose_count()));
        for (std::size_t k = 0; k < set_.pose_count(); ++k)
            term.rest.col(Eigen::Index(k)) = tie_place(cloud_of(set_.shapes[k], term.vertices) * term.factors.transpose());
        return term;
    }

    static void add_factors(const Body& body, const Eigen::Matrix3Xd& factors, PenaltyTerm& term)
    {
        for (std::size_t i = 0; i < body.vertices.size(); ++i) {
            const auto found = std::lower_bound(term.vertices.begin(), term.vertices.end(), body.vertices[i]);
            term.factors.col(found - term.vertices.begin()) += factors.col(Eigen::Index(i));
        }
    }

    const NormalizedPoses& set_;
    const Body& part_;
    const Body& parent_;
    Axes part_axes_, parent_axes_;
    Eigen::Matrix3Xd of_part_, of_parent_;
};

std::vector<std::uint32_t> anchors_of(const Tie* first, const Tie* last)
{
    std::vector<std::uint32_t> out;
    for (const Tie* tie = first; tie != last; ++tie) out.insert(out.end(), tie->vertices.begin() + 1, tie->vertices.end());
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

} // namespace

std::vector<PenaltyTerm> find_joint_terms(const NormalizedPoses& set, const Tie* first, const Tie* last)
{
    last = first + std::min(std::size_t(last - first), max_vertices);
    if (last - first < 3) return {};
    std::vector<std::uint32_t> tied;
    for (const Tie* tie = first; tie != last; ++tie) tied.push_back(tie->vertices[0]);
    const Body part = make_body(set, std::move(tied)), parent = make_body(set, anchors_of(first, last));
    if (std::max(part.error, parent.error) > rigid_error * set.diagonal) return {};
    const RelativeMotion motion = motion_in_parent(part, parent);
    JointMaker maker(set, part, parent);
    if (largest_rotation(motion.rotations) < min_rotation || !maker.have_directions()) return {};
    std::vector<PenaltyTerm> out = { maker.pivot_term(motion) };
    for (PenaltyTerm& term : maker.rotation_terms()) out.push_back(std::move(term));
    for (PenaltyTerm& term : out) term.part = first->part;
    return out;
}

JointTurn turn_of_layers(const Joint& joint, const Weights& v)
{
    const Eigen::Index count = Eigen::Index(joint.terms.size()) - 1; // without the pivot
    Eigen::Matrix3Xd rest(3, count), now(3, count);
    const auto turn = [&](const Weights& weights) {
        for (Eigen::Index i = 0; i < count; ++i) {
            const Eigen::Matrix3Xd& places = joint.terms[std::size_t(i) + 1].rest;
            rest.col(i) = places.col(0);
            now.col(i) = layered(places, weights.data());
        }
        return nearest_rotation(now * rest.transpose());
    };
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < v.size(); ++k) {
        if (v[k] == 0) continue;
        const Eigen::AngleAxisd own(turn(Weights::Unit(v.size(), k)));
        sum += v[k] * own.angle() * own.axis();
    }
    const Eigen::Matrix3d is = turn(v), wanted = Eigen::AngleAxisd(sum.norm(), sum.stableNormalized()).toRotationMatrix();
    return { Eigen::AngleAxisd(is).angle(), sum.norm(), Eigen::AngleAxisd(is.transpose() * wanted).angle() };
}

} // namespace pliant
