#include "elastic/parts/calibrate_ties.h"

#include "base/common/parallel.h"
#include "base/weights/weights.h"
#include "elastic/average/family.h"
#include "elastic/average/rigid_modes.h"
#include "elastic/parts/drift.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// The drift to reach here. Blends, and averages at other weights, drift more than the averages that are measured.
constexpr double drift_goal = 0.6 * drift_limit;

// Factor between two tries, and their number. Some hundred times the usual stiffness would weld parts together and dent
// them.
constexpr double raise_factor = 8;
constexpr int max_raises = 3;

// A try is kept if it lowers the drift by at least this share.
constexpr double min_gain = 0.05;

// Above this drift after all tries the stiffness is not the cause: the part rotates by 90 degrees or more.
constexpr double give_up_drift = 2 * drift_limit;

// Accuracy of the averages, relative to the size of the shape. Drift needs to be known to a tenth of its limit only.
constexpr double shape_accuracy = 1e-4;

// The unbalanced force on a rigid part that counts as 1 would displace it by this share of drift_goal. No stiffness gets a
// smaller factor than min_factor, so that every tie still holds.
constexpr double balance_share = 0.1, min_factor = 0.02;

// Pairs of poses that are looked at; those of few_poses are all.
constexpr std::size_t most_pairs = few_poses * (few_poses - 1) / 2;

// The equal weights first, then the middle of every two poses, of many poses of some pairs evenly spread over all: parts
// drift most where the poses are far from the average.
std::vector<Weights> probe_weights(std::size_t pose_count)
{
    std::vector<Weights> out = { equal_weights(pose_count) };
    if (pose_count == 2) return out;
    const std::size_t pair_count = pose_count * (pose_count - 1) / 2, stride = (pair_count + most_pairs - 1) / most_pairs;
    for (std::size_t a = 1, pair = 0; a < pose_count; ++a)
        for (std::size_t b = 0; b < a; ++b, ++pair)
            if (pair % stride == 0) out.push_back(0.5 * (corner_weights(pose_count, a) + corner_weights(pose_count, b)));
    return out;
}

NewtonOptions rough_options(const NormalizedPoses& set)
{
    NewtonOptions options;
    options.decrement = 1e-5;
    options.residual = 3e-2;
    options.step_ratio = 0.05;
    options.step_floor = shape_accuracy * mass_norm(set.shapes[0], set.masses); // shapes are centred
    options.max_iterations = 15;
    return options;
}

// Minimizes 1/2 x A x - b x subject to x >= lowest by coordinate descent. A: positive definite, ten to a few hundred rows.
Eigen::VectorXd minimize_above(const Eigen::MatrixXd& a, const Eigen::VectorXd& b, double lowest)
{
    Eigen::VectorXd x = Eigen::VectorXd::Ones(b.size());
    constexpr int sweeps = 200; // more than enough: the result is a try, kept only if it lowers the drift
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::max(lowest, x[i] + (b[i] - a.col(i).dot(x)) / a(i, i));
    return x;
}

// Forces and torques of the ties of a part (6 x ties) on the part in its expected place, torques divided by its radius.
// `unit`: the force that counts as 1.
Eigen::MatrixXd wrenches(const PartPlaces& places, const Eigen::VectorXd& stiffness, double unit, double diagonal)
{
    const Eigen::Matrix3Xd arms = places.expected.colwise() - places.expected.rowwise().mean();
    const double radius = std::max(arms.colwise().norm().maxCoeff(), 1e-6 * diagonal); // 0 for a single tie
    Eigen::MatrixXd out(6, stiffness.size());
    for (Eigen::Index i = 0; i < stiffness.size(); ++i) {
        const Eigen::Vector3d force = stiffness[i] / unit * (places.target.col(i) - places.expected.col(i)),
                              arm = arms.col(i);
        out.col(i).head<3>() = force;
        out.col(i).tail<3>() = arm.cross(force) / radius;
    }
    return out;
}

