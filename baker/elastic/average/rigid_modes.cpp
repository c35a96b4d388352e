#include "elastic/average/rigid_modes.h"

#include <Eigen/Dense>

namespace pliant {

Eigen::MatrixXd times_mass(const Eigen::MatrixXd& vectors, const Eigen::VectorXd& masses)
{
    Eigen::MatrixXd out = vectors;
    for (Eigen::Index v = 0; v < masses.size(); ++v) out.middleRows<3>(3 * v) *= masses[v];
    return out;
}

double mass_dot(const Shape& a, const Shape& b, const Eigen::VectorXd& masses)
{
    double sum = 0;
    for (Eigen::Index v = 0; v < masses.size(); ++v) sum += masses[v] * a.segment<3>(3 * v).dot(b.segment<3>(3 * v));
    return sum;
}

double mass_norm(const Shape& a, const Eigen::VectorXd& masses) { return std::sqrt(mass_dot(a, a, masses)); }

Eigen::MatrixXd rigid_modes(const Shape& y, const Eigen::VectorXd& masses)
{
    const Eigen::Index n = masses.size();
    const double total = masses.sum();
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (Eigen::Index v = 0; v < n; ++v) centre += masses[v] / total * y.segment<3>(3 * v);
    Eigen::MatrixXd modes = Eigen::MatrixXd::Zero(3 * n, 6);
    for (Eigen::Index v = 0; v < n; ++v) {
        const Eigen::Vector3d r = y.segment<3>(3 * v) - centre;
        for (int c = 0; c < 3; ++c) {
            modes(3 * v + c, c) = 1;
            modes.block<3, 1>(3 * v, 3 + c) = Eigen::Vector3d::Unit(c).cross(r);
        }
    }
    // Cholesky of the 6 x 6 Gram matrix orthonormalises; a body with area has a positive definite one.
    const Eigen::Matrix<double, 6, 6> gram = modes.transpose() * times_mass(modes, masses);
    const Eigen::Matrix<double, 6, 6> factor = gram.llt().matrixL();
    return factor.triangularView<Eigen::Lower>().solve(modes.transpose()).transpose();
}

void remove_rigid_motion(Eigen::Ref<Eigen::MatrixXd> displacements, const Eigen::MatrixXd& modes,
                         const Eigen::VectorXd& masses)
{
    displacements -= (modes * (times_mass(modes, masses).transpose() * displacements)).eval();
}

void balance_load(Eigen::Ref<Eigen::MatrixXd> loads, const Eigen::MatrixXd& modes, const Eigen::VectorXd& masses)
{
    loads -= (times_mass(modes, masses) * (modes.transpose() * loads)).eval();
}

std::vector<Eigen::Index> statically_determinate_pins(const Shape& y)
{
    const Eigen::Map<const Positions> rows(y.data(), y.size() / 3, 3);
    Eigen::Index a = 0, b = 0, c = 0;
    const Eigen::RowVector3d centre = rows.colwise().mean();
    (rows.rowwise() - centre).rowwise().squaredNorm().maxCoeff(&a);
    (rows.rowwise() - rows.row(a)).rowwise().squaredNorm().maxCoeff(&b);
    const Eigen::Vector3d axis = (rows.row(b) - rows.row(a)).transpose();
    double best_height = -1;
    for (Eigen::Index v = 0; v < rows.rows(); ++v) {
        const double height = axis.cross((rows.row(v) - rows.row(a)).transpose()).squaredNorm();
        if (height > best_height) best_height = height, c = v;
    }
    // Rotations about vertex a, seen at b and c: choose two rows at b and one at c with the largest determinant.
    const Eigen::Vector3d to_b = axis, to_c = (rows.row(c) - rows.row(a)).transpose();
    std::vector<Eigen::Index> best;
    double best_determinant = -1;
    for (int free_b = 0; free_b < 3; ++free_b)
        for (int pinned_c = 0; pinned_c < 3; ++pinned_c) {
            const int b1 = (free_b + 1) % 3, b2 = (free_b + 2) % 3;
            Eigen::Matrix3d work;
            for (int r = 0; r < 3; ++r) {
                const Eigen::Vector3d at_b = Eigen::Vector3d::Unit(r).cross(to_b),
                                      at_c = Eigen::Vector3d::Unit(r).cross(to_c);
                work.col(r) << at_b[b1], at_b[b2], at_c[pinned_c];
            }
            if (std::abs(work.determinant()) <= best_determinant) continue;
            best_determinant = std::abs(work.determinant());
            best = { 3 * a, 3 * a + 1, 3 * a + 2, 3 * b + b1, 3 * b + b2, 3 * c + pinned_c };
        }
    return best;
}

} // namespace pliant
