// Ghost: a coarse mesh stands for the fine one (the surrogate energy of von Tycowicz et al. 2015 for shells).
#pragma once

#include "reduced/surrogate/surrogate_energy.h"

#include <memory>

namespace pliant {

struct Ghost {
    NormalizedPoses set;                 // the decimated poses, in the units of the full set
    std::vector<std::uint32_t> vertices; // which vertices of the full mesh are left
    Eigen::MatrixXd basis;               // their rows of U
};

// Decimates pose 0 to about `vertex_count` vertices by quadrics (OpenMesh). Half-edge collapse keeps a subset of the
// vertices, so every pose and the basis come over by taking their rows.
Ghost make_ghost(const NormalizedPoses& set, const Subspace& subspace, std::size_t vertex_count);

} // namespace pliant
