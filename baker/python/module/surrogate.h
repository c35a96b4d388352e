// The function that the runtime's solver minimises, at points of the caller's choice.
#pragma once

#include "pliant.h"

#include <Eigen/LU>

namespace pliant {

// Turns reduced coordinates q into the solver's z and back: q = mean + S z. Made once per asset.
class SurrogateCoordinates {
public:
    explicit SurrogateCoordinates(const pliant_asset& asset);
    Eigen::VectorXd to_z(const double* q) const;
    // A gradient by z as one by q.
    Eigen::VectorXd gradient_by_q(const Eigen::VectorXd& gradient_by_z) const;

private:
    Eigen::VectorXd mean_;
    Eigen::PartialPivLU<Eigen::MatrixXd> whitening_;
};

// Value and gradient (by z) at z of what `solver` minimised in its last pliant_solve: the surrogate energy relative to z = 0
// and the dead load. False if they are not finite. Computed by the runtime, in single precision. The solver's next frame
// must start anew.
bool evaluate_surrogate(pliant_solver* solver, const Eigen::VectorXd& z, double& value, Eigen::VectorXd& gradient);

} // namespace pliant
