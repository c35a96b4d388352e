// Ghost: a coarse mesh stands for the fine one (the surrogate energy of von Tycowicz et al. 2015 for shells).
#pragma once

#include "base/mesh/decimate.h"
#include "reduced/surrogate/surrogate_energy.h"

#include <memory>

namespace pliant {

struct Ghost {
    NormalizedPoses set;                 // the decimated poses, in the units of the full set
    std::vector<std::uint32_t> vertices; // which vertices of the full mesh are left
    Eigen::MatrixXd basis;               // their rows of U
};

// Decimates pose 0 to about `vertex_count` vertices; the basis comes over as the poses do, by taking its rows.
Ghost make_ghost(const NormalizedPoses& set, const Subspace& subspace, std::size_t vertex_count);

} // namespace pliant
