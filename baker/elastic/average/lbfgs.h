// Limited-memory BFGS whose first inverse Hessian is a factorisation.
#pragma once

#include "base/mesh/normalized_poses.h"

#include <deque>
#include <functional>

namespace pliant {

// Nocedal 1980. With the factor of an elastic Hessian as the first inverse Hessian: Liu, Bouaziz, Kavan 2017.
class LimitedMemoryBfgs {
public:
    // A step and the change of the gradient along it. Ignored where the energy is not convex along the step.
    void add(const Shape& step, const Shape& change);

    // -(inverse Hessian) gradient. `solve` applies the first inverse Hessian. Cost: one `solve`.
    Shape direction(const Shape& gradient, const std::function<Shape(const Shape&)>& solve) const;

private:
    struct Pair {
        Shape step, change;
        double curvature; // step . change
    };
    std::deque<Pair> pairs_; // the oldest first
};

} // namespace pliant
