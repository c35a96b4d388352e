// The unreduced average: argmin_y W(w, y) over all 3n unknowns, by Newton's method.
#pragma once

#include "base/common/progress.h"
#include "base/mesh/align.h"
#include "elastic/average/hessian.h"
#include "elastic/average/relaxation.h"
#include "elastic/average/sparse_cholesky.h"
#include "elastic/average/warp.h"

#include <functional>
#include <memory>

namespace pliant {

struct NewtonOptions {
    // Converged when both hold: half the squared Newton decrement is below `decrement` times the energy (1e-8 is enough for
    // snapshots, 1e-12 for tests), and the unbalanced forces are below `residual` times the forces that cancel. The second
    // one catches nearly collapsed triangles, whose huge stiffness makes any decrement small.
    double decrement = 1e-8;
    double residual = 1e-3;
    // Converged also when the Newton step, in the mass norm, is below step_floor, or below this part of the way gone since
    // the start (a third of either for steps of a projected Hessian), and the decrement below step_decrement. For snapshots
    // and checks: what is asked there is a distance between shapes, while the last digits of the energy are those of a few
    // creased triangles.
    double step_floor = 0;
    double step_ratio = 0;
    double step_decrement = 1e-5; // far from a minimum a stiff projected model makes small steps too
    int max_iterations = 80;
    // Whether the solver's last factor is that of an average near the one wanted: then steps with it come first. Without
    // progress, or near the last digits of the energy, Newton steps follow.
    bool has_near_factor = false;
};

// For averages that are the reference of others: converged also where no digit of the shape is left to gain, since forces of
// sheets whose energy is nearly 0 are noise.
NewtonOptions exact_newton(const NormalizedPoses& set);

struct NewtonResult {
    Shape y;
    double energy = 0;
    double start_energy = 0;
    double decrement = 0; // of the last iteration, relative to the energy
    double residual = 0;  // unbalanced force over the forces that cancel
    int iterations = 0;
    bool has_converged = false;
};

// Keeps the symbolic factorisation between solves. One solver per thread.
class NewtonSolver {
public:
    NewtonSolver(const Energy& energy, const NormalizedPoses& set, SolverKind kind);

    // Minimizes from `start`. The result keeps the centroid and orientation in which it was found. Calls progress->update
    // (may be null) once an iteration, which is a factorisation and the steps taken with it.
    // Fixed vertices stay where they are in `start`.
    NewtonResult minimize(const Weights& w, const Shape& start, const NewtonOptions& options, Progress* progress = nullptr);

    // A shape near a minimizer without its small creases: Relaxation::settle() down to a millionth of the energy.
    Shape settled(const Weights& w, Shape y);

    // Factors the exact Hessian of W(w, .) at an equilibrium y (a pose, an average) for solve_equilibrium. False: it has
    // negative or further zero eigenvalues, and a model without was factored. Throws Failure (P4302) if that fails, too.
    bool factorize_equilibrium(const Weights& w, const Shape& y, HessianKind kind = HessianKind::exact);

    // Solves K x = f (columns) at that equilibrium. Of a free body in the quotient by rigid motions: f is balanced, x is
    // mass-orthogonal to them. Else x vanishes at fixed vertices.
    Eigen::MatrixXd solve_equilibrium(const Eigen::MatrixXd& loads) const;

    // How the minimizer y moves when the weights move along the directions (columns): -K^-1 weight_forces(w, y, directions),
    // K the Hessian of W(w, .) at y. To four digits, with K's own factor or from the last one, which must be that of a shape
    // near y then. Cost: an assembly, and a factorisation or some solves.
    Eigen::MatrixXd weight_derivatives(const Weights& w, const Shape& y, const Eigen::MatrixXd& directions,
                                       bool has_near_factor);

    // The same with what was factored last in place of K: good enough for a step of a path.
    Eigen::MatrixXd rough_weight_derivatives(const Weights& w, const Shape& y, const Eigen::MatrixXd& directions) const;

    // y + step to first order, with turned limbs as long as before (Warp).
    Shape moved(const Shape& y, const Shape& step) const { return warp_(y, step); }

    int factorization_count() const { return cholesky_.factorization_count(); }
    const Energy& energy() const { return energy_; }
    const NormalizedPoses& set() const { return set_; }

private:
    struct Iterate;
    struct Displaced;
    class Descent;
    // Factors a positive definite model of the energy at y, the exact Hessian if it is one. False: `projected` was needed.
    bool factorize_model(const Weights& w, const Shape& y, bool try_exact);
    void factorize_shifted(const Weights& w, const Shape& y, HessianKind kind);
    void hold(const Shape& y); // chooses pins_ and modes_
    Iterate evaluate(const Weights& w, Shape y) const;

    const Relaxation& relaxation();
    Displaced displace(const Shape& y, const Shape& step) const;

    // `solve` for the matrix with its pins; loads and solutions as of solve_equilibrium().
    using Solve = std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>;
    Eigen::MatrixXd solve_free(const Eigen::MatrixXd& loads, const Solve& solve) const;

    const Energy& energy_;
    const NormalizedPoses& set_;
    HessianAssembler assembler_;
    SparseCholesky cholesky_;
    Warp warp_;
    std::unique_ptr<Relaxation> relaxation_; // made where it is needed
    std::vector<Eigen::Index>
        pins_;              // degrees of freedom that are held: those of fixed vertices, or six against rigid motions
    Eigen::MatrixXd modes_; // rigid modes of the factored shape, none of a body with fixed vertices
};

} // namespace pliant
