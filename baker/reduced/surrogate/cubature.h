// Optimised cubature: a few elements with non-negative weights stand for all of them (An, Kim, James 2008; von Tycowicz et
// al. 2013).
#pragma once

#include "reduced/surrogate/nnls.h"
#include "reduced/surrogate/training.h"

namespace pliant {

struct Probe;
struct Sketch;

// How the elements are found: greedily, or by the paper's method (nnls.h).
enum class CubatureSolver { nnls, nn_htp };

struct CubatureOptions {
    std::size_t candidate_count = 8000; // random elements that compete
    CubatureSolver solver = CubatureSolver::nnls;
    std::uint64_t seed = 1;
};

// Smallest and largest eigenvalue of S^T H S over the training averages, H the surrogate energy's Hessian and S S^T the
// inverse of the true one at the mean: 1 is perfect there, a lowest one <= 0 is no surrogate energy.
struct Curvature {
    double lowest = 0, highest = 0;
};
Curvature measure_curvature(const SurrogateEnergy& surrogate, const TrainingSet& training);

// One joint element set for all poses. The fit sees, all whitened by training.whitening: reduced forces of single poses at
// averages and of combinations at perturbed averages, forces at averages that must cancel (equilibrium), and columns of the
// Hessian.
class CubatureFit {
public:
    // Computes the training rows of all candidates: seconds to a minute. The references must outlive the fit.
    CubatureFit(const ReducedEnergy& reduced, const TrainingSet& training, const CubatureOptions& options,
                Progress* progress);

    // The best found set of at most `element_count` elements; continues from the last, smaller one.
    SurrogateEnergy fit(std::size_t element_count);

    // Adds the curvature of `surrogate` along its softest directions, where they are far softer than the true ones or
    // concave, as rows of the fit. The number of directions found; 0: the surrogate energy is convex enough.
    std::size_t stiffen(const SurrogateEnergy& surrogate);

    double residual() const { return found_.residual; } // relative, of all rows

private:
    void append_rows(std::vector<Probe> probes, const Sketch& sketch);
    void drop_negligible(
        Eigen::Index before); // zeroes candidates whose rows 0..before-1 (all rows if before is 0) are negligible

    const ReducedEnergy& reduced_;
    const TrainingSet& training_;
    Progress* progress_;
    CubatureSolver solver_;
    std::vector<std::size_t> candidates_;
    SurrogateEnergy all_;     // the candidates at weight 1
    Eigen::MatrixXf columns_; // rows x candidates
    Eigen::VectorXd target_;
    SparseFit found_;
};

} // namespace pliant
