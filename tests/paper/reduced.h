// Reduced averages in any basis, and what is wrong with them.
#pragma once

#include "elastic/average/shape_error.h"
#include "output/asset/runtime_blender.h"
#include "reduced/subspace/subspace.h"
#include "reduced/surrogate/training.h"

#include <string>
#include <vector>

namespace pliant {

// A weight with the unreduced average there, in normalized units.
struct Reference {
    std::string kind; // grid, uniform, edge, corner
    Weights weights;
    Shape shape;
    bool has_converged = false;
};

// Numbers between semicolons.
std::string weights_cell(const Weights& w);

// The exact reduced averages, all elements evaluated on the full mesh: the subspace alone is to blame for their errors.
// Newton's method starts at the point of the subspace nearest to the reference average: where there are several minima, this
// is the reference average's (on human_pair another one is 5e-4 away and hardly higher). What it costs to land in another
// one is in the errors of assets. A column of coordinates per reference average.
Eigen::MatrixXd solve_reduced(const Energy& energy, const NormalizedPoses& set, const Subspace& subspace,
                              const std::vector<Reference>& references);

// Relative L2 distance of a shape, rigidly moved as suits it best, from the subspace: no solver can do better there.
double projection_error(const NormalizedPoses& set, const Subspace& subspace, const Shape& reference);

// The first d columns of a basis whose columns are ordered: the differences, then directions of falling importance.
Subspace leading_part(const Subspace& subspace, Eigen::Index d);

// The subspace in which an asset blends, read through the runtime (single precision: errors below some 1e-6 are not seen).
// Throws Failure (bad_input) if the asset was not baked from this set.
Subspace subspace_of(const RuntimeBlender& blender, const NormalizedPoses& set, const std::string& path);

} // namespace pliant
