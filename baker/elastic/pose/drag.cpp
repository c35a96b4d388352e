#include "elastic/pose/drag.h"

#include "base/mesh/tets.h"
#include "elastic/average/newton.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <random>

namespace pliant {

namespace {

// A start where some tetrahedron keeps less than this fraction of its volume is no useful guess of the minimum.
constexpr double least_shrink = 0.2;

// Below this fraction of the nominal step there is no way on.
constexpr double shortest_step = 1.0 / 256;

// A rough equilibrium suffices to start the next step; the last one is written.
constexpr double rough = 1e-5, precise = 1e-10;

// Handles move away from rest, so energy grows from equilibrium to equilibrium. Where it falls below this part of the last
// one, and a vertex ends this far (of the cube root of the volume) from the start that the linearised body gives, the body
// has snapped over. A bar that is twisted too far loses whole turns so.
constexpr double snap_energy = 0.95, snap_way = 0.05;

// An equilibrium of a symmetric body may be a saddle: a column that is pressed along itself stays straight. The search goes
// on from a shape this far (of the cube root of the volume) beside it, at most so often.
constexpr double nudge = 0.01;
constexpr int most_saddles = 3;

double farthest(const Shape& way)
{
    return std::sqrt(Eigen::Map<const Eigen::Matrix3Xd>(way.data(), 3, way.size() / 3).colwise().squaredNorm().maxCoeff());
}

NewtonOptions newton_options(bool is_last)
{
    NewtonOptions options;
    options.decrement = is_last ? precise : rough;
    options.max_iterations = is_last ? 60 : 25;
    return options;
}

class Dragger {
public:
    Dragger(const NormalizedPoses& rest, const Handles& handles, const SolidOptions& material)
        : rest_(rest)
        , handles_(handles)
        , energy_(rest, material)
        , solver_(energy_, rest, default_solver())
        , tangent_(energy_)
        , weights_(Weights::Ones(1))
        , y_(rest.shapes[0])
    {
        solver_.factorize_equilibrium(weights_, y_);
    }

    DragResult run(const DragReport& report);

private:
    NewtonResult equilibrium(const Shape& start, const NewtonOptions& options);
    Shape nudged(const Shape& saddle) const;
    Shape start_of(double time) const;
    bool try_step(double time, DragStep& step);
    std::size_t worst_tet(const Shape& start) const;
    [[noreturn]] void give_up(double time) const;
    Positions final_positions() const;

