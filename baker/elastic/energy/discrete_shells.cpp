#include "elastic/energy/discrete_shells.h"

#include "elastic/energy/hinge.h"
#include "elastic/energy/metric_logarithm.h"
#include "pliant_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pliant {

namespace {

constexpr double pi = 3.14159265358979323846;

// The angle modulo a full turn that lies within half a turn of zero.
double wrap(double angle) { return angle - 2 * pi * std::round(angle / (2 * pi)); }

Metric metric_of(const Eigen::Vector3d& e, const Eigen::Vector3d& a)
{
    return { e.squaredNorm(), e.dot(a), a.squaredNorm() };
}

double angle_of(const Shape& shape, const std::array<std::uint32_t, 4>& v)
{
    return hinge_angle(point(shape, v[0]), point(shape, v[1]), point(shape, v[2]), point(shape, v[3]));
}

// The triangles with their widest corner, the one opposite the longest edge, at `place`; of equal ones the last vertex.
std::vector<Triangle> with_widest_corners_at(std::size_t place, std::vector<Triangle> triangles, const Shape& shape)
{
    for (Triangle& t : triangles) {
        std::array<std::pair<double, std::uint32_t>, 3> corners;
        for (std::size_t c = 0; c < 3; ++c)
            corners[c] = { (point(shape, t[(c + 1) % 3]) - point(shape, t[(c + 2) % 3])).squaredNorm(), t[c] };
        const auto widest = std::size_t(std::max_element(corners.begin(), corners.end()) - corners.begin());
        t = { t[(widest + 3 - place) % 3], t[(widest + 4 - place) % 3], t[(widest + 5 - place) % 3] };
    }
    return triangles;
}

} // namespace

DiscreteShells::DiscreteShells(const NormalizedPoses& set, const ShellOptions& options, Blend blend)
    : options_(options)
    , blend_(blend)
    , pose_count_(Eigen::Index(set.pose_count()))
    , dof_count_(set.dof_count())
    , hinges_(find_hinges(set.triangles, set.shapes[0]))
    , triangles_(with_widest_corners_at(options.membrane == Membrane::edge ? 0 : 2, set.triangles, set.shapes[0]))
{
    find_shears(set);
    rest_metrics_.resize(3 * pose_count_, Eigen::Index(triangles_.size()));
    for (Eigen::Index k = 0; k < pose_count_; ++k)
        for (std::size_t f = 0; f < triangles_.size(); ++f)
            rest_metrics_.block<3, 1>(3 * k, Eigen::Index(f)) = metric_of(set.shapes[std::size_t(k)], f);
    if (blend_ == Blend::layers) take_logarithms();
    measure_hinges(set);
}

// The shears with which faces lean least over all poses: least squares of (e . a) / (|e| height). Of layers over pose 0.
void DiscreteShells::find_shears(const NormalizedPoses& set)
{
    shears_.setZero(Eigen::Index(triangles_.size()));
    if (options_.membrane == Membrane::edge) return; // looks at the edges themselves
    const std::size_t count = blend_ == Blend::layers ? 1 : set.pose_count();
    for (std::size_t f = 0; f < triangles_.size(); ++f) {
        double sum = 0, total = 0;
        for (std::size_t k = 0; k < count; ++k) {
            const Metric g = metric_of(set.shapes[k], f);
            const double det = determinant(g);
            if (!(det > 0)) continue;
            sum += g[0] / det * g[1]; // (length / height)^2 times the shear g[1] / g[0]
            total += g[0] / det * g[0];
        }
        if (total > 0) shears_[Eigen::Index(f)] = sum / total;
    }
}

Metric DiscreteShells::metric_of(const Shape& shape, std::size_t face) const
{
    const Triangle& t = triangles_[face];
    const Eigen::Vector3d origin = point(shape, t[0]), e = point(shape, t[1]) - origin;
    return pliant::metric_of(e, point(shape, t[2]) - origin - shears_[Eigen::Index(face)] * e);
}

void DiscreteShells::take_logarithms()
{
    for (Eigen::Index f = 0; f < rest_metrics_.cols(); ++f)
        for (Eigen::Index k = 1; k < pose_count_; ++k)
            rest_metrics_.block<3, 1>(3 * k, f)
                = metric_logarithm(rest_metric(std::size_t(f), 0), rest_metric(std::size_t(f), k));
}

