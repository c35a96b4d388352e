// The reduced energy of a St. Venant-Kirchhoff solid, exactly: a polynomial of degree four in the reduced coordinates
// (Barbic, James 2005; von Tycowicz et al. 2015, section 5).
#pragma once

#include "base/common/progress.h"
#include "elastic/energy/solid.h"
#include "reduced/subspace/subspace.h"

namespace pliant {

// With x = (1, q), N = d + 1 numbers, the strain of every tetrahedron is linear in the products p = x_a x_b, a <= b,
// numbered by a, then b; so the energy of pose k is p^T G_k p with one symmetric matrix of N(N+1)/2 rows per pose.
class Quartic {
public:
    // Cost per pose: some 6 d^4 / 8 multiply-adds per tetrahedron. Memory: 8 d^4 / 4 bytes per pose.
    Quartic(const Solid& solid, const Subspace& subspace, Progress* progress);

    Eigen::Index dimension() const { return dimension_; }
    std::size_t pose_count() const { return matrices_.size(); }

    // The same polynomial of the first `dimension` coordinates, the others zero.
    Quartic leading(Eigen::Index dimension) const;

    // Adds stiffness |along q - wanted w|^2, up to a constant for each w of sum 1: a Gauge.
    void hold(const Eigen::MatrixXd& along, const Eigen::MatrixXd& wanted, double stiffness);

    // The polynomial of z, where q = mean + whitening z.
    Quartic transformed(const Eigen::VectorXd& mean, const Eigen::MatrixXd& whitening) const;

    double value(const Eigen::VectorXd& w, const Eigen::VectorXd& q) const;
    double gradient(const Eigen::VectorXd& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const;
    Eigen::MatrixXd hessian(const Eigen::VectorXd& w, const Eigen::VectorXd& q) const;

    // Coefficients c_ijkl, i <= j <= k <= l, of the monomials x_i x_j x_k x_l of one pose, in the order of formats/SPEC.md,
    // chunk QUAR: for j, for i <= j a row over all pairs (k, l) from the multiple of 8 at or below the pair (j, j) up to
    // their number, padded to a multiple of 8; zero where k < j. The constant is left out.
    Eigen::VectorXd coefficients(std::size_t pose) const;

private:
    Quartic() = default;
    Eigen::MatrixXd combined(const Eigen::VectorXd& w) const;

    Eigen::Index dimension_ = 0;
    std::vector<Eigen::MatrixXd> matrices_; // per pose, symmetric
};

// Number of the pair (a, b), a <= b < count.
constexpr Eigen::Index pair_index(Eigen::Index a, Eigen::Index b, Eigen::Index count)
{
    return a * count - a * (a - 1) / 2 + b - a;
}

} // namespace pliant
