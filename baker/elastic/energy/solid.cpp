#include "elastic/energy/solid.h"

#include "base/mesh/tets.h"
#include "elastic/energy/metric_logarithm.h"
#include "pliant_format.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr double default_poisson_stvk = 0.4, default_poisson_mooney_rivlin = 0.45;

SymmetricVector metric_of(const Eigen::Matrix3d& edges)
{
    const Eigen::Matrix3d g = edges.transpose() * edges;
    return (SymmetricVector() << g(0, 0), g(0, 1), g(0, 2), g(1, 1), g(1, 2), g(2, 2)).finished();
}

SymmetricVector six(const Eigen::Matrix3d& m)
{
    return (SymmetricVector() << m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)).finished();
}

// Derivatives of the metric by the nine coordinates of the edges (9 x 6).
Eigen::Matrix<double, 9, 6> metric_jacobian(const Eigen::Matrix3d& edges)
{
    Eigen::Matrix<double, 9, 6> jacobian = Eigen::Matrix<double, 9, 6>::Zero();
    int component = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j, ++component) {
            jacobian.block<3, 1>(3 * i, component) += edges.col(j);
            jacobian.block<3, 1>(3 * j, component) += edges.col(i);
        }
    return jacobian;
}

// A quantity per edge coordinate to one per vertex coordinate: the first corner is minus the sum of the others.
Eigen::Matrix<double, 12, 9> edges_to_vertices()
{
    Eigen::Matrix<double, 12, 9> out = Eigen::Matrix<double, 12, 9>::Zero();
    for (int c = 0; c < 9; ++c) {
        out(c % 3, c) = -1;
        out(3 + c, c) = 1;
    }
    return out;
}

} // namespace

Solid::Solid(const NormalizedPoses& set, const SolidOptions& options, Blend blend)
    : law_(options.law)
    , blend_(blend)
    , pose_count_(set.pose_count())
    , dof_count_(set.dof_count())
    , tets_(set.tets)
    , materials_(set.regions.of_tet)
{
    const double fallback = options.law == SolidLaw::stvk ? default_poisson_stvk : default_poisson_mooney_rivlin;
    for (const SolidMaterial& material : set.regions.materials)
        moduli_.push_back(solid_moduli(material.young / set.regions.materials[0].young, material.poisson));
    if (materials_.empty() || moduli_.empty()) {
        moduli_ = { solid_moduli(1, options.poisson < 0 ? fallback : options.poisson) };
        materials_.assign(tets_.size(), 0);
    }
    rests_.reserve(tets_.size() * pose_count_);
    for (const Tetrahedron& tet : tets_)
        for (const Shape& shape : set.shapes) rests_.push_back(rest_of(tet_edges(shape, tet)));
    if (blend_ == Blend::average) return;
    logarithms_.reserve(rests_.size());
    for (std::size_t e = 0; e < tets_.size(); ++e)
        for (std::size_t k = 0; k < pose_count_; ++k)
            logarithms_.push_back(symmetric_logarithm(congruence(rest(e, 0).inverse) * rest(e, k).metric));
}

Solid::Rest Solid::rest_of(const Eigen::Matrix3d& edges)
{
    return { edges.inverse(), metric_of(edges), edges.determinant() / 6 };
}

// The edges exp(S/2) D_0 have the metric D_0^T exp(S) D_0.
Solid::Rest Solid::layered_rest(std::size_t element, const double* weights) const
{
    SymmetricVector sum = SymmetricVector::Zero();
    for (std::size_t k = 1; k < pose_count_; ++k)
        if (weights[k - 1] != 0) sum += weights[k - 1] * logarithms_[element * pose_count_ + k];
    if (sum.isZero(0)) return rest(element, 0);
    return rest_of(symmetric_exponential(0.5 * sum) * rest(element, 0).inverse.inverse());
}

const std::uint32_t* Solid::element_vertices(std::size_t element, std::size_t& count) const
{
    count = 4;
    return tets_[element].data();
}

