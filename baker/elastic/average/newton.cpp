#include "elastic/average/newton.h"

#include "base/common/diagnostics.h"
#include "elastic/average/conjugate_gradients.h"
#include "elastic/average/lbfgs.h"
#include "elastic/average/rigid_modes.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <limits>

namespace pliant {

namespace {

// The normalized surface has area 1 and moduli of 1, so rounding alone makes energies of this size: smaller ones are zero.
constexpr double energy_floor = 1e-13;

// Of a surface of unit area and unit moduli with strains of 1e-10: the shape is a pose.
constexpr double no_energy = 1e-20;

// Comparing energies is pointless when the predicted decrease drowns in their rounding.
constexpr double energy_noise = 1e-11;

// Where the exact Hessian is indefinite it mostly stays so for some steps, and each trial costs a factorisation: after every
// failure twice as many steps are made without one, up to this.
constexpr int longest_pause = 8;

// Steps with the last factor need no Hessian. They continue while each makes the decrement smaller by this factor, or
// decreases the energy by this share of the decrease of the Newton step: where the model is far stiffer than the energy,
// decrements say little.
constexpr double least_progress = 0.5, least_gain = 0.15;
constexpr int reuse_limit = 12;

// The energy of an element rises after a step if it does by more than this share of the decrease that the step promises.
constexpr double rising_share = 1e-3;

// Vertices that could lower the energy by this part alone are settled.
constexpr double settled_share = 1e-6;

// The line search ends at this part of a step. Cells that collapse over a part below the second one do so by rounding.
constexpr double shortest_length = 1e-10, shortest_checked = 1e-6;

// Derivatives are data of an interpolation.
constexpr ConjugateGradients of_derivative { 1e-8, 20 };

// The distance left after such a step is estimated from the rate at which the steps shrink. Rates are clamped: a single one
// may be small by chance.
constexpr double least_rate = 0.1, most_rate = 0.9;

// Projected models are stiffer than the energy: their steps shrink slowly, and with a factor of 0.7 from one to the next
// what is left is about three times the step.
constexpr double projected_doubt = 3;

double scale_of(double energy) { return std::max(std::abs(energy), energy_floor); }

} // namespace

NewtonSolver::NewtonSolver(const Energy& energy, const NormalizedPoses& set, SolverKind kind)
    : energy_(energy)
    , set_(set)
    , assembler_(energy)
    , cholesky_(kind)
    , warp_(set, kind)
{
}

NewtonOptions exact_newton(const NormalizedPoses& set)
{
    NewtonOptions options;
    options.step_floor = 1e-9 * mass_norm(set.shapes[0], set.masses); // shapes are centred
    options.step_decrement = 1e-12;
    return options;
}

void NewtonSolver::hold(const Shape& y)
{
    modes_ = set_.is_free() ? rigid_modes(y, set_.masses) : Eigen::MatrixXd(y.size(), 0);
    if (set_.is_free()) {
        pins_ = statically_determinate_pins(y);
        return;
    }
    pins_.clear();
    for (std::uint32_t v : set_.fixed_vertices)
        for (int c = 0; c < 3; ++c) pins_.push_back(3 * Eigen::Index(v) + c);
}

// Last resort: a mass-like shift of the diagonal, relative to its mean, raised until the factorisation succeeds. It starts
// at the square root of rounding: smaller ones are lost in the factor of an ill-conditioned shell.
void NewtonSolver::factorize_shifted(const Weights& w, const Shape& y, HessianKind kind)
{
    for (double shift = 1e-8; shift <= 1e4; shift *= 100) {
        assembler_.assemble(w, y, kind);
        SparseLower& matrix = assembler_.matrix();
        const double mean = matrix.diagonal().cwiseAbs().mean(), mass_mean = set_.masses.mean();
        for (Eigen::Index i = 0; i < matrix.cols(); ++i) // the diagonal entry is the first of its column
            matrix.valuePtr()[matrix.outerIndexPtr()[i]] += shift * mean * set_.masses[i / 3] / mass_mean;
        pin(matrix, pins_);
        if (cholesky_.factorize(matrix)) return;
    }
    throw Failure(
        ExitCode::failed,
        error_at(4302, "", "the Hessian of the elastic energy cannot be made positive definite",
                 "the poses may contain nearly collapsed triangles; try another --membrane or a larger --thickness"));
}

bool NewtonSolver::factorize_model(const Weights& w, const Shape& y, bool try_exact)
{
    hold(y);
    if (try_exact) {
        assembler_.assemble(w, y, HessianKind::exact);
        pin(assembler_.matrix(), pins_);
        if (cholesky_.factorize(assembler_.matrix())) return true;
    }
    assembler_.assemble(w, y, HessianKind::projected);
    pin(assembler_.matrix(), pins_);
    if (!cholesky_.factorize(assembler_.matrix())) factorize_shifted(w, y, HessianKind::projected);
    return false;
}

// A shape after a step, and the cells that the step collapses.
struct NewtonSolver::Displaced {
    Shape shape;
    std::vector<std::uint32_t> collapsing;
};

// Curved, or straight where that collapses fewer cells: the rotation of a nearly collapsed cell is noise.
NewtonSolver::Displaced NewtonSolver::displace(const Shape& y, const Shape& step) const
{
    Displaced curved { warp_(y, step), {} };
    if (energy_.allows_collapse()) return curved;
    curved.collapsing = collapsing_cells(set_, y, curved.shape);
    if (curved.collapsing.empty()) return curved;
    Displaced straight { y + step, {} };
    straight.collapsing = collapsing_cells(set_, y, straight.shape);
    return straight.collapsing.size() < curved.collapsing.size() ? straight : curved;
}

const Relaxation& NewtonSolver::relaxation()
{
    if (!relaxation_) relaxation_ = std::make_unique<Relaxation>(energy_, set_);
    return *relaxation_;
}

Shape NewtonSolver::settled(const Weights& w, Shape y)
{
    relaxation().settle(w, settled_share * energy_value(energy_, w, y), y);
    return y;
}

// A shape with the energy and the forces there.
struct NewtonSolver::Iterate {
    Shape y, gradient;
    double energy = 0;
    double residual = 0; // NewtonResult::residual
};

NewtonSolver::Iterate NewtonSolver::evaluate(const Weights& w, Shape y) const
{
    Iterate at;
    at.gradient = Shape::Zero(y.size());
    double force_scale = 0;
    at.energy = add_gradient(energy_, w, y, at.gradient, &force_scale);
    for (std::uint32_t v : set_.fixed_vertices)
        at.gradient.segment<3>(3 * Eigen::Index(v)).setZero(); // held, whatever pulls there
    // Forces below the rounding of a unit-area surface with unit moduli are no forces: at a pose all of them vanish.
    at.residual = at.gradient.norm() / std::max(force_scale, 1e-12);
    at.y = std::move(y);
    return at;
}

// One call of minimize().
class NewtonSolver::Descent {
public:
    Descent(NewtonSolver& solver, const Weights& w, const Shape& start, const NewtonOptions& options)
        : solver_(solver)
        , w_(w)
        , start_(start)
        , options_(options)
        , at_(solver.evaluate(w, start))
    {
    }

