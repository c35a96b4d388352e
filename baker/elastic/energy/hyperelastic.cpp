#include "elastic/energy/hyperelastic.h"

#include <cmath>
#include <limits>

namespace pliant {

namespace {

SymmetricVector identity() { return (SymmetricVector() << 1, 0, 0, 1, 0, 1).finished(); }

double trace(const SymmetricVector& x) { return x[0] + x[3] + x[5]; }

// Sum of the principal minors of order two.
double second_minors(const SymmetricVector& x)
{
    return x[0] * x[3] - x[1] * x[1] + x[0] * x[5] - x[2] * x[2] + x[3] * x[5] - x[4] * x[4];
}

double symmetric_determinant(const SymmetricVector& x)
{
    return x[0] * (x[3] * x[5] - x[4] * x[4]) - x[1] * (x[1] * x[5] - x[4] * x[2]) + x[2] * (x[1] * x[4] - x[3] * x[2]);
}

// Derivatives by the six numbers: an off-diagonal one stands for two entries of the matrix.
SymmetricVector determinant_gradient(const SymmetricVector& x)
{
    return (SymmetricVector() << x[3] * x[5] - x[4] * x[4], 2 * (x[2] * x[4] - x[1] * x[5]), 2 * (x[1] * x[4] - x[2] * x[3]),
            x[0] * x[5] - x[2] * x[2], 2 * (x[1] * x[2] - x[0] * x[4]), x[0] * x[3] - x[1] * x[1])
        .finished();
}

SymmetricMatrix6 determinant_hessian(const SymmetricVector& x)
{
    SymmetricMatrix6 h;
    // clang-format off
    h <<        0,         0,         0,      x[5], -2 * x[4],      x[3],
                0, -2 * x[5],  2 * x[4],         0,  2 * x[2], -2 * x[1],
                0,  2 * x[4], -2 * x[3], -2 * x[2],  2 * x[1],         0,
             x[5],         0, -2 * x[2],         0,         0,      x[0],
        -2 * x[4],  2 * x[2],  2 * x[1],         0, -2 * x[0],         0,
             x[3], -2 * x[1],         0,      x[0],         0,         0;
    // clang-format on
    return h;
}

SymmetricVector minors_gradient(const SymmetricVector& x)
{
    return (SymmetricVector() << x[3] + x[5], -2 * x[1], -2 * x[2], x[0] + x[5], -2 * x[4], x[0] + x[3]).finished();
}

SymmetricMatrix6 minors_hessian()
{
    SymmetricMatrix6 h = SymmetricMatrix6::Zero();
    h(0, 3) = h(3, 0) = h(0, 5) = h(5, 0) = h(3, 5) = h(5, 3) = 1;
    h(1, 1) = h(2, 2) = h(4, 4) = -2;
    return h;
}

// lambda/8 (tr c)^2 + mu/4 c:c with c:c = (tr c)^2 - 2 m2(c)
void add_stvk(const SolidModuli& m, double weight, const SymmetricVector& c, double* value, SymmetricVector* gradient,
              SymmetricMatrix6* hessian)
{
    const SymmetricVector doubled = (SymmetricVector() << 1, 2, 2, 1, 2, 1).finished();
    SymmetricMatrix6 k = weight * m.lambda / 4 * identity() * identity().transpose();
    k.diagonal() += weight * m.mu / 2 * doubled;
    const SymmetricVector force = k * c;
    if (value) *value += 0.5 * c.dot(force);
    if (gradient) *gradient += force;
    if (hessian) *hessian += k;
}

// A function of the determinant of C, and its first two derivatives.
struct Powers {
    double value, first, second;
};

// weight * power(det C) * linear(C) for a quantity with the given derivatives; the value is formed elsewhere.
void add_product(double weight, const Powers& p, double quantity, const SymmetricVector& quantity_gradient,
                 const SymmetricMatrix6& quantity_hessian, const SymmetricVector& det_gradient,
                 const SymmetricMatrix6& det_hessian, SymmetricVector* gradient, SymmetricMatrix6* hessian)
{
    if (gradient) *gradient += weight * (p.value * quantity_gradient + p.first * quantity * det_gradient);
    if (!hessian) return;
    *hessian += weight
        * (p.value * quantity_hessian
           + p.first
               * (quantity_gradient * det_gradient.transpose() + det_gradient * quantity_gradient.transpose()
                  + quantity * det_hessian)
           + p.second * quantity * det_gradient * det_gradient.transpose());
}

void add_mooney_rivlin(const SolidModuli& m, double weight, const SymmetricVector& c, double* value,
                       SymmetricVector* gradient, SymmetricMatrix6* hessian)
{
    const double growth = trace(c) + second_minors(c) + symmetric_determinant(c), det = 1 + growth; // det C = J^2
    if (!(det > 0)) {
        if (value) *value = std::numeric_limits<double>::infinity();
        return;
    }
    const double i1 = 3 + trace(c), i2 = 3 + 2 * trace(c) + second_minors(c), jacobian = std::sqrt(det);
    const double log_det = std::log1p(growth), s1 = std::exp(-log_det / 3), s2 = std::exp(-2 * log_det / 3);
    if (value) {
        const double u = growth / (1 + jacobian); // J - 1
        *value += weight
            * (m.mu10 * (std::expm1(-log_det / 3) * i1 + trace(c))
               + m.mu01 * (std::expm1(-2 * log_det / 3) * i2 + (2 * trace(c) + second_minors(c))) + m.v1 * u * u);
    }
    if (!gradient && !hessian) return;
    const SymmetricVector full = identity() + c, det_gradient = determinant_gradient(full);
    const SymmetricMatrix6 det_hessian = determinant_hessian(full);
    add_product(weight * m.mu10, { s1, -s1 / (3 * det), 4 * s1 / (9 * det * det) }, i1, identity(), SymmetricMatrix6::Zero(),
                det_gradient, det_hessian, gradient, hessian);
    add_product(weight * m.mu01, { s2, -2 * s2 / (3 * det), 10 * s2 / (9 * det * det) }, i2, minors_gradient(full),
                minors_hessian(), det_gradient, det_hessian, gradient, hessian);
    // (sqrt(det) - 1)^2: first derivative 1 - 1/J, second 1 / (2 J^3)
    const double first = weight * m.v1 * (growth / (1 + jacobian)) / jacobian;
    if (gradient) *gradient += first * det_gradient;
    if (hessian)
        *hessian += first * det_hessian + weight * m.v1 / (2 * jacobian * det) * det_gradient * det_gradient.transpose();
}

} // namespace

SolidModuli solid_moduli(double young, double poisson)
{
    const double shear = young / (2 * (1 + poisson)), bulk = young / (3 * (1 - 2 * poisson));
    SolidModuli m;
    m.mu = shear;
    m.lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson));
    m.mu10 = 0.4 * shear;
    m.mu01 = 0.1 * shear;
    m.v1 = bulk / 2;
    return m;
}

Eigen::Matrix3d symmetric(const SymmetricVector& x)
{
    Eigen::Matrix3d full;
    full << x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5];
    return full;
}

SymmetricMatrix6 congruence(const Eigen::Matrix3d& b)
{
    constexpr int row[] = { 0, 0, 0, 1, 1, 2 }, column[] = { 0, 1, 2, 1, 2, 2 };
    SymmetricMatrix6 t;
    for (int i = 0; i < 6; ++i)
        for (int j = 0; j < 6; ++j) {
            const double once = b(row[j], row[i]) * b(column[j], column[i]);
            const double again = b(column[j], row[i]) * b(row[j], column[i]);
            t(i, j) = row[j] == column[j] ? once : once + again;
        }
    return t;
}

void add_density(SolidLaw law, const SolidModuli& moduli, double weight, const SymmetricVector& c, double* value,
                 SymmetricVector* gradient, SymmetricMatrix6* hessian)
{
    if (law == SolidLaw::stvk)
        add_stvk(moduli, weight, c, value, gradient, hessian);
    else
        add_mooney_rivlin(moduli, weight, c, value, gradient, hessian);
}

} // namespace pliant