Metric DiscreteShells::layered_metric(std::size_t face, const double* weights) const
{
    Metric logarithm = Metric::Zero();
    for (Eigen::Index k = 1; k < pose_count_; ++k)
        if (weights[k - 1] != 0) logarithm += weights[k - 1] * rest_metric(face, k);
    return metric_exponential(rest_metric(face, 0), logarithm);
}

void DiscreteShells::measure_hinges(const NormalizedPoses& set)
{
    const Eigen::Index count = Eigen::Index(hinges_.size());
    centres_.resize(count);
    stiffness_.resize(pose_count_, count);
    rest_angles_.resize(pose_count_, count);
    std::vector<Eigen::VectorXd> areas;
    for (const Shape& shape : set.shapes) areas.push_back(triangle_areas(shape, triangles_));

    const double thickness2 = options_.thickness * options_.thickness;
    for (Eigen::Index h = 0; h < count; ++h) {
        const Hinge& hinge = hinges_[std::size_t(h)];
        Eigen::VectorXd angles(pose_count_);
        for (Eigen::Index k = 0; k < pose_count_; ++k) {
            const Shape& shape = set.shapes[std::size_t(k)];
            angles[k] = angle_of(shape, hinge.vertices);
            const double area = areas[std::size_t(k)][hinge.faces[0]] + areas[std::size_t(k)][hinge.faces[1]];
            const double length2 = (point(shape, hinge.vertices[1]) - point(shape, hinge.vertices[0])).squaredNorm();
            stiffness_(k, h) = thickness2 * 3 * length2 / area;
        }
        const bool is_folded = angles.cwiseAbs().maxCoeff() > options_.foldover_angle;
        // A fold that passes through pi must not look like a jump of a full turn: unwrap to pose 0, then use the middle of
        // the range as the branch of the angle function.
        for (Eigen::Index k = 1; k < pose_count_; ++k) angles[k] = angles[0] + wrap(angles[k] - angles[0]);
        centres_[h] = 0.5 * (angles.minCoeff() + angles.maxCoeff());
        rest_angles_.col(h) = angles.array() - centres_[h];
        if (is_folded || angles.maxCoeff() - angles.minCoeff() > options_.foldover_range) {
            foldovers_.push_back(std::size_t(h));
            stiffness_.col(h) *= options_.foldover_damping;
        }
    }
}

const std::uint32_t* DiscreteShells::element_vertices(std::size_t element, std::size_t& count) const
{
    if (element < hinges_.size()) {
        count = 4;
        return hinges_[element].vertices.data();
    }
    count = 3;
    return triangles_[element - hinges_.size()].data();
}

double DiscreteShells::relative_angle(std::size_t hinge, double theta) const
{
    return wrap(theta - centres_[Eigen::Index(hinge)]);
}

void DiscreteShells::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                              ElementResult& result) const
{
    if (element < hinges_.size())
        evaluate_hinge(element, weights, x, order, kind, result);
    else
        evaluate_face(element - hinges_.size(), weights, x, order, kind, result);
}

// sum_k w_k beta_k (t - s_k)^2: t the dihedral angle, s_k that of pose k, both relative to the centre of their range;
// beta_k = 3 thickness^2 l_k^2 / A_k with edge length l_k and area A_k of the two faces (measure_hinges). Layers:
// beta_0 (t - s(v))^2, the angle within half a turn of the rest angle.
void DiscreteShells::evaluate_hinge(std::size_t hinge, const double* weights, const double* x, Order order, HessianKind kind,
                                    ElementResult& result) const
{
    const Eigen::Map<const Eigen::Vector3d> x0(x), x1(x + 3), x2(x + 6), x3(x + 9);
    Vector12 gradient;
    Matrix12 hessian;
    const bool want_curvature = order == Order::hessian && kind == HessianKind::exact;
    const double theta
        = hinge_angle(x0, x1, x2, x3, order >= Order::gradient ? &gradient : nullptr, want_curvature ? &hessian : nullptr);
    const double t = relative_angle(hinge, theta);
    const auto rest = rest_angles_.col(Eigen::Index(hinge)), beta = stiffness_.col(Eigen::Index(hinge));
    double value = 0, slope = 0, stiffness = 0;
    const auto add = [&](double weight, double off) {
        value += weight * off * off;
        slope += 2 * weight * off;
        stiffness += 2 * weight;
    };
    if (blend_ == Blend::layers)
        add(beta[0], wrap(t - layered(rest.transpose(), weights)[0]));
    else
        for (Eigen::Index k = 0; k < pose_count_; ++k) add(weights[k] * beta[k], t - rest[k]);
    result.value = value;
    if (order >= Order::gradient) result.gradient = slope * gradient;
    if (order == Order::hessian) {
        result.hessian = stiffness * gradient * gradient.transpose(); // Gauss-Newton: positive semidefinite as it is
        if (want_curvature) result.hessian += slope * hessian;
    }
}

