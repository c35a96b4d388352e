#include "average/family.h"

#include <algorithm>

namespace pliant {

AverageFamily::AverageFamily(NewtonSolver& solver, NewtonOptions options, Progress* progress)
    : solver_(solver)
    , options_(options)
    , progress_(progress)
{
}

// Predictor-corrector: along the tangent by the derivative of the minimiser, then Newton. Intermediate points need no digits.
NewtonResult AverageFamily::follow(const Weights& from, const Shape& start, const Weights& to, int step_count)
{
    NewtonOptions rough = options_;
    rough.decrement = std::max(options_.decrement, 1e-6);
    NewtonResult result;
    result.y = start;
    int iterations = 0;
    for (int step = 1; step <= step_count; ++step) {
        const Weights here = from + (to - from) * (double(step - 1) / step_count);
        const Weights next = from + (to - from) * (double(step) / step_count);
        Shape guess = result.y + solver_.weight_derivative(here, result.y, next - here);
        // A tangent step that goes too far is worse than none.
        if (!(energy_value(solver_.energy(), next, guess) < energy_value(solver_.energy(), next, result.y)))
            guess = result.y;
        result = solver_.minimise(next, guess, step == step_count ? options_ : rough, progress_);
        iterations += result.iterations;
    }
    result.iterations = iterations;
    fix_gauge(solver_.set(), result.y);
    return result;
}

// From the pose that is nearest to all others in energy: the shortest way, and found with one evaluation per pose.
const NewtonResult& AverageFamily::mean()
{
    if (mean_) return *mean_;
    const std::size_t m = solver_.set().pose_count();
    const Weights w = equal_weights(m);
    std::size_t best = 0;
    double best_energy = energy_value(solver_.energy(), w, solver_.set().shapes[0]);
    for (std::size_t k = 1; k < m; ++k) {
        const double energy = energy_value(solver_.energy(), w, solver_.set().shapes[k]);
        if (energy < best_energy) best_energy = energy, best = k;
    }
    mean_ = solver_.minimise(w, solver_.set().shapes[best], options_, progress_);
    for (int steps = 2; !mean_->has_converged && steps <= 8; steps *= 2)
        mean_ = follow(corner_weights(m, best), solver_.set().shapes[best], w, steps);
    fix_gauge(solver_.set(), mean_->y);
    return *mean_;
}

NewtonResult AverageFamily::at(const Weights& w)
{
    const std::size_t m = solver_.set().pose_count();
    const Weights centre = equal_weights(m);
    const Shape start = mean().y;
    const double distance = (w - centre).lpNorm<1>();
    if (distance < 1e-12) return mean(); // rounding of the division by the sum of the weights
    NewtonResult result;
    // A step of about a third of the way to a corner keeps Newton inside its region of convergence on real bodies.
    for (int steps = std::max(1, int(std::ceil(distance / 0.55))), tries = 0; tries < 3; steps *= 2, ++tries) {
        result = follow(centre, start, w, steps);
        if (result.has_converged) break;
    }
    return result;
}

} // namespace pliant
