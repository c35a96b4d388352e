// Where the surrogate energy is trained and the predictor fitted: weights, and the reduced averages at them.
#pragma once

#include "base/common/progress.h"
#include "base/weights/sampling.h"
#include "reduced/surrogate/reduced_solver.h"

namespace pliant {

struct TrainingSet {
    std::vector<Weights> weights;
    std::vector<Eigen::VectorXd> averages; // reduced averages for them, in q
    // S with S S^T = an inverse reduced Hessian (mean over the averages; of reduced ones the one at the mean): metric of all
    // fits
    Eigen::MatrixXd whitening;
    double energy_scale = 1; // mean energy over the averages; of layers AverageFamily::energy_scale()
    int unconverged_count = 0;
    // Of true averages: what the mesh does there, which is what a surrogate energy is to do at `averages`. Empty for reduced
    // ones.
    std::vector<const Shape*> shapes;
    std::vector<Eigen::MatrixXd> stiffness; // d x d, in q
    std::size_t exact_stiffness_count = 0;  // of them; those of the others are interpolated
};

// Refers to an average in a list, which must outlive it.
struct AverageAt {
    Weights weights;
    const Shape* shape;
    bool is_interpolated = false;
};

// The averages of a list, without those next to others or to `corners`: radial functions need distinct centres.
std::vector<AverageAt> distinct_averages(const std::vector<KnownAverage>& averages, std::vector<Weights> corners);

// A full average seen through a subspace: the energy's quadratic model there, and where the average lies.
struct ProjectedAverage {
    Weights weights;
    const Shape* shape;        // the average a itself, in the list that it came from
    Eigen::VectorXd nearest;   // coordinates of its projection in the mass inner product
    Eigen::VectorXd pull;      // U^T H (a - tau)
    Eigen::MatrixXd stiffness; // U^T H U, H the Hessian of W(w, .) at the average a
    double energy;             // at the average
};

// Projects averages into a subspace. Leading parts of the results belong to leading dimensions.
class AverageProjector {
public:
    // The references must outlive the projector.
    AverageProjector(const Energy& energy, const Subspace& subspace, const NormalizedPoses& set, Progress* progress);

    // Cost: an assembly of the Hessian each, and its product with the basis.
    std::vector<ProjectedAverage> project(const std::vector<AverageAt>& averages) const;

    // With a stiffness that is a mean of those at averages around (at least one): smoother than that of interpolated
    // averages, whose small triangles are creased. Cost: two gradients each.
    std::vector<ProjectedAverage> project(const std::vector<AverageAt>& averages,
                                          const std::vector<ProjectedAverage>& around) const;

private:
    const Energy& energy_;
    const Subspace& subspace_;
    const NormalizedPoses& set_;
    Progress* progress_;
};

// The q in the first d dimensions that minimizes energy + nearness / 2 |y(q) - a|^2 next to the average a. With nearness 0
// that is the reduced average, too far from a since a subspace is too stiff; with a large one the projection, as near as
// can be, but creased where triangles are small. In between soft directions follow the average, stiff ones the energy.
Eigen::VectorXd reduced_average(const ProjectedAverage& average, Eigen::Index d, double nearness);

// Training data from averages (the first one at the centre of the weights): what reduced_average() makes of them. The
// stiffness of the first `exact_count` is no interpolation.
TrainingSet training_of(const ReducedSolver& reduced, const std::vector<ProjectedAverage>& averages, std::size_t exact_count,
                        double nearness);

// Solves the exact reduced problem at all training weights (the equal ones first). Throws Failure (P4401) if the mean does
// not converge.
TrainingSet solve_training_set(const ReducedSolver& reduced, const NormalizedPoses& set, std::vector<Weights> weights,
                               Progress* progress);

} // namespace pliant
