// The energies of the two kinds of blend (base/weights/domain.h). Averages: W(w, y) = sum_k w_k W_k(y). Layers: W(v, y) is
// the energy of one body whose rest state every element blends from those of the poses. Source: Froehlich, Botsch 2011;
// THEORY.md, section 11.
#pragma once

#include "base/weights/domain.h"

namespace pliant {

// How layers blend quantities of an element that know no rotations (columns of `poses`): x_0 + sum_k v_k (x_k - x_0).
template <class Poses> auto layered(const Poses& poses, const double* v)
{
    Eigen::Matrix<double, Poses::RowsAtCompileTime, 1> out = poses.col(0);
    for (Eigen::Index k = 1; k < poses.cols(); ++k)
        if (v[k - 1] != 0) out += v[k - 1] * (poses.col(k) - poses.col(0));
    return out;
}

} // namespace pliant