    const NormalizedPoses& rest_;
    const Handles& handles_;
    Solid energy_;
    NewtonSolver solver_;
    HessianAssembler tangent_; // at y_, handles not fixed: the forces of the handles on their neighbours
    Weights weights_;
    Shape y_;
    double energy_before_ = 0;       // of y_
    std::size_t bad_tet_ = 0;        // of the last rejected step
    std::size_t compressed_tet_ = 0; // of the last step in which Newton's method did not converge
};

// Random forces move a body where it is soft: sideways, where it is about to buckle.
Shape Dragger::nudged(const Shape& saddle) const
{
    std::minstd_rand random; // the same everywhere
    const Shape load
        = Shape::NullaryExpr(saddle.size(), [&] { return double(random()) / double(std::minstd_rand::max()) - 0.5; });
    const Shape way = solver_.solve_equilibrium(load);
    return saddle + nudge / farthest(way) * way;
}

// A minimum: the exact Hessian there, which is left factored, is positive definite.
NewtonResult Dragger::equilibrium(const Shape& start, const NewtonOptions& options)
{
    NewtonResult result = solver_.minimize(weights_, start, options);
    for (int i = 0; result.has_converged && !solver_.factorize_equilibrium(weights_, result.y) && i < most_saddles; ++i) {
        const int iterations = result.iterations;
        result = solver_.minimize(weights_, nudged(result.y), options);
        result.iterations += iterations;
    }
    return result;
}

// Moves the handles to their positions at `time` and the other vertices as the linearised body does. If only the handles
// moved, the tetrahedra beside them would turn over after a step of their own height.
Shape Dragger::start_of(double time) const
{
    const Positions places = handles_.at(time);
    Shape way = Shape::Zero(y_.size());
    for (std::size_t i = 0; i < handles_.vertices().size(); ++i) {
        const Eigen::Index v = handles_.vertices()[i];
        const Eigen::Vector3d target = (places.row(Eigen::Index(i)).transpose() - rest_.centre) / rest_.length;
        way.segment<3>(3 * v) = target - y_.segment<3>(3 * v);
    }
    const Shape load = -(tangent_.matrix().selfadjointView<Eigen::Lower>() * way);
    return y_ + way + solver_.solve_equilibrium(load);
}

// The tetrahedron that shrinks most, if any shrinks too much; otherwise the number of tetrahedra.
std::size_t Dragger::worst_tet(const Shape& start) const
{
    std::size_t worst = rest_.tets.size();
    double smallest = least_shrink;
    for (std::size_t t = 0; t < rest_.tets.size(); ++t) {
        const double shrink = tet_edges(start, rest_.tets[t]).determinant() / tet_edges(y_, rest_.tets[t]).determinant();
        if (shrink >= smallest) continue;
        smallest = shrink;
        worst = t;
    }
    return worst;
}

bool Dragger::try_step(double time, DragStep& step)
{
    const Shape start = start_of(time);
    bad_tet_ = worst_tet(start);
    if (bad_tet_ < rest_.tets.size()) return false;
    step.start_energy = energy_value(energy_, weights_, start);
    const NewtonResult result = equilibrium(start, newton_options(time >= 1));
    step.iterations += result.iterations;
    if (!result.has_converged) {
        compressed_tet_ = smallest_j(rest_, result.y).tet;
        return false;
    }
    const double way = farthest(result.y - start);
    step.last_energy = energy_before_;
    if (result.energy < snap_energy * energy_before_ && way > snap_way) step.snap = way * rest_.length;
    y_ = result.y;
    energy_before_ = result.energy;
    step.time = time;
    step.energy = result.energy;
    step.smallest_j = smallest_j(rest_, y_).value;
    return true;
}

void Dragger::give_up(double time) const
{
    // St. Venant-Kirchhoff softens under compression: beyond some point the only equilibrium has collapsed tetrahedra.
    const std::string hint = std::string(energy_.law() == SolidLaw::stvk ? "try --material mooney-rivlin, or " : "")
        + "turn or move by less, make the regions smaller so that more of the body can give way, or add one that guides the "
          "body";
    const bool is_inverted = bad_tet_ < rest_.tets.size();
    const std::size_t tet = is_inverted ? bad_tet_ : compressed_tet_;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const std::uint32_t v : rest_.tets[tet]) centre += point(rest_.shapes[0], v) / 4;
    centre = rest_.length * centre + rest_.centre;
    throw Failure(
        ExitCode::failed,
        error_at(4304, "",
                 fmt::format("stuck at {:.1f} % of the motion: tetrahedron {} (at rest near {:.4g} {:.4g} {:.4g}) {}",
                             100 * time, tet, centre[0], centre[1], centre[2],
                             is_inverted ? "would be inverted" : "is compressed most, and no equilibrium was found"),
                 hint));
}

// Conversion from solver units rounds, so the handles get their exact coordinates.
Positions Dragger::final_positions() const
{
    Positions positions = to_input_units(rest_, y_);
    const Positions places = handles_.at(1);
    for (std::size_t i = 0; i < handles_.vertices().size(); ++i)
        positions.row(handles_.vertices()[i]) = places.row(Eigen::Index(i));
    return positions;
}

DragResult Dragger::run(const DragReport& report)
{
    DragResult result;
    const double nominal = 1.0 / handles_.nominal_steps();
    double time = 0, length = nominal;
    while (time < 1) {
        tangent_.assemble(weights_, y_, HessianKind::exact);
        DragStep step;
        for (;; length /= 2) {
            if (length < shortest_step * nominal) give_up(time);
            // Do not leave a last step of a hundredth of a step.
            const double next = time + 1.01 * length >= 1 ? 1 : time + length;
            if (try_step(next, step)) break;
            ++step.halvings;
        }
        time = step.time;
        if (step.halvings == 0) length = std::min(nominal, 2 * length);
        ++result.steps;
        result.iterations += step.iterations;
        result.last = step;
        if (report) report(step);
    }
    result.positions = final_positions();
    return result;
}

} // namespace

SmallestJ smallest_j(const NormalizedPoses& rest, const Shape& y)
{
    SmallestJ smallest { std::numeric_limits<double>::infinity(), 0 };
    for (std::size_t t = 0; t < rest.tets.size(); ++t) {
        const double j = tet_edges(y, rest.tets[t]).determinant() / tet_edges(rest.shapes[0], rest.tets[t]).determinant();
        if (j < smallest.value) smallest = { j, t };
    }
    return smallest;
}

DragResult drag(const NormalizedPoses& rest, const Handles& handles, const SolidOptions& material, const DragReport& report)
{
    return Dragger(rest, handles, material).run(report);
}

} // namespace pliant
