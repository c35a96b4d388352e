// The family a(w) of averages, or a(v) of layers, defined by continuation, so that every user of it means the same branch.
#pragma once

#include "base/common/time_budget.h"
#include "base/weights/domain.h"
#include "elastic/average/hessian.h"
#include "elastic/average/placement.h"
#include "elastic/average/pose_sum.h"
#include "elastic/average/solver_pool.h"

#include <optional>
#include <vector>

namespace pliant {

// Where the family is not smooth, or not unique.
struct Branch {
    enum class Kind {
        other_mean, // continuation from a pose ends in another average of all poses
        jump,       // the average jumps on the way from the mean to some weights
        other_path, // another way to the same weights ends in another average
        turn        // the place of blends turns at once on the way from the mean to a pose
    } kind;
    Weights weights;    // where it was seen
    std::size_t pose;   // other_mean, turn: the pose; jump: the pose whose weight grows most on the way
    double distance;    // between the two shapes, relative L2; turn: of the two places, too
    std::size_t vertex; // that moves most between them
};

// A shape that is an average for certain weights, at its place (Placement).
struct KnownAverage {
    Weights weights;
    Shape shape;
    bool is_interpolated = false;
};

struct FamilyPoint {
    NewtonResult average; // at its place
    std::vector<Branch> jumps;
};

// A blend that was compared with the reference average.
struct CheckPoint {
    Weights weights;
    Shape reference;          // at its place
    double error = 0;         // of the blend, relative L2
    double nearest_error = 0; // its distance from the average next to it: smaller, where that is another one
    bool has_converged = false;
    std::vector<Branch> branches;
};

// Where averages at any weights come from.
class AverageSource {
public:
    virtual ~AverageSource() = default;

    // Averages at the first of the weights, in groups until the time is spent: one group at least.
    virtual std::vector<CheckPoint> find_in_time(const std::vector<Weights>& weights, const char* stage,
                                                 const TimeBudget& budget) const = 0;
};

struct CoarseBody;

// a(w) is reached along the straight line in weight space from the equal-weight average. That one is reached from every
// pose, along the line from the pose's corner; of those that are reached the one of lowest energy counts, and the pose of
// lowest number that leads there is its start. Where there is a coarse mesh, all of that is done there, and the mean is the
// average next to the one found. An elastic average need not be unique; one definition of it is needed where
// snapshots, reference averages and measurements are compared.
// Of layers the centre is the rest shape, v = 0, in the place of the mean: nothing is searched. Where Newton's method finds
// a(v) next to the sum of the layers, no line is followed.
class AverageFamily {
public:
    // `start_pose`: if known (a certificate holds it), the mean is reached from that pose only, which costs a fraction.
    // `coarse`: null, or where the mean is searched; it must outlive the family.
    AverageFamily(SolverPool& pool, NewtonOptions options, Progress* progress, std::optional<std::size_t> start_pose = {},
                  const CoarseBody* coarse = nullptr);

    // The equal-weight average and the pose from which it is reached, computed at the first call; of layers pose 0. Not from
    // tasks.
    const NewtonResult& mean();
    std::size_t start_pose();

    // The unit of energies: that of the mean. Of layers, whose averages may have none at all, a quarter of what it takes to
    // hold the rest shape against a layer at the farther end of its range, their mean: what the average of the two would
    // have were it linear.
    double energy_scale(const WeightDomain& domain);

    // Sums of poses, made at the first call. Needs mean() before. Not from tasks.
    const PoseSum& sum();

    // The exact Hessian there (lower triangle), assembled at the first call. Not from tasks.
    const SparseLower& mean_hessian();

    // Other means that were found. Empty before mean().
    const std::vector<Branch>& branches() const { return branches_; }

    // Where every line starts: equal weights, or of layers zero.
    Weights centre() const;

    // The average for w (non-negative, sum 1; of layers any finite numbers). Steps are halved when Newton fails, corrects
    // the tangent's guess by much, or the shape jumps; the result may still not have converged: check it. Needs mean()
    // before; then tasks may call it at the same time, each with its worker. Cost: 4 to 30 factorisations, at most some more
    // than path_limit.
    FamilyPoint at(const Weights& w, std::size_t worker, Progress* progress) const;

