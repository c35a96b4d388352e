#include "elastic/parts/tied_energy.h"

#include "pliant_format.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix9x3 = Eigen::Matrix<double, 9, 3>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;

// Derivatives of the three coordinates of the place with respect to (r, e1, e2), one column each.
Matrix9x3 place_slopes(const Matrix3d& v)
{
    const Vector3d r = v.col(0), e1 = v.col(1), e2 = v.col(2);
    Matrix9x3 out;
    out.col(0) << e1, r, Vector3d::Zero();
    out.col(1) << e2, Vector3d::Zero(), r;
    out.col(2) << e1.cross(e2), e2.cross(r), r.cross(e1);
    return out;
}

// The sum over the coordinates c of off[c] times the second derivative of coordinate c.
Matrix9 place_curvature(const Matrix3d& v, const Vector3d& off)
{
    Matrix9 out = Matrix9::Zero();
    // The second derivative of det(r, e1, e2) in directions u of r and w of e1 is u . (w x e2).
    out.block<3, 3>(0, 3) = off[0] * Matrix3d::Identity() - off[2] * cross_matrix(v.col(2));
    out.block<3, 3>(0, 6) = off[1] * Matrix3d::Identity() + off[2] * cross_matrix(v.col(1));
    out.block<3, 3>(3, 6) = -off[2] * cross_matrix(v.col(0));
    out.block<3, 3>(3, 0) = out.block<3, 3>(0, 3).transpose();
    out.block<3, 3>(6, 0) = out.block<3, 3>(0, 6).transpose();
    out.block<3, 3>(6, 3) = out.block<3, 3>(3, 6).transpose();
    return out;
}

Matrix3d vectors_of(const PenaltyTerm& term, const double* x)
{
    return Eigen::Map<const Eigen::Matrix3Xd>(x, 3, term.factors.cols()) * term.factors.transpose();
}

// Value, gradient and Hessian of sum_k w_k stiffness |place - rest_k|^2, or of layers, by the chain rule: place, then (r,
// e1, e2), then vertices.
void evaluate_term(const PenaltyTerm& term, Blend blend, const double* weights, const double* x, Order order,
                   HessianKind kind, ElementResult& result)
{
    const Matrix3d vectors = vectors_of(term, x);
    const Vector3d place = tie_place(vectors);
    double stiffness = 0;              // weighted sum, times 2
    Vector3d slope = Vector3d::Zero(); // derivative with respect to the place
    result.value = 0;
    const auto add = [&](double weight, const Vector3d& rest) {
        const double factor = weight * term.stiffness;
        result.value += factor * (place - rest).squaredNorm();
        slope += 2 * factor * (place - rest);
        stiffness += 2 * factor;
    };
    if (blend == Blend::layers)
        add(1, layered(term.rest, weights));
    else
        for (Eigen::Index k = 0; k < term.rest.cols(); ++k) add(weights[k], term.rest.col(k));
    if (order < Order::gradient) return;
    const Eigen::Matrix3Xd& factors = term.factors;
    const Eigen::Index count = factors.cols();
    const Matrix9x3 slopes = place_slopes(vectors);
    const Eigen::Matrix<double, 9, 1> force = slopes * slope;
    result.gradient.resize(3 * count);
    Eigen::Map<Eigen::Matrix3Xd>(result.gradient.data(), 3, count) = Eigen::Map<const Matrix3d>(force.data()) * factors;
    if (order < Order::hessian) return;
    Matrix9 curvature = stiffness * slopes * slopes.transpose(); // Gauss-Newton part: positive semidefinite
    if (kind == HessianKind::exact) curvature += place_curvature(vectors, slope);
    Eigen::Matrix<double, 9, Eigen::Dynamic> to_vertices(9, 3 * count);
    for (Eigen::Index i = 0; i < 3; ++i)
        for (Eigen::Index j = 0; j < count; ++j)
            to_vertices.block<3, 3>(3 * i, 3 * j) = factors(i, j) * Matrix3d::Identity();
    result.hessian = to_vertices.transpose() * curvature * to_vertices;
}

} // namespace

