#include "reduced/surrogate/surrogate_energy.h"

#include "elastic/average/hessian.h"
#include "elastic/average/placement.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

SurrogateEnergy::SurrogateEnergy(const Energy& energy, const Shape& rest, const Eigen::MatrixXd& basis,
                                 std::vector<std::size_t> elements, Eigen::VectorXd weights)
    : energy_(energy)
    , dimension_(basis.cols())
    , elements_(std::move(elements))
    , weights_(std::move(weights))
{
    for (std::size_t element : elements_) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy.element_vertices(element, count);
        Eigen::MatrixXd rows(3 * Eigen::Index(count), basis.cols());
        Eigen::VectorXd base(3 * Eigen::Index(count));
        for (std::size_t i = 0; i < count; ++i) {
            rows.middleRows<3>(3 * Eigen::Index(i)) = basis.middleRows<3>(3 * Eigen::Index(vertices[i]));
            base.segment<3>(3 * Eigen::Index(i)) = rest.segment<3>(3 * Eigen::Index(vertices[i]));
        }
        rows_.push_back(std::move(rows));
        rest_rows_.push_back(std::move(base));
    }
}

SurrogateEnergy::SurrogateEnergy(const Energy& energy, Quartic quartic)
    : energy_(energy)
    , dimension_(quartic.dimension())
    , quartic_(std::make_shared<const Quartic>(std::move(quartic)))
{
}

Gauge make_gauge(const NormalizedPoses& set, Blend blend, const Subspace& subspace, double energy_scale, double curvature)
{
    // A move by this part of the size of the character costs the unit of energies, which is next to nothing where poses are
    // turned and hardly bent: then a part of what bending costs.
    constexpr double free_play = 0.2, least_part = 1e-4;
    const Placement placement(set);
    if (!placement.is_kept()) return {};
    const Eigen::Index weight_count = Eigen::Index(set.pose_count()) - (blend == Blend::layers);
    Gauge gauge;
    gauge.along = placement.affine_part(subspace.basis);
    gauge.wanted = gauge.along * subspace.pose_coordinates.rightCols(weight_count);
    gauge.stiffness = std::max(energy_scale / (free_play * free_play), least_part * curvature);
    return gauge;
}

double Gauge::add_gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const
{
    if (stiffness == 0) return 0;
    const Eigen::VectorXd off = along * q - wanted * w;
    gradient += 2 * stiffness * (along.transpose() * off);
    return stiffness * off.squaredNorm();
}

void Gauge::add_hessian(Eigen::MatrixXd& hessian) const
{
    if (stiffness > 0) hessian += 2 * stiffness * along.transpose() * along;
}

double SurrogateEnergy::value(const Weights& w, const Eigen::VectorXd& q) const
{
    if (quartic_) return quartic_->value(w, q);
    ElementResult result;
    double sum = 0;
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const Eigen::VectorXd x = rest_rows_[i] + rows_[i] * q;
        energy_.evaluate(elements_[i], w.data(), x.data(), Order::value, HessianKind::exact, result);
        sum += weights_[Eigen::Index(i)] * result.value;
    }
    if (gauge_.stiffness > 0) sum += gauge_.stiffness * (gauge_.along * q - gauge_.wanted * w).squaredNorm();
    return sum;
}

double SurrogateEnergy::gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const
{
    if (quartic_) return quartic_->gradient(w, q, gradient);
    ElementResult result;
    double sum = 0;
    gradient.setZero(dimension_);
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const Eigen::VectorXd x = rest_rows_[i] + rows_[i] * q;
        energy_.evaluate(elements_[i], w.data(), x.data(), Order::gradient, HessianKind::exact, result);
        sum += weights_[Eigen::Index(i)] * result.value;
        gradient += weights_[Eigen::Index(i)] * (rows_[i].transpose() * result.gradient);
    }
    sum += gauge_.add_gradient(w, q, gradient);
    return sum;
}