    // As at(). Where the line does not reach w, the lowest of the averages next to the poses, with a jump: at a corner that
    // is the pose. Of layers as at(). Cost there: one minimisation more for each pose.
    FamilyPoint at_or_near_pose(const Weights& w, std::size_t worker, Progress* progress) const;

    // The same as at() from a guess of the shape; where Newton's method fails there or goes far, along the line from the
    // centre if `may_follow`.
    FamilyPoint from_guess(const Weights& w, const Shape& guess, bool may_follow, std::size_t worker,
                           Progress* progress) const;

    // The same, to be compared with a blend.
    CheckPoint point_at(const Weights& w, std::size_t worker, Progress* progress) const;

    // The same along the straight line from another average that is known, and the average next to a shape.
    FamilyPoint from(const KnownAverage& known, const Weights& w, std::size_t worker, Progress* progress) const;
    // `has_near_factor`: NewtonOptions.
    NewtonResult near(const Shape& shape, const Weights& w, std::size_t worker, Progress* progress,
                      bool has_near_factor = false) const;

    // Compares a blend with the reference average of `point`: sets the errors. Where the blend is not next to it (half of
    // branch_distance), Newton's method goes on from the blend; if it ends at another average, that is recorded, and if only
    // that one has converged, it becomes the reference. Tasks may call it as at().
    // `beside`: the average next to the blend, if known.
    void compare(CheckPoint& point, const Shape& blend, std::size_t worker, Progress* progress,
                 std::optional<NewtonResult> beside = {}) const;

    // The same for a blend at w, with a(w). If Newton's method from the blend ends at most `suspicion` (relative L2; 0:
    // always) away, that is taken for a(w).
    CheckPoint check(const Weights& w, const Shape& blend, double suspicion, std::size_t worker, Progress* progress) const;

    SolverPool& pool() const { return pool_; }
    const Placement& placement() const { return placement_; }

private:
    struct Path;
    Shape start_of_step(Path& path, const Weights& to, double share) const;
    int factorization_limit() const;
    void follow(Path& path, const Weights& to, bool is_rough) const;
    void search_mean();
    bool refine_coarse_mean();
    bool has_layers() const { return pool_.energy().blend() == Blend::layers; }
    double step_length(const Weights& change) const;
    std::size_t growing_pose(const Weights& change) const;
    NewtonResult beside_guess(const Weights& w, const Shape& guess, int iterations, std::size_t worker,
                              Progress* progress) const;
    FamilyPoint reach_mean(std::size_t pose, std::size_t worker, Progress* progress) const;

    SolverPool& pool_;
    Placement placement_;
    NewtonOptions options_;
    Progress* progress_;
    std::optional<std::size_t> start_pose_;
    const CoarseBody* coarse_;
    std::optional<NewtonResult> mean_;
    std::optional<PoseSum> sum_; // of layers always
    std::optional<SparseLower> mean_hessian_;
    double speed_ = 0; // largest relative distance of the centre from a pose per change of weights
    std::vector<Branch> branches_;
};

// Creases make minima that lie a few per cent (relative L2) apart: where Newton's method goes farther than this from a
// guess, another one may have caught it.
constexpr double correction_limit = 0.04;

// On the way to one average no step begins after so many factorisations, or steps; the average counts as not converged.
// Most ways take less than a quarter of that.
constexpr int path_limit = 120;

// The same of layers: at most weights there is a way of a few steps, or no shape at all.
constexpr int layered_path_limit = 40;

// Identical poses have no energy.
constexpr double least_energy_scale = 1e-13;

// Averages farther apart than this (relative L2) are different ones: ten times the default tolerance, of which reference
// averages are wanted to a twentieth.
constexpr double branch_distance = 0.01;

// Number of the vertex that moves most between two shapes, after rigid alignment.
std::size_t farthest_vertex(const NormalizedPoses& set, const Shape& a, const Shape& b);

} // namespace pliant
