// Membrane energies of one triangle as functions of its metric.
#pragma once

#include <Eigen/Core>

namespace pliant {

// Metric of a triangle with edge vectors e, a: g = (e.e, e.a, a.a).
using Metric = Eigen::Vector3d;
using MetricHessian = Eigen::Matrix3d;

enum class Membrane { neo_hookean, stvk, edge };

// Elastic moduli, dimensionless: only their ratios to the bending stiffness and to each other matter.
struct MembraneModuli {
    double lambda = 1, mu = 1;                     // neo-Hookean, St. Venant-Kirchhoff
    double edge_stiffness = 1, area_stiffness = 1; // edge
};

inline double determinant(const Metric& g) { return g[0] * g[2] - g[1] * g[1]; }

// Energy of a triangle of rest metric `rest` deformed to metric g, weighted by `weight`: added to value, gradient and
// Hessian with respect to g (design of the family: neo-Hookean of Bonet and Wood in two dimensions, St. Venant-Kirchhoff,
// and the edge-and-area membrane of Grinspun et al. 2003). Pointers may be null. A neo-Hookean triangle without area is
// +infinity.
void add_membrane(Membrane kind, const MembraneModuli& moduli, const Metric& rest, double weight, const Metric& g,
                  double* value, Metric* gradient, MetricHessian* hessian);

} // namespace pliant
