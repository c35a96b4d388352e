#include "elastic/average/sweep.h"

#include "base/common/parallel.h"
#include "base/weights/radial_function.h"
#include "elastic/average/shape_error.h"

#include <algorithm>
#include <fmt/core.h>

namespace pliant {

namespace {

// Fewer averages than this per pose say little about those in between.
constexpr std::size_t least_known_per_pose = 3;

constexpr std::size_t smallest_wave = 8; // keeps threads busy

// All that is known so far, and an interpolation of it. The averages must stay where they are.
class Known {
public:
    explicit Known(const NormalizedPoses& set)
        : set_(set)
    {
    }

    void add(const Weights& weights, const Shape& shape) { averages_.push_back({ &weights, &shape }); }

    std::size_t count() const { return averages_.size(); }

    KnownAverage nearest(const Weights& w) const
    {
        const Average& average
            = *std::min_element(averages_.begin(), averages_.end(), [&](const Average& a, const Average& b) {
                  return (*a.weights - w).lpNorm<1>() < (*b.weights - w).lpNorm<1>();
              });
        return { *average.weights, *average.shape };
    }

    // Call before shape() after add(). Shapes are interpolated by combining them with interpolated numbers: one for each, 1
    // at its own weights and 0 at those of the others.
    void fit()
    {
        centres_.clear();
        shapes_.clear();
        for (std::size_t k = 0; k < set_.pose_count(); ++k) add_centre(corner_weights(set_.pose_count(), k), set_.shapes[k]);
        for (const Average& average : averages_) add_centre(*average.weights, *average.shape);
        const Eigen::Index n = Eigen::Index(centres_.size());
        parts_ = fit_radial_function(centres_, Eigen::MatrixXd::Identity(n, n));
    }

    Shape shape(const Weights& w) const
    {
        const Eigen::VectorXd parts = parts_(w);
        Shape out = Shape::Zero(set_.dof_count());
        for (std::size_t i = 0; i < shapes_.size(); ++i) out += parts[Eigen::Index(i)] * *shapes_[i];
        return out;
    }

private:
    struct Average {
        const Weights* weights;
        const Shape* shape;
    };

    void add_centre(const Weights& w, const Shape& shape)
    {
        for (const Weights& other : centres_)
            if ((other - w).norm() < closest_centres) return;
        centres_.push_back(w);
        shapes_.push_back(&shape);
    }

    const NormalizedPoses& set_;
    std::vector<Average> averages_;
    std::vector<Weights> centres_;
    std::vector<const Shape*> shapes_;
    RadialFunction parts_;
};

CheckPoint find(const AverageFamily& family, const Known& known, const Weights& w, std::size_t worker, Progress* progress)
{
    const NormalizedPoses& set = family.pool().set();
    if (known.count() >= least_known_per_pose * set.pose_count()) {
        const Shape guess = known.shape(w);
        NewtonResult near = family.near(guess, w, worker, progress);
        if (near.has_converged && relative_distance(set, near.y, guess) < correction_limit)
            return { w, std::move(near.y), 0, 0, true, {} };
    }
    FamilyPoint point = family.from(known.nearest(w), w, worker, progress);
    return { w, std::move(point.average.y), 0, 0, point.average.has_converged, std::move(point.jumps) };
}

} // namespace

std::vector<CheckPoint> sweep(const AverageFamily& family, const std::vector<KnownAverage>& known,
                              const std::vector<Weights>& weights, Progress* progress)
{
    SharedProgress shared(progress);
    std::vector<CheckPoint> points(weights.size());
    Known all(family.pool().set());
    for (const KnownAverage& average : known) all.add(average.weights, average.shape);
    // Each wave is half as large as all that was known before it.
    for (std::size_t done = 0; done < weights.size();) {
        const std::size_t end = std::min(weights.size(), done + std::max(smallest_wave, all.count() / 2));
        shared.describe("averages", double(done) / double(weights.size()), fmt::format("{} of {}", done, weights.size()));
        all.fit();
        for_each_task(end - done, [&](std::size_t i, std::size_t worker) {
            points[done + i] = find(family, all, weights[done + i], worker, &shared);
        });
        for (; done < end; ++done) all.add(points[done].weights, points[done].reference);
    }
    return points;
}

} // namespace pliant
