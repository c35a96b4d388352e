// Steps that collapse no cell: a trust region for single cells.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/average/hessian.h"

#include <functional>

namespace pliant {

// A few slivers that a Newton step would collapse make the line search shorten the whole step (Zhu, Bridson, Kaufman 2018,
// who filter the step). Here the model becomes stiffer in these cells, and the step is found again.

// The triangles or tetrahedra that shrink below a fifth of their area or volume from y to `moved`; so do tetrahedra that
// are inverted.
std::vector<std::uint32_t> collapsing_cells(const NormalizedPoses& set, const Shape& y, const Shape& moved);

// Adds springs between the corners of these cells, of this share of the largest diagonal entry there.
void stiffen(SparseLower& hessian, const NormalizedPoses& set, const std::vector<std::uint32_t>& cells, double share);

// A step along which the quadratic model decreases, close to the minimum of the model: preconditioned conjugate gradients
// from zero, so that any number of them gives a descent direction. `solve` applies the inverse of the Hessian before it was
// stiffened. Cost: about ten solves.
Shape solve_stiffened(const SparseLower& hessian, const Shape& load, const std::function<Shape(const Shape&)>& solve);

} // namespace pliant
