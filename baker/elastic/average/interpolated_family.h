// The family of averages, interpolated between those that are known.
#pragma once

#include "base/weights/hermite_interpolation.h"
#include "elastic/average/family.h"
#include "elastic/average/rotation_strain.h"

#include <memory>
#include <vector>

namespace pliant {

// Holds averages and their derivatives by the weights: at the poses, at the mean, and at weights given to learn(). Averages
// at other weights are interpolated, or found by Newton's method from the interpolated shape, which also measures its error.
// Memory for each average that is known: 24 bytes per triangle or 36 per tetrahedron, times the number of poses.
// Results do not depend on the number of threads.
class InterpolatedFamily final : public AverageSource {
public:
    // What progress is told: `done` of `total` averages of a stage were found before.
    struct Span {
        const char* stage;
        std::size_t done, total;
        bool may_end_early = false; // progress is then quicker at first
    };

    struct Wave {
        std::vector<CheckPoint> averages;
        double energy_excess = 0; // of the interpolated shapes, relative, mean: much where they are creased
    };

    // Computes family.mean() if need be. The family and progress (may be null) must outlive it.
    // Cost: m + 1 factorisations for m poses.
    InterpolatedFamily(AverageFamily& family, Progress* progress);

    // The interpolated shapes, without their small creases (NewtonSolver::settled).
    std::vector<Shape> at(const std::vector<Weights>& weights) const;

    // Averages at these weights, in their order; `error` is that of the interpolated shape. Where Newton's method goes far
    // from that, the average is followed along the straight line from the nearest known one. On a family that is smooth both
    // give a(w), and the neighbours keep all averages on one branch of it where there are several.
    // Cost: up to 3 factorisations each where the family is smooth, up to some more than path_limit elsewhere.
    std::vector<CheckPoint> find(const std::vector<Weights>& weights, const Span& span) const;

    // The same in groups of four, or of eight on a smooth family.
    std::vector<CheckPoint> find_in_time(const std::vector<Weights>& weights, const char* stage,
                                         const TimeBudget& budget) const override;

    // The same as find(); those that converge are known afterwards (64 of them at most). Cost: some solves more for each.
    Wave learn(const std::vector<Weights>& weights, const Span& span);

    const AverageFamily& family() const { return family_; }
    const Shape& mean() const { return known_[set().pose_count()].shape; }

    std::size_t learned_count() const;

private:
    // An average. Columns of `coordinates`: those of RotationStrain, then their derivatives along weight_directions().
    // Floats, since they are most of the memory, and their rounding is far below the error of the interpolation.
    struct Known {
        Weights weights;
        Shape shape;
        Eigen::MatrixXf coordinates;
    };

    // An average, and what is known about how it was found.
    struct Found {
        CheckPoint point;
        double energy_excess = 0; // of the interpolated shape, relative
        double crease_energy = 0; // what it had more before it was settled, relative
        bool has_factor = true;   // the solver's last one is that of a shape near to it
    };

    const NormalizedPoses& set() const { return family_.pool().set(); }
    Found find_one(const Weights& w, bool has_near_factor, std::size_t worker, Progress* progress) const;
    KnownAverage nearest(const Weights& w) const;
    Shape unsettled(const Weights& w, std::size_t worker) const;
    Shape settled(const Weights& w, Shape shape, std::size_t worker) const;
    Known with_derivatives(const Weights& w, const Shape& y, std::size_t worker, bool has_near_factor) const;
    std::vector<Found> find_all(const std::vector<Weights>& weights, const Span& span, std::vector<Known>* learned) const;
    void fit();

    const AverageFamily& family_;
    Progress* progress_;
    RotationStrain coordinates_;
    mutable std::vector<std::unique_ptr<CellFit>> fits_; // one for each worker, made when it is needed
    bool has_creases_ = true;                            // the interpolated shapes of the last wave had some
    bool is_smooth_ = false;                             // they were next to the averages
    std::vector<Known> known_;                           // the poses, the mean, the averages learned
    std::optional<HermiteInterpolation> interpolation_;
};

} // namespace pliant
