#include "elastic/parts/calibrate_ties.h"

#include "base/common/parallel.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/parts/drift.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Between the weights that are looked at, and in blends, parts drift farther.
constexpr double drift_goal = 0.6 * drift_limit;

// From one try to the next. More than some hundred times the usual stiffness is another way to weld parts together, and dents them.
constexpr double raise_factor = 8;
constexpr int max_raises = 3;

// A try must lower the drift by this part to be kept.
constexpr double min_gain = 0.05;

// A part that drifts this far after all tries does so for another reason than its ties' stiffness: it rotations by 90 degrees and more.
constexpr double give_up_drift = 2 * drift_limit;

// Drift is wanted to a tenth of its limit: shapes to a part of their size.
constexpr double shape_accuracy = 1e-4;

// Balanced ties would move a rigid part by this share of the drift_goal; and no tie gets softer than this, so that all still hold.
constexpr double balance_share = 0.1, softest = 0.02;

// The equal weights first, then the middles between any two poses: parts drift most where poses are far from the average.
std::vector<Weights> probe_weights(std::size_t pose_count)
{
    std::vector<Weights> out = { equal_weights(pose_count) };
    for (std::size_t a = 0; a < pose_count && pose_count > 2; ++a)
        for (std::size_t b = 0; b < a; ++b)
            out.push_back(0.5 * (corner_weights(pose_count, a) + corner_weights(pose_count, b)));
    return out;
}

NewtonOptions rough_options(const ShapeSet& set)
{
    NewtonOptions options;
    options.decrement = 1e-5;
    options.residual = 3e-2;
    options.step_ratio = 0.05;
    options.step_floor = shape_accuracy * mass_norm(set.shapes[0], set.masses); // shapes are centred
    options.max_iterations = 15;
    return options;
}

// min 1/2 x A x - b x with x >= lowest, by descent along one coordinate after another: A is definite and has some ten to a few hundred rows.
Eigen::VectorXd minimise_above(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double lowest)
{
    Eigen::VectorXd x = Eigen::VectorXd::Ones(b.size());
    constexpr int sweeps = 200; // far more than a choice of stiffness, which is judged by what it does, can show
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::max(lowest, x[i] + (b[i] - a.col(i).dot(x)) / a(i, i));
    return x;
}

// Factors of the stiffness of a part's ties with which their forces and torques on the part cancel where it is wanted, at all weights as
// nearly as can be. `places` of the same ties at these weights.
Eigen::VectorXd balance_factors(const std::vector<const PartPlaces*>& places, const Eigen::VectorXd& stiffness,
                                double diagonal)
{
    const Eigen::Index n = stiffness.size(), count = Eigen::Index(places.size());
    Eigen::MatrixXd rows(6 * count, n);
    const double unit = stiffness.sum() * balance_share * drift_goal * diagonal;
    for (Eigen::Index j = 0; j < count; ++j) {
        const PartPlaces& at = *places[std::size_t(j)];
        const Eigen::Matrix3Xd arms = at.expected.colwise() - at.expected.rowwise().mean();
        const double radius = std::max(arms.colwise().norm().maxCoeff(), 1e-6 * diagonal); // a single tie has none
        for (Eigen::Index i = 0; i < n; ++i) {
            const Eigen::Vector3d force = stiffness[i] / unit * (at.target.col(i) - at.expected.col(i)), arm = arms.col(i);
            rows.col(i).segment<3>(6 * j) = force;
            rows.col(i).segment<3>(6 * j + 3) = arm.cross(force) / radius;
        }
    }
    const Eigen::MatrixXd matrix = rows.transpose() * rows + Eigen::MatrixXd::Identity(n, n) / double(n);
    return minimise_above(matrix, Eigen::VectorXd::Constant(n, 1 / double(n)), softest);
}

// One group of ties (place_parts): the best that is known, and what is tried next: its joint, if it has one, and where that is not good
// enough its ties as they were found, and then stiffer or softer ones.
struct StiffnessSearch {
    enum class Try { joint, balance, raise, lower, none } next = Try::balance;
    Eigen::VectorXd first, best, tried;  // stiffness
    double drift = -1, joint_drift = -1; // of the best ties, of the joint; -1: not known
    int count = 0;                       // of tries of this sort

    bool is_done() const { return next == Try::none; }
    bool is_joint_better() const { return joint_drift >= 0 && (drift < 0 || joint_drift < (1 - min_gain) * drift); }
    bool uses_joint() const { return next == Try::joint || (is_done() && is_joint_better()); }
    double final_drift() const { return is_joint_better() ? joint_drift : drift; }

    void start(const Eigen::VectorXd& stiffness, bool has_joint)
    {
        first = best = tried = stiffness;
        if (has_joint) next = Try::joint;
    }

