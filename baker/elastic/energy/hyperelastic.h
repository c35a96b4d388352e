// Hyperelastic energy densities of solids as functions of the change of the metric,
//     c = C - I,  C = F^T F,  as the six numbers (11, 12, 13, 22, 23, 33), every off-diagonal entry once.
// In c and not in C: a tetrahedron at rest then has exactly no energy, and small strains keep their digits.
#pragma once

#include <Eigen/Core>

namespace pliant {

using SymmetricVector = Eigen::Matrix<double, 6, 1>;
using SymmetricMatrix6 = Eigen::Matrix<double, 6, 6>;

enum class SolidLaw { stvk, mooney_rivlin };

// Coefficients of one material. St. Venant-Kirchhoff: lambda/2 (tr E)^2 + mu E:E, E = c / 2.
// Mooney-Rivlin: mu10 (J^-2/3 I1 - 3) + mu01 (J^-4/3 I2 - 3) + v1 (J - 1)^2, I1 = tr C, I2 = (I1^2 - tr C^2) / 2, J = det F.
struct SolidModuli {
    double lambda = 0, mu = 0;
    double mu10 = 0, mu01 = 0, v1 = 0;
};

// From Young's modulus and Poisson's ratio: lambda and mu as in textbooks; mu10 = 0.4 G, mu01 = 0.1 G, v1 = K / 2 with the
// shear modulus G = young / (2 (1 + poisson)) and the bulk modulus K = young / (3 (1 - 2 poisson)).
SolidModuli solid_moduli(double young, double poisson);

// The symmetric matrix of six numbers, and the contraction with one: x:y = 2 x12 y12 + ... counts off-diagonals twice.
Eigen::Matrix3d symmetric(const SymmetricVector& x);

// T with (B^T X B) = T X for symmetric X as six numbers.
SymmetricMatrix6 congruence(const Eigen::Matrix3d& b);

// Adds `weight` times the density at c, and times its first and second derivatives by the six numbers, to what is not null.
// The density of Mooney-Rivlin is +infinity where det C is not positive; who calls must look at the sign of det F.
void add_density(SolidLaw law, const SolidModuli& moduli, double weight, const SymmetricVector& c, double* value,
                 SymmetricVector* gradient, SymmetricMatrix6* hessian);

} // namespace pliant