    // A Newton step, and steps with its factor while they make progress. True: converged, or no step decreases the energy.
    bool iterate(Progress* progress);

    NewtonResult result;
    const Iterate& at() const { return at_; }

private:
    void factorize(Progress* progress);
    bool near_steps();
    bool newton_step();
    bool take(const Shape& step, double slope);
    bool keeps_cells(Displaced& displaced, double length);
    bool reuse_factor(const Iterate& before);
    bool advance(const Shape& step, double slope, double length, bool may_relax = false);
    Shape direction() const { return -solver_.solve_equilibrium(at_.gradient); }
    double doubt() const { return is_exact_ ? 1 : projected_doubt; }
    double relative_decrement(double slope) const { return -slope / 2 / scale_of(at_.energy); }
    bool is_small() const { return result.decrement <= options_.decrement && at_.residual <= options_.residual; }
    bool is_noise(double slope) const { return -slope < energy_noise * scale_of(at_.energy); }
    bool is_near(double left, const Shape& way) const;

    NewtonSolver& solver_;
    const Weights& w_;
    const Shape& start_;
    const NewtonOptions& options_;
    Iterate at_;
    bool tried_exact_ = false;           // the last iteration tried the exact Hessian
    bool is_relaxed_ = false;            // single patches moved after the last step
    bool is_exact_ = false;              // the factor is that of the exact Hessian
    bool is_borrowed_ = false;           // the factor is that of another average
    int failures_ = 0, exact_pause_ = 0; // of the exact Hessian
};

// Whether the shape at the end of the way counts as the minimizer if it is `left` away from it.
bool NewtonSolver::Descent::is_near(double left, const Shape& way) const
{
    return result.decrement <= options_.step_decrement
        && left <= std::max(options_.step_floor, options_.step_ratio * mass_norm(way, solver_.set_.masses));
}

void NewtonSolver::Descent::factorize(Progress* progress)
{
    tried_exact_ = exact_pause_ <= 0;
    is_exact_ = solver_.factorize_model(w_, at_.y, tried_exact_);
    if (progress) progress->update("average", double(result.iterations) / options_.max_iterations);
    if (is_exact_)
        failures_ = 0;
    else if (tried_exact_)
        exact_pause_ = std::min(longest_pause, 1 << failures_++);
    else
        --exact_pause_;
}

// Whether the move collapses no cell, if need be after single patches have been relaxed.
bool NewtonSolver::Descent::keeps_cells(Displaced& displaced, double length)
{
    if (displaced.collapsing.empty() || length <= shortest_checked) return true;
    return is_relaxed_ = solver_.relaxation().mend(w_, at_.y, displaced.collapsing, displaced.shape);
}

// Goes along a step with the given slope if that collapses no cell and decreases the energy, if need be and allowed after
// patches have been relaxed where it rises.
bool NewtonSolver::Descent::advance(const Shape& step, double slope, double length, bool may_relax)
{
    is_relaxed_ = false;
    Displaced displaced = solver_.displace(at_.y, length * step);
    if (!keeps_cells(displaced, length)) return false;
    const double wanted = is_noise(slope) ? std::numeric_limits<double>::infinity() : at_.energy + 1e-4 * length * slope;
    Iterate next = solver_.evaluate(w_, std::move(displaced.shape));
    if (!(next.energy <= wanted) && may_relax
        && solver_.relaxation().lower(w_, at_.y, -rising_share * length * slope, next.y)) {
        is_relaxed_ = true;
        next = solver_.evaluate(w_, std::move(next.y));
    }
    if (!(next.energy <= wanted)) return false;
    at_ = std::move(next);
    return true;
}

// The longest part of a step that decreases the energy. Half of it without relaxed patches is better than all of it with:
// from a step that is too long they may end in another minimum.
bool NewtonSolver::Descent::take(const Shape& step, double slope)
{
    if (advance(step, slope, 1) || advance(step, slope, 0.5)) return true;
    for (double length = 1; length >= shortest_length; length /= 2)
        if (advance(step, slope, length, true)) return true;
    return false;
}

bool NewtonSolver::Descent::newton_step()
{
    const Shape step = direction();
    const double slope = at_.gradient.dot(step);
    result.decrement = relative_decrement(slope);
    if (is_small() || is_noise(slope)) exact_pause_ = 0; // time to know
    const bool is_last
        = (is_small() && is_exact_) || is_near(doubt() * mass_norm(step, solver_.set_.masses), at_.y + step - start_);
    const bool is_last_digit = is_noise(slope) && tried_exact_ && at_.residual <= options_.residual;
    const Iterate before = at_;
    if (!take(step, slope)) { // no decrease along a descent direction: rounding rules here
        result.has_converged = result.decrement <= options_.decrement;
        return true;
    }
    result.has_converged = (is_last && !is_relaxed_) || is_last_digit;
    return result.has_converged || reuse_factor(before);
}

// Limited-memory BFGS from the last Newton step on. True: converged.
bool NewtonSolver::Descent::reuse_factor(const Iterate& before)
{
    const Eigen::VectorXd& masses = solver_.set_.masses;
    LimitedMemoryBfgs memory;
    memory.add(at_.y - before.y, at_.gradient - before.gradient);
    const double enough = least_gain * (before.energy - at_.energy);
    double last_length = mass_norm(at_.y - before.y, masses), gain = before.energy - at_.energy;
    for (int i = 0; i < reuse_limit && !result.has_converged; ++i) {
        const Shape step
            = memory.direction(at_.gradient, [&](const Shape& load) -> Shape { return solver_.solve_equilibrium(load); });
        const double slope = at_.gradient.dot(step), last_decrement = result.decrement;
        if (!(slope < 0)) return false;
        if (relative_decrement(slope) > least_progress * last_decrement && !(gain > enough)) return false;
        result.decrement = relative_decrement(slope);
        // A Newton step with the exact Hessian finds out whether this is a minimum. Steps of a projected one say too little
        // about how far that is.
        if ((is_small() && !is_exact_ && !is_borrowed_) || is_noise(slope)) {
            exact_pause_ = 0;
            return result.has_converged = is_borrowed_ && is_small();
        }
        const double length = mass_norm(step, masses), rate = std::clamp(length / last_length, least_rate, most_rate);
        const bool is_last = is_near(doubt() * length * rate / (1 - rate), at_.y + step - start_);
        const Iterate last = at_;
        if (!advance(step, slope, 1)) return false;
        memory.add(at_.y - last.y, at_.gradient - last.gradient);
        gain = last.energy - at_.energy;
        last_length = length;
        result.has_converged = is_last && !is_relaxed_;
    }
    return result.has_converged;
}

// Steps with the factor of another average. True: converged.
bool NewtonSolver::Descent::near_steps()
{
    const Shape step = direction();
    const double slope = at_.gradient.dot(step);
    result.decrement = relative_decrement(slope);
    if (is_noise(slope)) return false;
    const Iterate before = at_;
    is_borrowed_ = true;
    const bool has_converged = advance(step, slope, 1) && reuse_factor(before);
    is_borrowed_ = false;
    return has_converged;
}

bool NewtonSolver::Descent::iterate(Progress* progress)
{
    if (at_.energy < no_energy) { // of forces that are rounding no step follows
        result.decrement = at_.residual = 0;
        return result.has_converged = true;
    }
    if (options_.has_near_factor && result.iterations == 0 && near_steps()) return true;
    factorize(progress);
    ++result.iterations;
    return newton_step();
}

NewtonResult NewtonSolver::minimize(const Weights& w, const Shape& start, const NewtonOptions& options, Progress* progress)
{
    Descent descent(*this, w, start, options);
    descent.result.start_energy = descent.at().energy;
    if (progress) progress->update("average", 0);
    while (descent.result.iterations < options.max_iterations && !descent.iterate(progress)) {}
    NewtonResult result = std::move(descent.result);
    result.y = descent.at().y;
    result.energy = descent.at().energy;
    result.residual = descent.at().residual;
    return result;
}

bool NewtonSolver::factorize_equilibrium(const Weights& w, const Shape& y, HessianKind kind)
{
    hold(y);
    assembler_.assemble(w, y, kind);
    pin(assembler_.matrix(), pins_);
    if (cholesky_.factorize(assembler_.matrix())) return true;
    factorize_shifted(w, y, HessianKind::projected);
    return false;
}

Eigen::MatrixXd NewtonSolver::solve_free(const Eigen::MatrixXd& loads, const Solve& solve) const
{
    Eigen::MatrixXd right = loads;
    if (set_.is_free()) balance_load(right, modes_, set_.masses);
    for (Eigen::Index dof : pins_) right.row(dof).setZero();
    Eigen::MatrixXd x = solve(right);
    if (set_.is_free()) remove_rigid_motion(x, modes_, set_.masses);
    return x;
}

Eigen::MatrixXd NewtonSolver::solve_equilibrium(const Eigen::MatrixXd& loads) const
{
    return solve_free(loads, [&](const Eigen::MatrixXd& right) { return cholesky_.solve(right); });
}

Eigen::MatrixXd NewtonSolver::rough_weight_derivatives(const Weights& w, const Shape& y,
                                                       const Eigen::MatrixXd& directions) const
{
    return solve_equilibrium(-weight_forces(energy_, w, y, directions));
}

Eigen::MatrixXd NewtonSolver::weight_derivatives(const Weights& w, const Shape& y, const Eigen::MatrixXd& directions,
                                                 bool has_near_factor)
{
    const Eigen::MatrixXd loads = -weight_forces(energy_, w, y, directions);
    if (has_near_factor) {
        if (set_.is_free()) modes_ = rigid_modes(y, set_.masses);
        assembler_.assemble(w, y, HessianKind::exact);
        pin(assembler_.matrix(), pins_);
        bool is_enough = false;
        const Eigen::MatrixXd moves = solve_free(loads, [&](const Eigen::MatrixXd& right) {
            ConjugateGradientsResult result = conjugate_gradients(
                assembler_.matrix(), right, [&](const Eigen::MatrixXd& load) { return cholesky_.solve(load); },
                of_derivative);
            is_enough = result.has_converged;
            return std::move(result.x);
        });
        if (is_enough) return moves;
    }
    factorize_equilibrium(w, y);
    return solve_equilibrium(loads);
}

} // namespace pliant
