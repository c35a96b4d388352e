// The sparse Hessian of an energy: one pattern for all shapes and weights, refilled in place.
#pragma once

#include "elastic/energy/energy.h"

#include <Eigen/SparseCore>

namespace pliant {

// Lower triangle, column-major; 64-bit indices, since the factor of a fine mesh outgrows 32.
using SparseLower = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

class HessianAssembler {
public:
    explicit HessianAssembler(const Energy& energy);

    // Overwrites matrix() with the Hessian of W(w, .) at y (3n x 3n, lower triangle). Cost: linear in the elements.
    void assemble(const Weights& w, const Shape& y, HessianKind kind);

    SparseLower& matrix() { return matrix_; }
    const SparseLower& matrix() const { return matrix_; }

private:
    void make_pattern();
    void find_places();

    const Energy& energy_;
    std::vector<std::int64_t> starts_; // per vertex column: where its row vertices start in rows_
    std::vector<std::uint32_t> rows_;  // row vertices >= column vertex, ascending, the diagonal first
    std::vector<std::uint32_t>
        places_; // of the blocks that assemble() adds to, as it goes: their row among those of the column
    SparseLower matrix_;
};

// rows * H (r x 3n) of a symmetric matrix given by its lower triangle. Many times faster with a few dozen rows than as many
// products with columns.
Eigen::MatrixXd times_symmetric(const Eigen::MatrixXd& rows, const SparseLower& lower);

// Replaces the rows and columns of the given degrees of freedom by those of the identity, keeping the pattern, so that a
// cached symbolic factorisation stays valid.
void pin(SparseLower& matrix, const std::vector<Eigen::Index>& dofs);

} // namespace pliant
