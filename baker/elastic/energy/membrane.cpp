#include "elastic/energy/membrane.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

// Gradient of the determinant g11 g22 - g12^2; its Hessian is constant.
Metric determinant_gradient(const Metric& g) { return { g[2], -2 * g[1], g[0] }; }

MetricHessian determinant_hessian()
{
    MetricHessian h;
    h << 0, 0, 1, 0, -2, 0, 1, 0, 0;
    return h;
}

// Coefficients c with tr(Gbar^-1 G) = c . g.
Metric trace_coefficients(const Metric& rest) { return Metric(rest[2], -2 * rest[1], rest[0]) / determinant(rest); }

// A [ mu/2 tr C + lam/4 det C - (mu/2 + lam/4) log det C - mu - lam/4 ]
void add_neo_hookean(const MembraneModuli& m, const Metric& rest, double area_weight, const Metric& g, double* value,
                     Metric* gradient, MetricHessian* hessian)
{
    const double rest_det = determinant(rest), det = determinant(g), ratio = det / rest_det;
    const double log_stiffness = m.mu / 2 + m.lambda / 4;
    const Metric trace = trace_coefficients(rest);
    if (value) {
        if (!(ratio > 0)) {
            *value = std::numeric_limits<double>::infinity();
            return;
        }
        // tr C - 2 and det C - 1 are formed from g - rest, so that a triangle at rest has exactly no energy.
        const Metric change = g - rest;
        const double det_change = (determinant_gradient(rest).dot(change) + determinant(change)) / rest_det;
        *value += area_weight
            * (m.mu / 2 * trace.dot(change) + m.lambda / 4 * det_change - log_stiffness * std::log1p(det_change));
    }
    const double outer = area_weight * (m.lambda / 4 / rest_det - log_stiffness / det);
    if (gradient) *gradient += area_weight * m.mu / 2 * trace + outer * determinant_gradient(g);
    if (hessian)
        *hessian += outer * determinant_hessian()
            + area_weight * log_stiffness / (det * det) * determinant_gradient(g) * determinant_gradient(g).transpose();
}

// A [ lam/2 (tr E)^2 + mu tr E^2 ], E = (C - I)/2; tr E^2 = (tr E)^2 - 2 det E is expanded in the change of the metric.
void add_stvk(const MembraneModuli& m, const Metric& rest, double area_weight, const Metric& g, double* value,
              Metric* gradient, MetricHessian* hessian)
{
    const Metric change = g - rest, trace = trace_coefficients(rest);
    const double tr = trace.dot(change) / 2, rest_det = determinant(rest);
    if (value) *value += area_weight * ((m.lambda / 2 + m.mu) * tr * tr - m.mu / 2 * determinant(change) / rest_det);
    if (gradient)
        *gradient += area_weight * ((m.lambda / 2 + m.mu) * tr * trace - m.mu / 2 / rest_det * determinant_gradient(change));
    if (hessian)
        *hessian += area_weight
            * ((m.lambda / 2 + m.mu) / 2 * trace * trace.transpose() - m.mu / 2 / rest_det * determinant_hessian());
}

// Adds stiffness (sqrt(s) / rest - 1)^2 for a length (or area) whose square s is `square = coefficients . g` or quadratic in
// g:
// `slope` is ds/dg and `curvature` d2s/dg2 (null if zero).
void add_relative_length(double stiffness, double rest_length, double square, const Metric& slope,
                         const MetricHessian* curvature, double* value, Metric* gradient, MetricHessian* hessian)
{
    const double length = std::sqrt(std::max(square, 0.0)), scale = stiffness / (rest_length * rest_length);
    if (value) *value += scale * (length - rest_length) * (length - rest_length);
    const double first = scale * (1 - rest_length / length);
    if (gradient) *gradient += first * slope;
    if (hessian) {
        *hessian += scale * rest_length / (2 * length * length * length) * slope * slope.transpose();
        if (curvature) *hessian += first * *curvature;
    }
}

// kL sum_edges A/3 (l/lbar - 1)^2 + kA A (area/A - 1)^2: the triangle's share of its three edges, and its area.
void add_edge(const MembraneModuli& m, const Metric& rest, double area_weight, const Metric& g, double* value,
              Metric* gradient, MetricHessian* hessian)
{
    static const Metric slopes[3] = { { 1, 0, 0 }, { 0, 0, 1 }, { 1, -2, 1 } };
    for (const Metric& slope : slopes)
        add_relative_length(m.edge_stiffness * area_weight / 3, std::sqrt(slope.dot(rest)), slope.dot(g), slope, nullptr,
                            value, gradient, hessian);
    const MetricHessian curvature = determinant_hessian();
    add_relative_length(m.area_stiffness * area_weight, std::sqrt(determinant(rest)), determinant(g),
                        determinant_gradient(g), &curvature, value, gradient, hessian);
}

} // namespace

void add_membrane(Membrane kind, const MembraneModuli& moduli, const Metric& rest, double weight, const Metric& g,
                  double* value, Metric* gradient, MetricHessian* hessian)
{
    const double area_weight = weight * std::sqrt(determinant(rest)) / 2;
    switch (kind) {
    case Membrane::neo_hookean: return add_neo_hookean(moduli, rest, area_weight, g, value, gradient, hessian);
    case Membrane::stvk: return add_stvk(moduli, rest, area_weight, g, value, gradient, hessian);
    case Membrane::edge: return add_edge(moduli, rest, area_weight, g, value, gradient, hessian);
    }
}

} // namespace pliant