    void record(double found, double wanted)
    {
        if (is_done()) return;
        if (next == Try::joint) {
            joint_drift = found;
            next = found <= wanted ? Try::none : Try::balance;
            return;
        }
        const bool is_first = drift < 0, is_better = is_first || found < (1 - min_gain) * drift;
        if (is_better) best = tried, drift = found;
        if (drift <= wanted) next = Try::none;
        if (is_first || is_done()) return;
        const bool goes_on = next != Try::balance && is_better && count < max_raises;
        const bool was_raised = next == Try::raise && (is_better || count > 1);
        if (!goes_on) {
            next = next == Try::balance ? Try::raise : next == Try::raise && !was_raised ? Try::lower : Try::none;
            count = 0;
        }
    }

    void propose(const std::vector<const PartPlaces*>& places, double diagonal)
    {
        tried = best;
        if (drift < 0) return; // the ties as they are have their turn
        ++count;
        if (next == Try::balance) tried = best.cwiseProduct(balance_factors(places, best, diagonal));
        if (next == Try::raise) tried *= raise_factor;
        if (next == Try::lower) tried /= raise_factor;
    }
};

// All groups, at all weights.
class TieCalibration {
public:
    TieCalibration(TiedEnergy& energy, const ShapeSet& set, const std::vector<Weights>& weights)
        : energy_(energy)
        , set_(set)
        , weights_(weights)
    {
        for (const PartPlaces& places : place_parts(energy.ties(), set, weights[0], set.shapes[0])) {
            searches_.emplace_back();
            searches_.back().start(stiffness_of(places), joint_of(energy.ties(), places.first) != nullptr);
        }
        energy_.choose(first_stiffness(), used_joints());
    }

    // Looks at averages and sets the next stiffness. False: that is the last one.
    bool next_round(const std::vector<Shape>& shapes)
    {
        std::vector<std::vector<PartPlaces>> all;
        for (std::size_t j = 0; j < shapes.size(); ++j)
            all.push_back(place_parts(energy_.ties(), set_, weights_[j], shapes[j]));
        std::vector<double> stiffness;
        bool is_done = true;
        for (std::size_t g = 0; g < searches_.size(); ++g) {
            std::vector<const PartPlaces*> places;
            for (const auto& at : all) places.push_back(&at[g]);
            StiffnessSearch& search = searches_[g];
            search.record(largest_drift(places), drift_goal * set_.diagonal);
            search.propose(places, set_.diagonal);
            is_done = is_done && search.is_done();
            stiffness.insert(stiffness.end(), search.tried.begin(), search.tried.end());
        }
        if (is_done && is_hopeless()) stiffness = first_stiffness();
        energy_.choose(stiffness, used_joints());
        return !is_done;
    }

private:
    Eigen::VectorXd stiffness_of(const PartPlaces& places) const
    {
        Eigen::VectorXd out(places.actual.cols());
        for (Eigen::Index i = 0; i < out.size(); ++i) out[i] = energy_.ties().ties[places.first + std::size_t(i)].stiffness;
        return out;
    }

    // Then the character is not to be strained for nothing: stiff ties make several minima where parts turn far.
    bool is_hopeless() const
    {
        return std::any_of(searches_.begin(), searches_.end(), [&](const StiffnessSearch& search) {
            return search.final_drift() > give_up_drift * set_.diagonal;
        });
    }

    std::vector<double> first_stiffness() const
    {
        std::vector<double> out;
        for (const StiffnessSearch& search : searches_) out.insert(out.end(), search.first.begin(), search.first.end());
        return out;
    }

    // Joints have the order of the groups that have one.
    std::vector<bool> used_joints() const
    {
        std::vector<bool> out;
        std::size_t first_tie = 0;
        for (const StiffnessSearch& search : searches_) {
            if (joint_of(energy_.ties(), first_tie)) out.push_back(search.uses_joint());
            first_tie += std::size_t(search.first.size());
        }
        return out;
    }

    static double largest_drift(const std::vector<const PartPlaces*>& places)
    {
        double out = 0;
        for (const PartPlaces* at : places) out = std::max(out, (at->actual - at->expected).colwise().norm().maxCoeff());
        return out;
    }

    TiedEnergy& energy_;
    const ShapeSet& set_;
    const std::vector<Weights>& weights_;
    std::vector<StiffnessSearch> searches_;
};

} // namespace

void calibrate_ties(TiedEnergy& energy, const ShapeSet& set, SolverKind solver, Progress* progress)
{
    const std::vector<Weights> weights = probe_weights(set.pose_count());
    TieCalibration calibration(energy, set, weights);
    SolverPool pool(energy, set, solver);
    AverageFamily family(pool, rough_options(set), progress);
    family.mean();
    std::vector<Shape> shapes(weights.size());
    SharedProgress shared(progress);
    shared.describe("ties", 0, "how far parts drift");
    for_each_task(shapes.size(),
                  [&](std::size_t i, std::size_t worker) { shapes[i] = family.at(weights[i], worker, &shared).average.y; });
    for (int round = 1; calibration.next_round(shapes); ++round) {
        shared.describe("ties", 0, fmt::format("round {}", round));
        for_each_task(shapes.size(), [&](std::size_t i, std::size_t worker) {
            shapes[i] = family.near(shapes[i], weights[i], worker, &shared).y;
        });
    }
    energy.drop_unused();
}

} // namespace pliant