Eigen::MatrixXd SurrogateEnergy::hessian(const Weights& w, const Eigen::VectorXd& q, HessianKind kind) const
{
    if (quartic_) {
        Eigen::MatrixXd hessian = quartic_->hessian(w, q);
        if (kind == HessianKind::projected) project_positive(hessian);
        return hessian;
    }
    ElementResult result;
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(dimension_, dimension_);
    for (std::size_t i = 0; i < elements_.size(); ++i) {
        const Eigen::VectorXd x = rest_rows_[i] + rows_[i] * q;
        energy_.evaluate(elements_[i], w.data(), x.data(), Order::hessian, kind, result);
        sum += weights_[Eigen::Index(i)] * (rows_[i].transpose() * (result.hessian * rows_[i]));
    }
    gauge_.add_hessian(sum);
    return 0.5 * (sum + sum.transpose());
}

ReducedEnergy::ReducedEnergy(const Energy& energy, const Subspace& subspace)
    : energy_(energy)
    , subspace_(subspace)
{
}

double ReducedEnergy::gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const
{
    Shape full = Shape::Zero(subspace_.rest.size());
    const double value = add_gradient(energy_, w, subspace_.shape(q), full);
    gradient = subspace_.basis.transpose() * full;
    return value + gauge_.add_gradient(w, q, gradient);
}

Eigen::MatrixXd ReducedEnergy::hessian(const Weights& w, const Eigen::VectorXd& q, HessianKind kind) const
{
    HessianAssembler assembler(energy_);
    assembler.assemble(w, subspace_.shape(q), kind);
    Eigen::MatrixXd reduced = times_symmetric(subspace_.basis.transpose(), assembler.matrix()) * subspace_.basis;
    gauge_.add_hessian(reduced);
    return 0.5 * (reduced + reduced.transpose());
}

Eigen::MatrixXd ReducedEnergy::hessian_times(const Weights& w, const Eigen::VectorXd& q,
                                             const Eigen::MatrixXd& directions) const
{
    HessianAssembler assembler(energy_);
    assembler.assemble(w, subspace_.shape(q), HessianKind::exact);
    const Eigen::MatrixXd moved = subspace_.basis * directions;
    return (times_symmetric(moved.transpose(), assembler.matrix()) * subspace_.basis).transpose();
}

template <class Model>
MinimizeResult minimize_newton(const Model& model, const Weights& w, const Eigen::VectorXd& start, double tolerance,
                               int max_iterations)
{
    MinimizeResult result;
    result.q = start;
    Eigen::VectorXd gradient, trial_gradient;
    result.value = model.gradient(w, start, gradient);
    for (; result.iterations < max_iterations; ++result.iterations) {
        Eigen::LLT<Eigen::MatrixXd> factor(model.hessian(w, result.q, HessianKind::exact));
        bool is_exact = factor.info() == Eigen::Success;
        if (!is_exact) {
            Eigen::MatrixXd projected = model.hessian(w, result.q, HessianKind::projected);
            projected.diagonal().array()
                += 1e-9 * projected.trace() / double(projected.rows()); // its null space has no scale of its own
            factor.compute(projected);
            if (factor.info() != Eigen::Success) return result;
        }
        const Eigen::VectorXd step = -factor.solve(gradient);
        const double slope = gradient.dot(step);
        const bool is_last = is_exact && -slope <= tolerance * tolerance * std::max(std::abs(result.value), 1e-13);
        double length = 1, value = 0;
        for (; length > 1e-9; length /= 2) {
            value = model.gradient(w, result.q + length * step, trial_gradient);
            if (value <= result.value + 1e-4 * length * slope || -slope < 1e-11 * std::abs(result.value)) break;
        }
        if (length <= 1e-9) {
            result.has_converged = is_last;
            return result;
        }
        result.q += length * step;
        result.value = value;
        gradient = trial_gradient;
        if (is_last) {
            result.has_converged = true;
            return result;
        }
    }
    return result;
}

template MinimizeResult minimize_newton(const SurrogateEnergy&, const Weights&, const Eigen::VectorXd&, double, int);
template MinimizeResult minimize_newton(const ReducedEnergy&, const Weights&, const Eigen::VectorXd&, double, int);

} // namespace pliant
