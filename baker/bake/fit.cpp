#include "bake/fit.h"

#include "bake/estimate.h"
#include "bake/make_energy.h"
#include "base/common/parallel.h"
#include "base/weights/sampling.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/energy/solid.h"
#include "pliant_format.h"

#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <iterator>
#include <map>
#include <numeric>

namespace pliant {

namespace {

// Exactness is worth a frame that costs twice as much as one with cubature, as it does here (runtime/README.md), and not
// many times as much: the table grows with the fourth power of the dimension.
constexpr Eigen::Index quartic_dimension_wanted = 32;

// Of a limited time: when the last fit is to end.
constexpr double fit_share = 0.85;

// Share of the unit of energies that an error of one tolerance may cost. Soft directions then follow the unreduced average,
// stiff ones the energy (training_of). With a much larger share training shapes get creased.
constexpr double nearness_share = 0.003;

// With larger tolerances, training data are kept as near to the averages as with this one: where the stiffness is known at
// few averages only, energies would lead farther away.
constexpr double largest_nearness_tolerance = 1e-3;

double nearness_wanted(const NormalizedPoses& set, double energy_scale, double tolerance)
{
    const double off
        = std::min(tolerance, largest_nearness_tolerance) * mass_norm(set.shapes[0], set.masses); // shapes are centred
    return 2 * nearness_share * energy_scale / (off * off);
}

std::vector<AverageAt> checks_of(const FoundSubspace& found)
{
    std::vector<AverageAt> out;
    for (const CheckPoint& check : found.checks) out.push_back({ check.weights, &check.reference });
    return out;
}

// The fits of one bake.
class Fitter {
public:
    Fitter(const FitProblem& problem, const BakeOptions& options, Progress& progress)
        : p_(problem)
        , options_(options)
        , progress_(progress)
        , nearness_(nearness_wanted(p_.set, p_.family.energy_scale(p_.domain), options.tolerance))
    {
        const AverageProjector projector(p_.energy, all(), p_.set, &progress);
        std::vector<AverageAt> averages = distinct_averages(p_.found.averages, corner_weights_of(p_.energy));
        const auto rest = std::stable_partition(averages.begin(), averages.end(),
                                                [](const AverageAt& average) { return !average.is_interpolated; });
        averages_ = projector.project({ averages.begin(), rest });
        exact_count_ = averages_.size();
        if (!p_.found.has_sound_interpolations) averages.erase(rest, averages.end());
        std::vector<ProjectedAverage> interpolated = projector.project({ rest, averages.end() }, averages_);
        checks_
            = exact_count_ > 0 ? projector.project(checks_of(p_.found), averages_) : projector.project(checks_of(p_.found));
        std::move(interpolated.begin(), interpolated.end(), std::back_inserter(averages_));
    }

    FittedModel choose();

private:
    const Subspace& all() const { return p_.found.subspace; }
    bool chooses_dimension() const { return !averages_.empty() && !options_.dimension && !p_.found.checks.empty(); }
    SurrogateOptions surrogate_options() const
    {
        return { options_.tolerance, options_.tolerance_max,   options_.element_count,
                 options_.seed,      options_.cubature_solver, p_.budget.part(fit_share) };
    }
    double training_error(Eigen::Index d) const;
    Eigen::Index least_dimension() const;
    bool wants_quartic(std::string& reason) const;
    FittedModel fit_quartic(Eigen::Index most);
    FittedModel choose_surrogate();
    FittedModel fit_least(Eigen::Index most, const Quartic* quartic);
    FittedModel fit_at(Eigen::Index d, const Quartic* quartic);
    TrainingSet train(const ReducedSolver& reduced) const;
    ChosenModel fit_surrogate(const ReducedEnergy& reduced, const Quartic* quartic, FittedModel& out) const;
    ChosenModel fit_ghost(const Subspace& subspace, const Gauge& gauge, FittedModel& out) const;

