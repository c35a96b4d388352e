#include "elastic/energy/best_rotation.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A rotation is exact when the torque that is left is rounding of a matrix of norm 1.
constexpr double torque_limit = 4e-15;

// Newton's method below doubles the digits of a rotation that has some.
constexpr int largest_step_count = 4;

// Always works: singular values in descending order, the last one with the sign that makes the rotation proper.
Matrix3d rotation_by_svd(const Matrix3d& m)
{
    const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d u = svd.matrixU(), v = svd.matrixV();
    const double sign = (u * v.transpose()).determinant() < 0 ? -1 : 1;
    return u * Vector3d(1, 1, sign).asDiagonal() * v.transpose();
}

// The largest root of x^4 - 2 |M|^2 x^2 - 8 det M x + p, the characteristic polynomial of Horn's 4x4 matrix of M: the sum of
// the singular values. Newton's method comes down to it from the bound sqrt(3) |M|, here with |M| = 1.
double largest_eigenvalue(double det, double p)
{
    double x = 1.7320508075688772;
    for (int i = 0; i < 12; ++i) {
        const double x2 = x * x, value = (x2 - 2) * x2 - 8 * det * x + p, slope = 4 * x * (x2 - 1) - 8 * det;
        if (!(slope > 0)) break;
        const double step = value / slope;
        x -= step;
        if (step < 1e-9) break;
    }
    return x;
}

// The eigenvector, by the largest column of the adjugate of Horn's matrix minus the eigenvalue, as a rotation (Theobald,
// "Rapid calculation of RMSDs using a quaternion-based characteristic polynomial", 2005). A few digits are enough.
std::optional<Matrix3d> rough_rotation(const Matrix3d& m)
{
    Eigen::Matrix4d k;
    k << m.trace(), m(2, 1) - m(1, 2), m(0, 2) - m(2, 0), m(1, 0) - m(0, 1),  //
        0, m(0, 0) - m(1, 1) - m(2, 2), m(0, 1) + m(1, 0), m(0, 2) + m(2, 0), //
        0, 0, m(1, 1) - m(0, 0) - m(2, 2), m(1, 2) + m(2, 1),                 //
        0, 0, 0, m(2, 2) - m(0, 0) - m(1, 1);
    k.triangularView<Eigen::StrictlyLower>() = k.transpose();
    const double x = largest_eigenvalue(m.determinant(), k.determinant());
    k.diagonal().array() -= x;
    Eigen::Vector4d best = Eigen::Vector4d::Zero();
    for (int column = 0; column < 4; ++column) {
        Eigen::Vector4d q;
        for (int row = 0; row < 4; ++row) {
            Matrix3d minor;
            for (int i = 0, r = 0; i < 4; ++i) {
                if (i == row) continue;
                for (int j = 0, c = 0; j < 4; ++j)
                    if (j != column) minor(r, c++) = k(i, j);
                ++r;
            }
            q[row] = ((row + column) % 2 ? -1 : 1) * minor.determinant();
        }
        if (q.squaredNorm() > best.squaredNorm()) best = q;
    }
    if (best.squaredNorm() < 1e-12) return {};
    best.normalize();
    return Eigen::Quaterniond(best[0], best[1], best[2], best[3]).toRotationMatrix();
}

} // namespace

// Newton's method on rotations: tr((R exp[w])^T M) = tr B + t.w - w.K w / 2 + ..., B = R^T M, t its torque, K = tr(B) I -
// sym(B). A rotation without torque is the best one exactly if K is positive semidefinite.
Matrix3d best_rotation(const Matrix3d& given)
{
    const double norm = given.norm();
    if (!(norm > 0) || !std::isfinite(norm)) return rotation_by_svd(given);
    const Matrix3d m = given / norm;
    const std::optional<Matrix3d> rough = rough_rotation(m);
    if (!rough) return rotation_by_svd(given);
    Matrix3d rotation = *rough;
    for (int i = 0; i < largest_step_count; ++i) {
        const Matrix3d b = rotation.transpose() * m;
        const Vector3d torque(b(2, 1) - b(1, 2), b(0, 2) - b(2, 0), b(1, 0) - b(0, 1));
        const Matrix3d inertia = b.trace() * Matrix3d::Identity() - 0.5 * (b + b.transpose());
        const Eigen::LLT<Matrix3d> factor(inertia);
        if (factor.info() != Eigen::Success) return rotation_by_svd(given);
        if (torque.norm() < torque_limit) return rotation;
        const Vector3d w = 0.5 * factor.solve(torque); // Cayley's map of it
        const Eigen::Quaterniond turn = Eigen::Quaterniond(1, w.x(), w.y(), w.z()).normalized();
        rotation = (Eigen::Quaterniond(rotation) * turn).normalized().toRotationMatrix();
    }
    return rotation_by_svd(given);
}

} // namespace pliant
