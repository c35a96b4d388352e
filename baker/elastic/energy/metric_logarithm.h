// Logarithms of metrics relative to a rest metric: where layers add up stretches. Source: THEORY.md, section 11.
#pragma once

#include "elastic/energy/hyperelastic.h"
#include "elastic/energy/membrane.h"

namespace pliant {

// Of a triangle: Lambda = log(D^-T G D^-1) for the metric G, with G_0 = D^T D the rest metric and D upper triangular. Both
// must be positive definite.
Metric metric_logarithm(const Metric& rest, const Metric& g);

// The inverse, D^T exp(Lambda) D: positive definite for every symmetric Lambda, and `rest` itself for zero.
Metric metric_exponential(const Metric& rest, const Metric& logarithm);

// Of a tetrahedron: log C and exp S of symmetric matrices, by their eigenvectors. C must be positive definite.
SymmetricVector symmetric_logarithm(const SymmetricVector& c);
Eigen::Matrix3d symmetric_exponential(const SymmetricVector& s);

} // namespace pliant
