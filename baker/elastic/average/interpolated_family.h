// The family of averages, interpolated between those that are known.
#pragma once

#include "base/weights/hermite_interpolation.h"
#include "elastic/average/family.h"

#include <vector>

namespace pliant {

// Holds averages and their derivatives by the weights: at the poses, at the mean, and at weights given to learn(). Averages
// at other weights are interpolated, or found by Newton's method from the interpolated shape, which also measures its error.
// Memory: one shape per pose for each average that is known. Results do not depend on the number of threads.
class InterpolatedFamily {
public:
    // What progress is told: `done` of `total` averages of a stage were found before.
    struct Span {
        const char* stage;
        std::size_t done, total;
    };

    // Computes family.mean() if need be. The family and progress (may be null) must outlive it.
    // Cost: m + 1 factorisations for m poses.
    InterpolatedFamily(AverageFamily& family, Progress* progress);

    // The interpolated shape.
    Shape at(const Weights& w) const;

    // Averages at these weights, in their order; `error` is that of the interpolated shape. Where Newton's method goes far
    // from that, the average is followed along the straight line from the nearest known one. On a family that is smooth both
    // give a(w), and the neighbours keep all averages on one branch of it where there are several.
    // Cost: 1 to 3 factorisations each where the family is smooth, up to some more than path_limit elsewhere.
    std::vector<CheckPoint> find(const std::vector<Weights>& weights, const Span& span) const;

    // The same; those that converge are known afterwards (64 of them at most). Cost: up to one more factorisation each.
    std::vector<CheckPoint> learn(const std::vector<Weights>& weights, const Span& span);

    const AverageFamily& family() const { return family_; }

    std::size_t learned_count() const;

private:
    // An average and its derivatives along the columns of weight_directions().
    struct Known {
        Weights weights;
        Shape shape;
        Eigen::MatrixXd derivatives;
    };

    // An average, and what the solver knows after it was found.
    struct Found {
        CheckPoint point;
        bool has_factor = false;      // of the exact Hessian there
        bool started_definite = true; // the exact Hessian at the interpolated shape
    };

    const NormalizedPoses& set() const { return family_.pool().set(); }
    Found find_one(const Weights& w, std::size_t worker, Progress* progress) const;
    KnownAverage nearest(const Weights& w) const;
    Eigen::MatrixXd derivatives(const Weights& w, const Shape& y, std::size_t worker, bool has_factor) const;
    std::vector<Found> find_all(const std::vector<Weights>& weights, const Span& span, std::vector<Known>* learned) const;
    void fit();

    const AverageFamily& family_;
    Progress* progress_;
    bool starts_exact_ = true; // most interpolated shapes of the last wave had definite Hessians
    std::vector<Known> known_; // the poses, the mean, the averages learned
    std::optional<HermiteInterpolation> interpolation_;
};

} // namespace pliant
