#include "elastic/energy/metric_logarithm.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace pliant {

namespace {

// D = (a, b; 0, c) with D^T D = g.
struct UpperRoot {
    double a, b, c;
    explicit UpperRoot(const Metric& g)
        : a(std::sqrt(g[0]))
        , b(g[1] / a)
        , c(std::sqrt(determinant(g)) / a)
    {
    }
};

// Half the difference of the eigenvalues of a symmetric 2 x 2 matrix.
double half_gap(const Metric& x) { return std::hypot((x[0] - x[2]) / 2, x[1]); }

// scale I + slope (x - tr x / 2 I)
Metric isotropic_plus_deviator(double scale, double slope, const Metric& x)
{
    const double half = slope * (x[0] - x[2]) / 2;
    return { scale + half, slope * x[1], scale - half };
}

} // namespace

// The determinant comes from those of the metrics, not from C, whose small eigenvalue cancels in a sliver.
Metric metric_logarithm(const Metric& rest, const Metric& g)
{
    const UpperRoot d(rest);
    const double c11 = g[0] / (d.a * d.a), c12 = (g[1] - d.b / d.a * g[0]) / (d.a * d.c),
                 c22 = (g[2] - d.b / d.a * (2 * g[1] - d.b / d.a * g[0])) / (d.c * d.c);
    const double root = std::sqrt(determinant(g) / determinant(rest)), gap = half_gap({ c11, c12, c22 });
    const double slope = gap > 0 ? std::log(((c11 + c22) / 2 + gap) / root) / gap : 0;
    return isotropic_plus_deviator(std::log(root), slope, { c11, c12, c22 });
}

Metric metric_exponential(const Metric& rest, const Metric& logarithm)
{
    if (logarithm.isZero(0)) return rest;
    const UpperRoot d(rest);
    const double gap = half_gap(logarithm), scale = std::exp((logarithm[0] + logarithm[2]) / 2);
    const Metric c = isotropic_plus_deviator(scale * std::cosh(gap), gap > 0 ? scale * std::sinh(gap) / gap : 0, logarithm);
    return { d.a * d.a * c[0], d.a * (d.b * c[0] + d.c * c[1]), d.b * d.b * c[0] + 2 * d.b * d.c * c[1] + d.c * d.c * c[2] };
}

SymmetricVector symmetric_logarithm(const SymmetricVector& c)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(symmetric(c));
    const Eigen::Matrix3d x
        = axes.eigenvectors() * axes.eigenvalues().array().log().matrix().asDiagonal() * axes.eigenvectors().transpose();
    return (SymmetricVector() << x(0, 0), x(0, 1), x(0, 2), x(1, 1), x(1, 2), x(2, 2)).finished();
}

Eigen::Matrix3d symmetric_exponential(const SymmetricVector& s)
{
    if (s.isZero(0)) return Eigen::Matrix3d::Identity();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(symmetric(s));
    return axes.eigenvectors() * axes.eigenvalues().array().exp().matrix().asDiagonal() * axes.eigenvectors().transpose();
}

} // namespace pliant