    const FitProblem& p_;
    const BakeOptions& options_;
    Progress& progress_;
    std::vector<ProjectedAverage> averages_, checks_;
    std::size_t exact_count_ = 0; // of the averages; the others are interpolated
    double nearness_;             // of training data to the averages
};

// Mean distance of reduced averages in d dimensions, as training data are, from the checks.
double Fitter::training_error(Eigen::Index d) const
{
    double mean = 0;
    for (const ProjectedAverage& check : checks_) {
        const double size = mass_norm(*check.shape, p_.set.masses);
        const double outside = mass_dot(*check.shape - all().rest, *check.shape - all().rest, p_.set.masses)
            - check.nearest.head(d).squaredNorm();
        const double inside = (reduced_average(check, d, nearness_) - check.nearest.head(d)).squaredNorm();
        mean += std::sqrt(std::max(0.0, outside) + inside) / size / double(checks_.size());
    }
    return mean;
}

// Blends follow their training data: fewer dimensions than these take need not be tried.
Eigen::Index Fitter::least_dimension() const
{
    Eigen::Index low = std::min<Eigen::Index>(Eigen::Index(p_.set.pose_count()) - 1, all().dimension()),
                 high = all().dimension();
    while (low < high) {
        const Eigen::Index middle = (low + high) / 2;
        if (training_error(middle) <= options_.tolerance)
            high = middle;
        else
            low = middle + 1;
    }
    return high;
}

TrainingSet Fitter::train(const ReducedSolver& reduced) const
{
    const std::size_t m = p_.set.pose_count();
    if (averages_.empty())
        return solve_training_set(reduced, p_.set, training_weights(m, training_count(m), options_.seed), &progress_);
    return training_of(reduced, averages_, exact_count_, nearness_);
}

ChosenModel Fitter::fit_ghost(const Subspace& subspace, const Gauge& gauge, FittedModel& out) const
{
    progress_.update("ghost", 0);
    out.ghost = std::make_unique<Ghost>(make_ghost(p_.set, subspace, options_.ghost_vertex_count));
    out.ghost_energy = make_energy(out.ghost->set, options_.energy);
    std::vector<std::size_t> elements(out.ghost_energy->element_count());
    std::iota(elements.begin(), elements.end(), std::size_t(0));
    auto surrogate = std::make_shared<SurrogateEnergy>(*out.ghost_energy, out.ghost->set.shapes[0], out.ghost->basis,
                                                       elements, Eigen::VectorXd::Ones(Eigen::Index(elements.size())));
    surrogate->hold(gauge);
    return fit_model(surrogate, subspace, p_.set, out.training, p_.found.checks, gauge.stiffness > 0, surrogate_options());
}

// `quartic`: of at least as many dimensions; null: another kind.
ChosenModel Fitter::fit_surrogate(const ReducedEnergy& reduced, const Quartic* quartic, FittedModel& out) const
{
    if (options_.surrogate == SurrogateKind::ghost) return fit_ghost(reduced.subspace(), reduced.gauge(), out);
    if (!quartic) return choose_cubature(reduced, p_.set, out.training, p_.found.checks, surrogate_options(), &progress_);
    Quartic polynomial = quartic->leading(reduced.subspace().dimension());
    const Gauge& gauge = reduced.gauge();
    const bool is_held = gauge.stiffness > 0;
    if (is_held) polynomial.hold(gauge.along, gauge.wanted, gauge.stiffness);
    auto surrogate = std::make_shared<const SurrogateEnergy>(reduced.energy(), std::move(polynomial));
    return fit_model(std::move(surrogate), reduced.subspace(), p_.set, out.training, p_.found.checks, is_held,
                     surrogate_options());
}

FittedModel Fitter::fit_at(Eigen::Index d, const Quartic* quartic)
{
    FittedModel out;
    out.subspace = leading(all(), d);
    ReducedSolver reduced(p_.energy, out.subspace, p_.family.mean_hessian(), p_.family.energy_scale(p_.domain));
    reduced.hold(p_.set);
    out.training = train(reduced);
    ChosenModel chosen = fit_surrogate(reduced.energy(), quartic, out);
    out.model = std::move(chosen.model);
    out.report.surrogate = chosen.report;
    return out;
}

// An adaptive subspace holds more dimensions than it may need: as few of at most `most` as keep the tolerance.
FittedModel Fitter::fit_least(Eigen::Index most, const Quartic* quartic)
{
    if (!chooses_dimension()) return fit_at(most, quartic);
    std::map<Eigen::Index, FittedModel> fits;
    const auto error_at = [&](Eigen::Index d) {
        FittedModel& fit = fits[d] = fit_at(d, quartic);
        fit.subspace = {}; // large, and the same for all
        return fit.report.surrogate.error();
    };
    const Eigen::Index chosen = choose_dimension(
        std::min(most, least_dimension()), most, surrogate_options(), [&](Eigen::Index d) { return training_error(d); },
        error_at);
    FittedModel out = std::move(fits.at(chosen));
    out.subspace = leading(all(), chosen);
    return out;
}

// Whether `auto` tries the quartic, and why not.
bool Fitter::wants_quartic(std::string& reason) const
{
    const auto* solid = dynamic_cast<const Solid*>(&p_.energy);
    if (options_.surrogate == SurrogateKind::quartic) return true;
    if (options_.surrogate != SurrogateKind::automatic || !solid || solid->law() != SolidLaw::stvk) return false;
    const Eigen::Index least = chooses_dimension() ? least_dimension() : all().dimension();
    if (least <= quartic_dimension_wanted) return true;
    reason = fmt::format("d = {} at least, and above {} a quartic is much slower than cubature", least,
                         quartic_dimension_wanted);
    return false;
}

FittedModel Fitter::fit_quartic(Eigen::Index most)
{
    const Quartic quartic(dynamic_cast<const Solid&>(p_.energy), leading(all(), most), &progress_);
    FittedModel out = fit_least(most, &quartic);
    out.report.kind = SurrogateKind::quartic;
    return out;
}

FittedModel Fitter::choose_surrogate()
{
    const bool is_asked = options_.surrogate == SurrogateKind::quartic;
    std::string reason;
    if (wants_quartic(reason)) {
        const Eigen::Index most = std::min<Eigen::Index>(
            all().dimension(), is_asked ? PLIANT_FORMAT_MAX_QUARTIC_DIMENSION : quartic_dimension_wanted);
        FittedModel out = fit_quartic(most);
        const bool is_enough = out.report.surrogate.error().mean <= options_.tolerance;
        if (is_asked || most == all().dimension() || is_enough) return out;
        reason = fmt::format("at d = {} the tolerance is not kept, and above it a quartic is much slower", most);
    }
    FittedModel out = fit_least(all().dimension(), nullptr);
    out.report.kind = options_.surrogate == SurrogateKind::ghost ? SurrogateKind::ghost : SurrogateKind::cubature;
    out.report.reason = reason;
    return out;
}

FittedModel Fitter::choose()
{
    FittedModel out = choose_surrogate();
    FitReport& report = out.report;
    report.dimension = out.subspace.dimension();
    report.element_count = out.model.surrogate->element_count();
    report.training_count = out.training.weights.size();
    report.unconverged_training_count = out.training.unconverged_count;
    report.subspace_error = subspace_error(out.subspace, p_.set, p_.found.checks);
    return out;
}

} // namespace

Shape FittedModel::mean_shape() const
{
    return ghost ? Shape(ghost->set.shapes[0] + ghost->basis * model.mean) : subspace.shape(model.mean);
}

FittedModel fit(const FitProblem& problem, const BakeOptions& options, Progress& progress)
{
    FittedModel out = Fitter(problem, options, progress).choose();
    if (out.report.surrogate.curvature.lowest <= 0)
        progress.warn(4402,
                      fmt::format("the surrogate energy is not convex at some training weights (lowest curvature {:.3g})",
                                  out.report.surrogate.curvature.lowest),
                      "raise --elements, or add an in-between pose; `pliant measure` looks at more blends");
    return out;
}

} // namespace pliant