void Solid::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                     ElementResult& result) const
{
    const Eigen::Map<const Eigen::Matrix<double, 3, 4>> corners(x);
    const Eigen::Matrix3d edges = corners.rightCols<3>().colwise() - corners.col(0);
    const SymmetricVector g = metric_of(edges);
    const SolidModuli& moduli = moduli_[materials_[element]];
    result.value = 0;
    if (law_ == SolidLaw::mooney_rivlin && !(edges.determinant() > 0))
        result.value = std::numeric_limits<double>::infinity(); // the metric alone does not see that it is inside out
    SymmetricVector slope = SymmetricVector::Zero();
    SymmetricMatrix6 curvature = SymmetricMatrix6::Zero();
    const auto add = [&](double weight, const Rest& r) {
        const SymmetricMatrix6 to_strain = congruence(r.inverse);
        SymmetricVector by_c = SymmetricVector::Zero();
        SymmetricMatrix6 by_cc = SymmetricMatrix6::Zero();
        add_density(law_, moduli, weight * r.volume, to_strain * (g - r.metric), &result.value,
                    order >= Order::gradient ? &by_c : nullptr, order == Order::hessian ? &by_cc : nullptr);
        if (order >= Order::gradient) slope += to_strain.transpose() * by_c;
        if (order == Order::hessian) curvature += to_strain.transpose() * by_cc * to_strain;
    };
    if (blend_ == Blend::layers)
        add(1, layered_rest(element, weights));
    else
        for (std::size_t k = 0; k < pose_count_; ++k)
            if (weights[k] != 0) add(weights[k], rest(element, k));
    if (order < Order::gradient) return;
    static const Eigen::Matrix<double, 12, 9> to_vertices = edges_to_vertices();
    const Eigen::Matrix<double, 9, 6> jacobian = metric_jacobian(edges);
    result.gradient = to_vertices * (jacobian * slope);
    if (order < Order::hessian) return;

    Eigen::Matrix<double, 9, 9> h = jacobian * curvature * jacobian.transpose();
    int component = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j, ++component)
            for (int c = 0; c < 3; ++c) {
                h(3 * i + c, 3 * j + c) += slope[component];
                h(3 * j + c, 3 * i + c) += slope[component];
            }
    if (kind == HessianKind::projected) project_positive(h);
    result.hessian = to_vertices * h * to_vertices.transpose();
}

SymmetricMatrix6 Solid::quadratic_root(std::size_t element, std::size_t pose) const
{
    SymmetricMatrix6 stiffness = SymmetricMatrix6::Zero();
    const Rest& r = rest(element, pose);
    add_density(SolidLaw::stvk, moduli_[materials_[element]], r.volume, SymmetricVector::Zero(), nullptr, nullptr,
                &stiffness);
    const Eigen::LLT<SymmetricMatrix6> factor(0.5 * stiffness); // positive definite for poisson in (-1, 1/2)
    return factor.matrixU() * congruence(r.inverse);
}

// The coefficients of formats/SPEC.md, kinds 6 and 7: everything is relative to the shape at z = 0, B = D_s(reference)
// D_m^-1.
RuntimeElement Solid::runtime_element(std::size_t element, const Shape& reference) const
{
    const Tetrahedron& t = tets_[element];
    const Eigen::Matrix3d edges = tet_edges(reference, t);
    RuntimeElement out;
    out.kind = law_ == SolidLaw::stvk ? PLIANT_ELEMENT_TET_STVK : PLIANT_ELEMENT_TET_MOONEY_RIVLIN;
    out.differences = { { t[0], t[1] }, { t[0], t[2] }, { t[0], t[3] } };
    out.combination = edges.inverse();
    const SolidModuli& moduli = moduli_[materials_[element]];
    const pliant_format_shape shape = pliant_format_batch_shape(out.kind, 0, 0);
    out.pose_numbers.resize(Eigen::Index(pose_count_), shape.pose_number_count);
    for (std::size_t k = 0; k < pose_count_; ++k) {
        const Rest& r = rest(element, k);
        const Eigen::Matrix3d b = edges * r.inverse, cofactor = b.determinant() * b.inverse().transpose();
        auto row = out.pose_numbers.row(Eigen::Index(k));
        if (law_ == SolidLaw::stvk) {
            const SymmetricMatrix6 to_strain = congruence(b);
            const SymmetricVector c0 = six(b.transpose() * b - Eigen::Matrix3d::Identity());
            SymmetricVector slope = SymmetricVector::Zero();
            SymmetricMatrix6 stiffness = SymmetricMatrix6::Zero();
            add_density(law_, moduli, r.volume, c0, nullptr, &slope, &stiffness);
            row.head<6>() = to_strain.transpose() * slope;
            const SymmetricMatrix6 q = to_strain.transpose() * stiffness * to_strain;
            Eigen::Index next = 6;
            for (int i = 0; i < 6; ++i)
                for (int j = i; j < 6; ++j) row[next++] = q(i, j);
        } else {
            const double det = b.determinant();
            const Eigen::Matrix3d first = r.volume * moduli.mu10 * std::pow(det, -2.0 / 3) * b * b.transpose();
            const Eigen::Matrix3d second
                = r.volume * moduli.mu01 * std::pow(det, -4.0 / 3) * cofactor * cofactor.transpose();
            const double bulk = r.volume * moduli.v1 * det * det, pressure = r.volume * moduli.v1 * det * (det - 1);
            const Eigen::Matrix3d linear
                = first - second + (pressure - first.trace() / 3 + second.trace() / 3) * Eigen::Matrix3d::Identity();
            row << six(linear).transpose(), six(first).transpose(), six(second).transpose(), bulk, pressure;
        }
    }
    return out;
}

} // namespace pliant
