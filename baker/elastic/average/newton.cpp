#include "elastic/average/newton.h"

#include "base/common/diagnostics.h"
#include "base/mesh/tets.h"
#include "elastic/average/rigid_modes.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>

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
{
}

void fix_gauge(const NormalizedPoses& set, Shape& y) { align_to(set, set.shapes[0], y); }

void NewtonSolver::choose_pins(const Shape& y)
{
    if (set_.is_free()) {
        pins_ = statically_determinate_pins(y);
        return;
    }
    pins_.clear();
    for (std::uint32_t v : set_.fixed_vertices)
        for (int c = 0; c < 3; ++c) pins_.push_back(3 * Eigen::Index(v) + c);
}

void NewtonSolver::remove_free_motion(Eigen::MatrixXd& displacements, const Eigen::MatrixXd& modes) const
{
    if (set_.is_free()) remove_rigid_motion(displacements, modes, set_.masses);
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
    choose_pins(y);
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

// Pinning chooses one of the equivalent steps; without its rigid part it is the one that moves the body least.
Shape NewtonSolver::newton_step(const Shape& y, const Shape& gradient) const
{
    Eigen::MatrixXd right = -gradient;
    for (Eigen::Index dof : pins_) right(dof, 0) = 0;
    Eigen::MatrixXd step = cholesky_.solve(right);
    if (set_.is_free()) remove_free_motion(step, rigid_modes(y, set_.masses));
    return step;
}

// Whether no cell shrinks below a fifth of its size or flips, if that matters to the energy.
bool NewtonSolver::is_sound(const Shape& y, const Shape& moved) const
{
    if (energy_.allows_collapse()) return true;
    if (set_.is_solid())
        return std::all_of(set_.tets.begin(), set_.tets.end(), [&](const Tetrahedron& t) {
            const double before = tet_edges(y, t).determinant(), after = tet_edges(moved, t).determinant();
            return after >= 0.2 * before;
        });
    return std::all_of(set_.triangles.begin(), set_.triangles.end(), [&](const Triangle& t) {
        const Eigen::Vector3d before = double_area_vector(y, t), after = double_area_vector(moved, t);
        return after.squaredNorm() >= 0.04 * before.squaredNorm() && after.dot(before) > 0;
    });
}

// The largest of 1, 1/2, 1/4 ... that keeps the cells sound: beyond that the quadratic model says nothing, and energies that
// are finite for collapsed cells would let them collapse.
double NewtonSolver::largest_step(const Shape& y, const Shape& step) const
{
    for (double length = 1; length > 1e-6; length /= 2)
        if (is_sound(y, y + length * step)) return length;
    return 1e-6;
}

bool NewtonSolver::is_small_step(double step, const Shape& way, const NewtonOptions& options) const
{
    return step <= std::max(options.step_floor, options.step_ratio * mass_norm(way, set_.masses));
}

NewtonResult NewtonSolver::minimize(const Weights& w, const Shape& start, const NewtonOptions& options, Progress* progress)
{
    NewtonResult result;
    result.y = start;
    result.energy = energy_value(energy_, w, start);
    int failures = 0, exact_pause = 0; // of the exact Hessian
    const auto report_progress = [&] {
        if (progress) progress->update("average", double(result.iterations) / options.max_iterations);
    };
    for (; result.iterations < options.max_iterations; ++result.iterations) {
        report_progress();
        Shape gradient = Shape::Zero(start.size());
        double force_scale = 0;
        result.energy = add_gradient(energy_, w, result.y, gradient, &force_scale);
        if (result.energy < no_energy) { // of forces that are rounding no step follows
            result.decrement = result.residual = 0;
            result.has_converged = true;
            return result;
        }
        for (std::uint32_t v : set_.fixed_vertices)
            gradient.segment<3>(3 * Eigen::Index(v)).setZero(); // held, whatever pulls there
        // Forces below the rounding of a unit-area surface with unit moduli are no forces: at a pose all of them vanish.
        result.residual = gradient.norm() / std::max(force_scale, 1e-12);
        const bool is_exact = factorize_model(w, result.y, exact_pause <= 0);
        report_progress(); // the longest that an interrupt has to wait for is over
        if (is_exact)
            failures = 0;
        else if (exact_pause <= 0)
            exact_pause = std::min(longest_pause, 1 << failures++);
        else
            --exact_pause;
        if (!is_exact) ++result.projected_iterations;
        const Shape step = newton_step(result.y, gradient);
        const double slope = gradient.dot(step);
        result.decrement = -slope / 2 / scale_of(result.energy);
        const bool is_small = result.decrement <= options.decrement && result.residual <= options.residual;
        if (is_small) exact_pause = 0; // time to know
        const bool is_last = (is_small && is_exact)
            || (result.decrement <= options.step_decrement
                && is_small_step((is_exact ? 1 : projected_doubt) * mass_norm(step, set_.masses), result.y + step - start,
                                 options));

        double length = largest_step(result.y, step);
        const bool is_noise = -slope < energy_noise * scale_of(result.energy);
        double energy = 0;
        for (;; length /= 2) {
            energy = energy_value(energy_, w, result.y + length * step);
            if (is_noise || energy <= result.energy + 1e-4 * length * slope) break;
            if (length < 1e-10) { // no decrease along a descent direction: rounding rules here
                result.has_converged = result.decrement <= options.decrement;
                return result;
            }
        }
        result.y += length * step;
        result.energy = energy;
        if (is_last || (is_noise && result.residual <= options.residual)) {
            ++result.iterations;
            result.has_converged = true;
            return result;
        }
    }
    return result;
}

void NewtonSolver::factorize_equilibrium(const Weights& w, const Shape& y, HessianKind kind)
{
    choose_pins(y);
    modes_ = set_.is_free() ? rigid_modes(y, set_.masses) : Eigen::MatrixXd(y.size(), 0);
    assembler_.assemble(w, y, kind);
    pin(assembler_.matrix(), pins_);
    if (!cholesky_.factorize(assembler_.matrix())) factorize_shifted(w, y, HessianKind::projected);
}

Eigen::MatrixXd NewtonSolver::solve_equilibrium(const Eigen::MatrixXd& loads) const
{
    Eigen::MatrixXd right = loads;
    if (set_.is_free()) balance_load(right, modes_, set_.masses);
    for (Eigen::Index dof : pins_) right.row(dof).setZero();
    Eigen::MatrixXd x = cholesky_.solve(right);
    remove_free_motion(x, modes_);
    return x;
}

Shape NewtonSolver::weight_derivative(const Weights& w, const Shape& y, const Weights& direction, HessianKind kind)
{
    Shape load = Shape::Zero(y.size());
    add_gradient(energy_, direction, y, load);
    factorize_equilibrium(w, y, kind);
    return -solve_equilibrium(load);
}

} // namespace pliant
