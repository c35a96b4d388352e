// The surrogate energy energy: a few weighted elements seen through the subspace, or a polynomial. In double precision this
// is what the runtime evaluates in single; with all elements at weight 1, and as the polynomial, it is the reduced energy
// itself.
#pragma once

#include "elastic/energy/energy.h"
#include "reduced/subspace/subspace.h"
#include "reduced/surrogate/minimize.h"
#include "reduced/surrogate/quartic.h"

#include <memory>

namespace pliant {

// Holds what no elastic energy sees: stiffness |along q - wanted w|^2, the affine part of a blend against that of the linear
// blend (elastic/average/placement.h). Poses that stay where they are, and layers, may have rigid motions in their subspace.
struct Gauge {
    Eigen::MatrixXd along, wanted; // 12 x d (9 x d); columns of poses, or layers
    double stiffness = 0;          // 0: nothing is held

    // Add the term's part.
    double add_gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const; // returns its value
    void add_hessian(Eigen::MatrixXd& hessian) const;
};
// Without one if the set has no frame. `curvature`: of the elastic energy, the mean over the coordinates.
Gauge make_gauge(const NormalizedPoses& set, Blend blend, const Subspace& subspace, double energy_scale, double curvature);

class SurrogateEnergy {
public:
    // Elements of `energy` with their weights. `rest` and `basis` are those of the mesh that `energy` lives on: the full one
    // for cubature, the decimated one for a ghost. The energy must outlive the surrogate energy.
    SurrogateEnergy(const Energy& energy, const Shape& rest, const Eigen::MatrixXd& basis, std::vector<std::size_t> elements,
                    Eigen::VectorXd weights);

    // The reduced energy of a St. Venant-Kirchhoff solid; no elements.
    SurrogateEnergy(const Energy& energy, Quartic quartic);

    void hold(Gauge gauge) { gauge_ = std::move(gauge); }
    const Gauge& gauge() const { return gauge_; }

    // Null: a sum of elements.
    const Quartic* quartic() const { return quartic_.get(); }

    Eigen::Index dimension() const { return dimension_; }
    std::size_t element_count() const { return elements_.size(); }
    const std::vector<std::size_t>& elements() const { return elements_; }
    const Eigen::VectorXd& weights() const { return weights_; }
    const Energy& energy() const { return energy_; }

    double value(const Weights& w, const Eigen::VectorXd& q) const;
    double gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const;
    Eigen::MatrixXd hessian(const Weights& w, const Eigen::VectorXd& q, HessianKind kind) const;

    // Rows of the basis at the vertices of selected element i (3v x d), and of the rest (3v).
    const Eigen::MatrixXd& rows(std::size_t i) const { return rows_[i]; }
    const Eigen::VectorXd& rest_rows(std::size_t i) const { return rest_rows_[i]; }

private:
    const Energy& energy_;
    Eigen::Index dimension_;
    std::vector<std::size_t> elements_;
    Eigen::VectorXd weights_;
    std::vector<Eigen::MatrixXd> rows_;
    std::vector<Eigen::VectorXd> rest_rows_;
    std::shared_ptr<const Quartic> quartic_;
    Gauge gauge_;
};

// The reduced energy on the full mesh, with the gauge: exact, and as expensive as the mesh.
class ReducedEnergy {
public:
    ReducedEnergy(const Energy& energy, const Subspace& subspace);
    void hold(Gauge gauge) { gauge_ = std::move(gauge); }
    double gradient(const Weights& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const;
    Eigen::MatrixXd hessian(const Weights& w, const Eigen::VectorXd& q, HessianKind kind) const;
    // The exact Hessian of the elastic energy alone times directions (d x c).
    Eigen::MatrixXd hessian_times(const Weights& w, const Eigen::VectorXd& q, const Eigen::MatrixXd& directions) const;
    const Energy& energy() const { return energy_; }
    const Subspace& subspace() const { return subspace_; }
    const Gauge& gauge() const { return gauge_; }

private:
    const Energy& energy_;
    const Subspace& subspace_;
    Gauge gauge_;
};

// Newton with projected Hessians where needed, for the few solves that start far away (d small: a factorisation is free).
template <class Model>
MinimizeResult minimize_newton(const Model& model, const Weights& w, const Eigen::VectorXd& start, double tolerance,
                               int max_iterations = 60);

} // namespace pliant