void DiscreteShells::evaluate_face(std::size_t face, const double* weights, const double* x, Order order, HessianKind kind,
                                   ElementResult& result) const
{
    const Eigen::Map<const Eigen::Vector3d> x0(x), x1(x + 3), x2(x + 6);
    const double shear = shears_[Eigen::Index(face)];
    const Eigen::Vector3d e = x1 - x0, a = x2 - x0 - shear * e;
    const Metric g = pliant::metric_of(e, a);
    double value = 0;
    Metric slope = Metric::Zero();
    MetricHessian curvature = MetricHessian::Zero();
    const auto add = [&](double weight, const Metric& rest) {
        add_membrane(options_.membrane, options_.moduli, rest, weight, g, &value,
                     order >= Order::gradient ? &slope : nullptr, order == Order::hessian ? &curvature : nullptr);
    };
    if (blend_ == Blend::layers)
        add(1, layered_metric(face, weights));
    else
        for (Eigen::Index k = 0; k < pose_count_; ++k)
            if (weights[k] != 0) add(weights[k], rest_metric(face, k));
    result.value = value;
    if (order < Order::gradient) return;

    // Derivatives of the metric (e.e, e.a, a.a) by the edge vectors (e, a).
    Eigen::Matrix<double, 6, 3> jacobian;
    jacobian << 2 * e, a, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), e, 2 * a;
    Eigen::Matrix<double, 6, 9> to_vertices = Eigen::Matrix<double, 6, 9>::Zero();
    for (int c = 0; c < 3; ++c) {
        to_vertices(c, c) = -1;
        to_vertices(3 + c, c) = shear - 1;
        to_vertices(c, 3 + c) = to_vertices(3 + c, 6 + c) = 1;
        to_vertices(3 + c, 3 + c) = -shear;
    }
    result.gradient = to_vertices.transpose() * (jacobian * slope);
    if (order < Order::hessian) return;

    Eigen::Matrix<double, 6, 6> h = jacobian * curvature * jacobian.transpose();
    for (int c = 0; c < 3; ++c) {
        h(c, c) += 2 * slope[0];
        h(3 + c, 3 + c) += 2 * slope[2];
        h(c, 3 + c) += slope[1];
        h(3 + c, c) += slope[1];
    }
    if (kind == HessianKind::projected) project_positive(h);
    result.hessian = to_vertices.transpose() * h * to_vertices;
}

RuntimeElement DiscreteShells::runtime_element(std::size_t element, const Shape& reference) const
{
    return element < hinges_.size() ? runtime_hinge(element, reference) : runtime_face(element - hinges_.size(), reference);
}

RuntimeElement DiscreteShells::runtime_hinge(std::size_t hinge, const Shape& reference) const
{
    const Eigen::Index h = Eigen::Index(hinge);
    const auto& v = hinges_[hinge].vertices;
    RuntimeElement out;
    out.differences = { { v[0], v[1] }, { v[0], v[2] }, { v[0], v[3] } };
    if (blend_ == Blend::layers) {
        out.kind = PLIANT_ELEMENT_LAYERED_HINGE;
        out.fixed = { angle_of(reference, v), stiffness_(0, h) };
        out.pose_numbers = rest_angles_.col(h).array() - rest_angles_(0, h);
        out.pose_numbers(0, 0) = centres_[h] + rest_angles_(0, h);
        return out;
    }
    out.kind = PLIANT_ELEMENT_HINGE;
    out.fixed = { centres_[h], relative_angle(hinge, angle_of(reference, v)) };
    out.pose_numbers.resize(pose_count_, 2);
    out.pose_numbers.col(0) = stiffness_.col(h);
    out.pose_numbers.col(1) = stiffness_.col(h).cwiseProduct(rest_angles_.col(h));
    return out;
}

// The two vectors that a face is seen along.
RuntimeElement DiscreteShells::seen_face(std::size_t face) const
{
    const Triangle& t = triangles_[face];
    RuntimeElement out;
    out.differences = { { t[0], t[1] }, { t[0], t[2] } };
    out.combination.setIdentity(2, 2);
    out.combination(0, 1) = -shears_[Eigen::Index(face)];
    return out;
}