// Factors of the stiffness of a part's ties with which forces and torques on the part in its expected place cancel as well
// as possible at all weights (least squares, regularised towards 1). `places`: the part at each of the weights.
Eigen::VectorXd balance_factors(const std::vector<const PartPlaces*>& places, const Eigen::VectorXd& stiffness,
                                double diagonal)
{
    const Eigen::Index n = stiffness.size(), count = Eigen::Index(places.size());
    Eigen::MatrixXd rows(6 * count, n);
    const double unit = stiffness.sum() * balance_share * drift_goal * diagonal;
    for (Eigen::Index j = 0; j < count; ++j)
        rows.middleRows<6>(6 * j) = wrenches(*places[std::size_t(j)], stiffness, unit, diagonal);
    const Eigen::MatrixXd matrix = rows.transpose() * rows + Eigen::MatrixXd::Identity(n, n) / double(n);
    return minimize_above(matrix, Eigen::VectorXd::Constant(n, 1 / double(n)), min_factor);
}

// The search for one group of ties (place_parts). Tries, in this order: the joint, if there is one; the ties as found;
// balanced ties; stiffer ties; softer ties, if the first stiffer ones drifted more. Stops when the goal is reached.
class StiffnessSearch {
public:
    StiffnessSearch(const Eigen::VectorXd& stiffness, bool has_joint)
        : next_(has_joint ? Try::joint : Try::balance)
        , first_(stiffness)
        , best_(stiffness)
        , tried_(stiffness)
    {
    }

    bool is_done() const { return next_ == Try::none; }
    bool uses_joint() const { return next_ == Try::joint || (is_done() && is_joint_better()); }
    double final_drift() const { return is_joint_better() ? joint_drift_ : drift_; }
    const Eigen::VectorXd& first() const { return first_; }
    const Eigen::VectorXd& tried() const { return tried_; }

    // Records the drift (normalized length) of the present try and selects the kind of the next one.
    void record(double drift, double goal)
    {
        if (is_done()) return;
        if (next_ == Try::joint) {
            joint_drift_ = drift;
            next_ = drift <= goal ? Try::none : Try::balance;
            return;
        }
        const bool is_first = drift_ < 0, is_better = is_first || drift < (1 - min_gain) * drift_;
        if (is_better) best_ = tried_, drift_ = drift;
        if (drift_ <= goal) next_ = Try::none;
        if (!is_first && !is_done()) select_next(is_better);
    }

    // Sets the stiffness of the next try. `places`: the part at all weights with the best ties or the joint.
    void propose(const std::vector<const PartPlaces*>& places, double diagonal)
    {
        tried_ = best_;
        if (drift_ < 0) return; // the ties as found have not been tried
        ++count_;
        if (next_ == Try::balance) tried_ = best_.cwiseProduct(balance_factors(places, best_, diagonal));
        if (next_ == Try::raise) tried_ *= raise_factor;
        if (next_ == Try::lower) tried_ /= raise_factor;
    }

private:
    enum class Try { joint, balance, raise, lower, none };

    bool is_joint_better() const { return joint_drift_ >= 0 && (drift_ < 0 || joint_drift_ < (1 - min_gain) * drift_); }

    // Repeats a kind of try that helped, else goes to the next kind.
    void select_next(bool is_better)
    {
        if (next_ != Try::balance && is_better && count_ < max_raises) return;
        const bool was_raised = next_ == Try::raise && (is_better || count_ > 1);
        next_ = next_ == Try::balance ? Try::raise : next_ == Try::raise && !was_raised ? Try::lower : Try::none;
        count_ = 0;
    }

    Try next_;
    Eigen::VectorXd first_, best_, tried_; // stiffness of each tie
    double drift_ = -1, joint_drift_ = -1; // of the best ties and of the joint; -1 if not tried
    int count_ = 0;                        // of tries of the present kind
};

