// Steps that collapse no cell: a trust region for single cells.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/average/hessian.h"

namespace pliant {

// Where a Newton step would collapse a few slivers, the line search shortens the step of the whole body (Zhu, Bridson,
// Kaufman 2018, who filter the step). Here the model becomes stiffer in these cells only, and the step is found again.

// The triangles or tetrahedra that shrink below a fifth of their area or volume from y to `moved`, and tetrahedra that are
// inverted.
std::vector<std::uint32_t> collapsing_cells(const NormalizedPoses& set, const Shape& y, const Shape& moved);

// Adds springs between the corners of these cells to the model. Their stiffness: this share of the largest diagonal entry
// there. The pattern stays, since every two corners of a cell have an element in common. `step` minimizes the model before;
// then, up to a few edges from the cells, the stiffened one with the rest of the step as it is. Pins do not move. Cost: a
// look at all cells, and a factorization for some hundred vertices a cell.
void restrain(SparseLower& hessian, const NormalizedPoses& set, const std::vector<std::uint32_t>& cells, double share,
              const std::vector<Eigen::Index>& pins, Shape& step);

} // namespace pliant
