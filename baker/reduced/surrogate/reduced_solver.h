// The exact reduced problem, solved on the full mesh: slow and right. Snapshots, checks and training sets come from it.
#pragma once

#include "base/weights/radial_function.h"
#include "elastic/average/family.h"
#include "reduced/surrogate/surrogate_energy.h"

namespace pliant {

class ReducedSolver {
public:
    // `mean_hessian`: of the energy at the average of all poses (lower triangle), the metric of all solves. `energy_scale`:
    // the energy there. Energy and subspace must outlive it; a copy of the subspace is not made.
    ReducedSolver(const Energy& energy, const Subspace& subspace, const SparseLower& mean_hessian, double energy_scale);

    // Holds shapes where the set's frame says, if it has one.
    void hold(const NormalizedPoses& set);

    // The minimizer of W(w, .) in the subspace, by BFGS from `start`. May be called by several tasks at a time.
    // Cost: 5 to 40 gradients of the full mesh.
    MinimizeResult solve(const Weights& w, const Eigen::VectorXd& start) const;

    const Subspace& subspace() const { return reduced_.subspace(); }
    double energy_scale() const { return energy_scale_; }
    const ReducedEnergy& energy() const { return reduced_; }

    // S with S S^T = inverse of the reduced Hessian at the mean: the metric of all fits.
    const Eigen::MatrixXd& whitening() const { return whitening_; }

private:
    void measure_by(const Eigen::MatrixXd& hessian);

    ReducedEnergy reduced_;
    double energy_scale_;
    Eigen::MatrixXd hessian_; // of the elastic energy at the mean
    Eigen::MatrixXd whitening_, metric_;
};

// Where a reduced solve starts: a smooth interpolation of known averages and the poses, or the nearest of them if that is
// lower.
class ReducedStarts {
public:
    ReducedStarts(const ReducedSolver& solver, const NormalizedPoses& set);

    // Another known average, by its coordinates; ignored next to one that is there. Call fit() before the next use.
    void add(const Weights& w, const Eigen::VectorXd& q);
    void fit();

    Eigen::VectorXd operator()(const Weights& w) const;

private:
    const ReducedSolver& solver_;
    std::vector<Weights> weights_;
    std::vector<Eigen::VectorXd> coordinates_;
    RadialFunction predictor_;
};

// Eigenvalues of the reduced Hessian below this fraction of the largest are treated as this: rigid motions that the subspace
// holds almost exactly have none, and without a floor they would be amplified without bound.
constexpr double metric_floor = 1e-9;

} // namespace pliant