// The searches of all groups, at all weights.
class TieCalibration {
public:
    TieCalibration(TiedEnergy& energy, const NormalizedPoses& set, const std::vector<Weights>& weights)
        : energy_(energy)
        , set_(set)
        , weights_(weights)
    {
        for (const PartPlaces& places : place_parts(energy.ties(), weights[0], set.shapes[0]))
            searches_.emplace_back(stiffness_of(places), joint_of(energy.ties(), places.first_tie) != nullptr);
        energy_.choose(first_stiffness(), used_joints());
    }

    // Measures the averages at all weights and sets the next stiffness. Returns false if that is the final one.
    bool next_round(const std::vector<Shape>& averages)
    {
        std::vector<std::vector<PartPlaces>> all;
        for (std::size_t j = 0; j < averages.size(); ++j)
            all.push_back(place_parts(energy_.ties(), weights_[j], averages[j]));
        std::vector<double> stiffness;
        bool is_done = true;
        for (std::size_t g = 0; g < searches_.size(); ++g) {
            std::vector<const PartPlaces*> places;
            for (const auto& at : all) places.push_back(&at[g]);
            StiffnessSearch& search = searches_[g];
            search.record(largest_drift(places), drift_goal * set_.diagonal);
            search.propose(places, set_.diagonal);
            is_done = is_done && search.is_done();
            stiffness.insert(stiffness.end(), search.tried().begin(), search.tried().end());
        }
        if (is_done && is_hopeless()) stiffness = first_stiffness();
        energy_.choose(stiffness, used_joints());
        return !is_done;
    }

private:
    Eigen::VectorXd stiffness_of(const PartPlaces& places) const
    {
        Eigen::VectorXd out(places.actual.cols());
        for (Eigen::Index i = 0; i < out.size(); ++i)
            out[i] = energy_.ties().ties[places.first_tie + std::size_t(i)].stiffness;
        return out;
    }

    // Stiff ties on parts that rotate far strain the character without reaching the goal, and create several minima.
    bool is_hopeless() const
    {
        return std::any_of(searches_.begin(), searches_.end(), [&](const StiffnessSearch& search) {
            return search.final_drift() > give_up_drift * set_.diagonal;
        });
    }

    std::vector<double> first_stiffness() const
    {
        std::vector<double> out;
        for (const StiffnessSearch& search : searches_) out.insert(out.end(), search.first().begin(), search.first().end());
        return out;
    }

    // Per joint, in the order of the groups that have one.
    std::vector<bool> used_joints() const
    {
        std::vector<bool> out;
        std::size_t first_tie = 0;
        for (const StiffnessSearch& search : searches_) {
            if (joint_of(energy_.ties(), first_tie)) out.push_back(search.uses_joint());
            first_tie += std::size_t(search.first().size());
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
    const NormalizedPoses& set_;
    const std::vector<Weights>& weights_;
    std::vector<StiffnessSearch> searches_;
};

} // namespace

void calibrate_ties(TiedEnergy& energy, const NormalizedPoses& set, SolverKind solver, const CoarseBody* coarse,
                    Progress* progress)
{
    const std::vector<Weights> weights = probe_weights(set.pose_count());
    TieCalibration calibration(energy, set, weights);
    SolverPool pool(energy, set, solver);
    AverageFamily family(pool, rough_options(set), progress, {}, coarse);
    family.mean();
    std::vector<Shape> averages(weights.size());
    SharedProgress shared(progress);
    shared.describe("ties", 0, "how far parts drift");
    for_each_task(averages.size(), [&](std::size_t i, std::size_t worker) {
        averages[i] = family.at(weights[i], worker, &shared).average.y;
    });
    for (int round = 1; calibration.next_round(averages); ++round) {
        shared.describe("ties", 0, fmt::format("round {}", round));
        for_each_task(averages.size(), [&](std::size_t i, std::size_t worker) {
            averages[i] = family.near(averages[i], weights[i], worker, &shared).y;
        });
    }
    energy.drop_unused();
}

} // namespace pliant
