// Blends of many poses at given weights, found on all threads.
#pragma once

#include "base/weights/radial_function.h"
#include "elastic/average/family.h"

namespace pliant {

// The family of layers, or of the averages of many poses. Shapes that it has learned correct the guesses of others: what
// the sum of rotations and strains lacked there, interpolated. It needs no derivatives, which InterpolatedFamily keeps for
// every pose at every average. Memory: 12 bytes a vertex for each shape learned. Results do not depend on the number of
// threads.
class CorrectedFamily final : public AverageSource {
public:
    // Computes family.mean() if need be. The family and progress (may be null) must outlive it.
    CorrectedFamily(AverageFamily& family, Progress* progress);

    // What progress is told: `done` of `total` shapes of a stage were found before.
    struct Span {
        const char* stage;
        std::size_t done, total;
    };

    // The shapes at these weights, in their order. `may_follow`: AverageFamily::from_guess().
    // Cost: 2 to 15 factorisations each, more where a line is followed.
    std::vector<CheckPoint> find(const std::vector<Weights>& weights, const Span& span, bool may_follow) const;

    std::vector<CheckPoint> find_in_time(const std::vector<Weights>& weights, const char* stage,
                                         const TimeBudget& budget) const override;

    const AverageFamily& family() const { return family_; }
    const Shape& mean() const { return mean_; } // of layers the rest shape

    // The converged ones of these shapes guide others from now on.
    void learn(const std::vector<CheckPoint>& points);

private:
    Shape guess(const Weights& w, std::size_t worker) const;

    const AverageFamily& family_;
    const Shape& mean_;
    const PoseSum& sum_;
    Progress* progress_;
    std::vector<Weights> learned_; // where corrections are known: at the poses, which need none, then at those found
    Eigen::MatrixXf corrections_;  // of those found (3n x found)
    RadialFunction shares_;        // of the corrections
};

} // namespace pliant