TiedEnergy::TiedEnergy(std::unique_ptr<Energy> inner, TieSet ties)
    : inner_(std::move(inner))
    , ties_(std::move(ties))
{
    for (const Joint& joint : ties_.joints) terms_.insert(terms_.end(), joint.terms.begin(), joint.terms.end());
    for (const Tie& tie : ties_.ties) terms_.push_back(penalty_term_of(tie));
    apply_choice();
}

void TiedEnergy::apply_choice()
{
    std::vector<bool> is_replaced(ties_.ties.size(), false);
    std::size_t next = 0;
    for (const Joint& joint : ties_.joints) {
        for (std::size_t i = 0; i < joint.tie_count; ++i) is_replaced[joint.first_tie + i] = joint.is_used;
        for (const PenaltyTerm& term : joint.terms) terms_[next++].stiffness = joint.is_used ? term.stiffness : 0;
    }
    for (std::size_t i = 0; i < ties_.ties.size(); ++i)
        terms_[next++].stiffness = is_replaced[i] ? 0 : ties_.ties[i].stiffness;
}

void TiedEnergy::choose(const std::vector<double>& stiffness, const std::vector<bool>& joints)
{
    for (std::size_t i = 0; i < stiffness.size(); ++i) ties_.ties[i].stiffness = stiffness[i];
    for (std::size_t i = 0; i < joints.size(); ++i) ties_.joints[i].is_used = joints[i];
    apply_choice();
}

void TiedEnergy::drop_unused()
{
    terms_.erase(std::remove_if(terms_.begin(), terms_.end(), [](const PenaltyTerm& term) { return term.stiffness == 0; }),
                 terms_.end());
}

const std::uint32_t* TiedEnergy::element_vertices(std::size_t element, std::size_t& count) const
{
    if (element < inner_->element_count()) return inner_->element_vertices(element, count);
    const PenaltyTerm& term = terms_[element - inner_->element_count()];
    count = term.vertices.size();
    return term.vertices.data();
}

void TiedEnergy::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                          ElementResult& result) const
{
    if (element < inner_->element_count())
        inner_->evaluate(element, weights, x, order, kind, result);
    else
        evaluate_term(terms_[element - inner_->element_count()], blend(), weights, x, order, kind, result);
}

// Element kind 8 of formats/SPEC.md.
RuntimeElement TiedEnergy::runtime_element(std::size_t element, const Shape& reference) const
{
    if (element < inner_->element_count()) return inner_->runtime_element(element, reference);
    const PenaltyTerm& term = terms_[element - inner_->element_count()];
    const std::size_t count = term.vertices.size();
    RuntimeElement out;
    out.kind = PLIANT_ELEMENT_TIE;
    out.combination.resize(Eigen::Index(count) - 1, 3);
    Eigen::Matrix3Xd at(3, count); // relative to vertices[1], the first anchor of a tie
    for (std::size_t i = 0; i < count; ++i) {
        at.col(Eigen::Index(i)) = point(reference, term.vertices[i]) - point(reference, term.vertices[1]);
        if (i == 1) continue;
        out.combination.row(Eigen::Index(out.differences.size())) = term.factors.col(Eigen::Index(i)).transpose();
        out.differences.push_back({ term.vertices[1], term.vertices[i] });
    }
    const Vector3d start = tie_place(at * term.factors.transpose());
    out.pose_numbers.resize(term.rest.cols(), 4);
    out.pose_numbers.col(0).setConstant(term.stiffness);
    out.pose_numbers.rightCols<3>() = 2 * term.stiffness * (start.replicate(1, term.rest.cols()) - term.rest).transpose();
    if (blend() == Blend::layers)
        out.pose_numbers.bottomRows(term.rest.cols() - 1).rowwise() -= out.pose_numbers.row(0).eval();
    return out;
}

std::unique_ptr<Energy> tie_parts(std::unique_ptr<Energy> energy, TieSet ties)
{
    if (ties.ties.empty()) return energy;
    return std::make_unique<TiedEnergy>(std::move(energy), std::move(ties));
}

const TieSet* ties_of(const Energy& energy)
{
    const auto* tied = dynamic_cast<const TiedEnergy*>(&energy);
    return tied ? &tied->ties() : nullptr;
}

const Energy& without_ties(const Energy& energy)
{
    const auto* tied = dynamic_cast<const TiedEnergy*>(&energy);
    return tied ? tied->inner() : energy;
}

} // namespace pliant