// Kind 10 of formats/SPEC.md. Only with a neo-Hookean membrane.
RuntimeElement DiscreteShells::runtime_layered_face(std::size_t face, const Shape& reference) const
{
    const Metric g = metric_of(reference, face), rest = rest_metric(face, 0);
    const double det = determinant(g), a = std::sqrt(rest[0]), c = std::sqrt(determinant(rest)) / a,
                 area = std::sqrt(determinant(rest)) / 2;
    RuntimeElement out = seen_face(face);
    out.kind = PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN;
    out.fixed = { g[2] / det,
                  -g[1] / det,
                  g[0] / det,
                  1 / det,
                  1 / a,
                  -rest[1] / (rest[0] * c),
                  1 / c,
                  area * options_.moduli.mu / 2,
                  area * options_.moduli.lambda / 4 };
    out.pose_numbers.setZero(pose_count_, 3);
    for (Eigen::Index k = 1; k < pose_count_; ++k) out.pose_numbers.row(k) = rest_metric(face, k).transpose();
    return out;
}

// The coefficients of formats/SPEC.md, kinds 2 to 4: the membrane expanded around the metric at z = 0.
RuntimeElement DiscreteShells::runtime_face(std::size_t face, const Shape& reference) const
{
    if (blend_ == Blend::layers) return runtime_layered_face(face, reference);
    const Metric g0 = metric_of(reference, face);
    const double det0 = determinant(g0);
    const MembraneModuli& m = options_.moduli;
    // What the diagonal of a quadratic energy gains, so that it stays convex where a sliver leans in some pose: rounding to
    // single precision takes up to three times 6e-8 of the diagonal from an eigenvalue.
    constexpr double least_stiffness = 1e-6;
    RuntimeElement out = seen_face(face);
    const Metric lengths2(g0[0], g0[2], g0[0] - 2 * g0[1] + g0[2]);
    switch (options_.membrane) {
    case Membrane::neo_hookean:
        out.kind = PLIANT_ELEMENT_FACE_NEO_HOOKEAN;
        out.fixed = { g0[2] / det0, -g0[1] / det0, g0[0] / det0, 1 / det0 };
        break;
    case Membrane::stvk: out.kind = PLIANT_ELEMENT_FACE_STVK; break;
    case Membrane::edge:
        out.kind = PLIANT_ELEMENT_FACE_EDGE;
        for (int i = 0; i < 3; ++i) out.fixed.push_back(std::sqrt(lengths2[i]));
        out.fixed.push_back(std::sqrt(det0) / 2);
        break;
    }
    const pliant_format_shape shape = pliant_format_batch_shape(out.kind, 0, 0);
    out.pose_numbers.resize(pose_count_, shape.pose_number_count);
    for (Eigen::Index k = 0; k < pose_count_; ++k) {
        const Metric rest = rest_metric(face, k);
        const double rest_det = determinant(rest), area = std::sqrt(rest_det) / 2;
        Metric slope = Metric::Zero();
        MetricHessian curvature = MetricHessian::Zero();
        add_membrane(options_.membrane, m, rest, 1, g0, nullptr, &slope, &curvature);
        auto row = out.pose_numbers.row(k);
        switch (options_.membrane) {
        case Membrane::neo_hookean: {
            // f = P.g + p det g - l log det g: L is its slope at g0, B the coefficient of det(change) that the logarithm's
            // linear part leaves over.
            const double log_part = area * (m.mu / 2 + m.lambda / 4);
            row << slope[0], slope[1], slope[2], area * m.lambda / 4 / rest_det - log_part / det0, log_part;
            break;
        }
        case Membrane::stvk:
            curvature.diagonal() *= 1 + least_stiffness;
            slope = curvature * (g0 - rest);
            row << slope[0], slope[1], slope[2], curvature(0, 0), curvature(0, 1), curvature(0, 2), curvature(1, 1),
                curvature(1, 2), curvature(2, 2);
            break;
        case Membrane::edge: {
            const double edges2[3] = { rest[0], rest[2], rest[0] - 2 * rest[1] + rest[2] };
            for (int i = 0; i < 3; ++i) {
                row[2 * i] = m.edge_stiffness * area / 3 / edges2[i];
                row[2 * i + 1] = row[2 * i] * std::sqrt(edges2[i]);
            }
            row[6] = m.area_stiffness / area;
            row[7] = m.area_stiffness;
            break;
        }
        }
    }
    return out;
}

} // namespace pliant
