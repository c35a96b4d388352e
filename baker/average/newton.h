// The unreduced average: argmin_y W(w, y) over all 3n unknowns, by Newton's method.
#pragma once

#include "average/sparse_cholesky.h"
#include "mesh/align.h"
#include "report/progress.h"

namespace pliant {

struct NewtonOptions {
    // Converged when both hold: half the squared Newton decrement is below `decrement` times the energy (1e-8 is enough for
    // snapshots, 1e-12 for tests), and the unbalanced forces are below `residual` times the forces that cancel. The second one
    // catches nearly collapsed triangles, whose huge stiffness makes any decrement small.
    double decrement = 1e-8;
    double residual = 1e-3;
    int max_iterations = 80;
};

struct NewtonResult {
    Shape y;
    double energy = 0;
    double decrement = 0; // of the last iteration, relative to the energy
    double residual = 0;  // unbalanced force over the forces that cancel
    int iterations = 0;
    int projected_iterations = 0; // how many had an indefinite Hessian
    bool has_converged = false;
};

// Keeps the symbolic factorisation between solves. One solver per thread.
class NewtonSolver {
public:
    NewtonSolver(const Energy& energy, const ShapeSet& set, SolverKind kind);

    // Minimises from `start`. The result keeps the centroid and orientation in which it was found. Calls progress->update (may be
    // null) once an iteration.
    NewtonResult minimise(const Weights& w, const Shape& start, const NewtonOptions& options, Progress* progress = nullptr);

    // Factors the exact Hessian of W(w, .) at an equilibrium y (a pose, an average) for solve_equilibrium. Throws Failure (P4302)
    // if it has negative or further zero eigenvalues.
    void factorize_equilibrium(const Weights& w, const Shape& y);

    // Solves K x = f (columns) at that equilibrium in the quotient by rigid motions: f is balanced, x is mass-orthogonal to them.
    Eigen::MatrixXd solve_equilibrium(const Eigen::MatrixXd& loads) const;

    // How the minimiser y moves when the weights move: -K(w)^-1 sum_k direction_k grad W_k(y).
    Shape weight_derivative(const Weights& w, const Shape& y, const Weights& direction);

    int factorization_count() const { return cholesky_.factorization_count(); }
    const Energy& energy() const { return energy_; }
    const ShapeSet& set() const { return set_; }

private:
    // Factors a positive definite model of the energy at y, the exact Hessian if it is one. False: `projected` was needed.
    bool factorize_model(const Weights& w, const Shape& y);
    void factorize_shifted(const Weights& w, const Shape& y, HessianKind kind);
    Shape newton_step(const Shape& y, const Shape& gradient) const;
    double largest_step(const Shape& y, const Shape& step) const;

    const Energy& energy_;
    const ShapeSet& set_;
    HessianAssembler assembler_;
    SparseCholesky cholesky_;
    std::vector<Eigen::Index> pins_;
    Eigen::MatrixXd modes_; // rigid modes at the factored equilibrium
};

// Moves a shape rigidly onto pose 0, in place: the gauge of every average that leaves the baker.
void fix_gauge(const ShapeSet& set, Shape& y);

} // namespace pliant
