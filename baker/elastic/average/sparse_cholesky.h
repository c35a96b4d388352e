// Sparse Cholesky factorisation behind one face: CHOLMOD (supernodal, METIS; fast) or Eigen (portable, bit-stable).
#pragma once

#include "elastic/average/hessian.h"

#include <memory>
#include <string>

namespace pliant {

enum class SolverKind { cholmod, eigen };

// What the build offers: CHOLMOD if it was compiled in.
SolverKind default_solver();
bool has_cholmod();

// "CHOLMOD 3.0.14", "Eigen 3.4.0".
std::string version_of(SolverKind kind);

// The BLAS behind CHOLMOD and the kernels that it chose: "OpenBLAS 0.3.21, Haswell". Empty of another BLAS.
std::string blas_in_use();

class SparseCholesky {
public:
    explicit SparseCholesky(SolverKind kind);
    ~SparseCholesky();
    SparseCholesky(const SparseCholesky&) = delete;
    SparseCholesky& operator=(const SparseCholesky&) = delete;

    // Factors the symmetric matrix whose lower triangle is given. The pattern is analysed at the first call and must stay
    // the same. False if the matrix is not positive definite. Throws Failure (P4301) when memory runs out.
    bool factorize(const SparseLower& lower);

    // Solves for several right-hand sides at once (3n x r) with the last successful factorisation.
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;

    int factorization_count() const { return count_; }

private:
    struct Backend;
    std::unique_ptr<Backend> backend_;
    int count_ = 0;
};

} // namespace pliant
