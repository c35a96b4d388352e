#include "elastic/energy/hinge.h"

#include "base/mesh/surface.h"

#include <Eigen/Geometry>
#include <cmath>

namespace pliant {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double hinge_angle(const Vector3d& x0, const Vector3d& x1, const Vector3d& x2, const Vector3d& x3)
{
    return hinge_angle(x0, x1, x2, x3, nullptr, nullptr);
}

// The gradient with respect to an opposite vertex is perpendicular to its face and inverse to its height over the edge
// (Bridson, Marino, Fedkiw 2003); the edge's own vertices share what rigid motions leave over, by the projections s and t of
// the opposite vertices onto the edge. The Hessian is that expression differentiated once more (compare Tamstorf, Grinspun
// 2013).
double hinge_angle(const Vector3d& x0, const Vector3d& x1, const Vector3d& x2, const Vector3d& x3, Vector12* gradient,
                   Matrix12* hessian)
{
    const Vector3d e = x1 - x0, a = x2 - x0, b = x3 - x0;
    const Vector3d n1 = e.cross(a), n2 = b.cross(e);
    const double ee = e.squaredNorm(), length = std::sqrt(ee);
    const double theta = std::atan2(e.dot(n1.cross(n2)) / length, n1.dot(n2));
    if (!gradient && !hessian) return theta;

    const double n1n1 = n1.squaredNorm(), n2n2 = n2.squaredNorm();
    const Vector3d g_a = -length / n1n1 * n1; // d theta / d a
    const Vector3d g_b = -length / n2n2 * n2; // d theta / d b
    const double s = a.dot(e) / ee, t = b.dot(e) / ee;
    const Vector3d g_e = -s * g_a - t * g_b;
    if (gradient) {
        gradient->segment<3>(0) = -(g_e + g_a + g_b);
        gradient->segment<3>(3) = g_e;
        gradient->segment<3>(6) = g_a;
        gradient->segment<3>(9) = g_b;
    }
    if (!hessian) return theta;

    const Vector3d unit = e / length;
    const Matrix3d p1 = (Matrix3d::Identity() - 2 / n1n1 * n1 * n1.transpose()) / n1n1;
    const Matrix3d p2 = (Matrix3d::Identity() - 2 / n2n2 * n2 * n2.transpose()) / n2n2;
    const Matrix3d h_aa = -length * p1 * cross_matrix(e);
    const Matrix3d h_bb = length * p2 * cross_matrix(e);
    const Matrix3d h_ae = -(n1 / n1n1 * unit.transpose() - length * p1 * cross_matrix(a));
    const Matrix3d h_be = -(n2 / n2n2 * unit.transpose() + length * p2 * cross_matrix(b));
    const Vector3d ds_de = a / ee - 2 * s / ee * e, dt_de = b / ee - 2 * t / ee * e;
    const Matrix3d h_ee = -(g_a * ds_de.transpose() + s * h_ae + g_b * dt_de.transpose() + t * h_be);

    // From differences (e, a, b) to vertices: x0 enters each with -1.
    Eigen::Matrix<double, 9, 9> d = Eigen::Matrix<double, 9, 9>::Zero();
    d.block<3, 3>(0, 0) = 0.5 * (h_ee + h_ee.transpose());
    d.block<3, 3>(3, 0) = h_ae;
    d.block<3, 3>(0, 3) = h_ae.transpose();
    d.block<3, 3>(6, 0) = h_be;
    d.block<3, 3>(0, 6) = h_be.transpose();
    d.block<3, 3>(3, 3) = 0.5 * (h_aa + h_aa.transpose());
    d.block<3, 3>(6, 6) = 0.5 * (h_bb + h_bb.transpose());
    hessian->bottomRightCorner<9, 9>() = d;
    const Eigen::Matrix<double, 3, 9> top = -(d.topRows<3>() + d.middleRows<3>(3) + d.bottomRows<3>());
    hessian->topRightCorner<3, 9>() = top;
    hessian->bottomLeftCorner<9, 3>() = top.transpose();
    hessian->topLeftCorner<3, 3>() = -(top.leftCols<3>() + top.middleCols<3>(3) + top.rightCols<3>());
    return theta;
}

} // namespace pliant
