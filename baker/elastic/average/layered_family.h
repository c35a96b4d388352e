// Shapes of layers at given weights, found on all threads.
#pragma once

#include "base/weights/radial_function.h"
#include "elastic/average/family.h"

namespace pliant {

// Shapes that it has learned correct the guesses of others: what the sum of rotations and strains lacked there,
// interpolated. Memory: 12 bytes a vertex for each of them. Results do not depend on the number of threads.
class LayeredFamily final : public AverageSource {
public:
    // Computes family.mean() if need be. The family and progress (may be null) must outlive it.
    LayeredFamily(AverageFamily& family, Progress* progress);

    // What progress is told: `done` of `total` shapes of a stage were found before.
    struct Span {
        const char* stage;
        std::size_t done, total;
    };

    // a(v) at these weights, in their order. `may_follow`: AverageFamily::layers_from().
    // Cost: 2 to 15 factorisations each, more where a line is followed.
    std::vector<CheckPoint> find(const std::vector<Weights>& weights, const Span& span, bool may_follow) const;

    std::vector<CheckPoint> find_in_time(const std::vector<Weights>& weights, const char* stage,
                                         const TimeBudget& budget) const override;

    const AverageFamily& family() const { return family_; }

    // The converged ones of these shapes guide others from now on.
    void learn(const std::vector<CheckPoint>& points);

private:
    Shape guess(const Weights& v, std::size_t worker) const;

    const AverageFamily& family_;
    Progress* progress_;
    std::vector<Weights> learned_; // where corrections are known: there, at no layer and at single whole ones
    Eigen::MatrixXf corrections_;  // of those found (3n x found)
    RadialFunction shares_;        // of the corrections
};

} // namespace pliant
