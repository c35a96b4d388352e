#include "energy/energy.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace pliant {

void gather(const std::uint32_t* vertices, std::size_t count, const Shape& y, double* x)
{
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) x[3 * i + c] = y[3 * Eigen::Index(vertices[i]) + c];
}

namespace {

// Calls visit(result, vertices, count) for every element, in order: sums come out the same on every run.
template <class Visit>
void for_each_element(const Energy& energy, const Weights& w, const Shape& y, Order order, Visit visit)
{
    ElementResult result;
    std::vector<double> x;
    for (std::size_t e = 0; e < energy.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy.element_vertices(e, count);
        x.resize(3 * count);
        gather(vertices, count, y, x.data());
        energy.evaluate(e, w.data(), x.data(), order, HessianKind::exact, result);
        visit(result, vertices, count);
    }
}

} // namespace

double energy_value(const Energy& energy, const Weights& w, const Shape& y)
{
    double sum = 0;
    for_each_element(energy, w, y, Order::value,
                     [&](const ElementResult& r, const std::uint32_t*, std::size_t) { sum += r.value; });
    return sum;
}

double add_gradient(const Energy& energy, const Weights& w, const Shape& y, Shape& gradient, double* force_scale)
{
    double sum = 0;
    Eigen::VectorXd forces;
    if (force_scale) forces.setZero(y.size() / 3);
    for_each_element(energy, w, y, Order::gradient,
                     [&](const ElementResult& r, const std::uint32_t* vertices, std::size_t count) {
                         sum += r.value;
                         for (std::size_t i = 0; i < count; ++i) {
                             const Eigen::Vector3d force = r.gradient.segment<3>(3 * Eigen::Index(i));
                             gradient.segment<3>(3 * Eigen::Index(vertices[i])) += force;
                             if (force_scale) forces[vertices[i]] += force.norm();
                         }
                     });
    if (force_scale) *force_scale = forces.norm();
    return sum;
}

Weights corner_weights(std::size_t pose_count, std::size_t pose)
{
    return Weights::Unit(Eigen::Index(pose_count), Eigen::Index(pose));
}

Weights equal_weights(std::size_t pose_count)
{
    return Weights::Constant(Eigen::Index(pose_count), 1.0 / double(pose_count));
}

void project_positive(Eigen::Ref<Eigen::MatrixXd> matrix)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    if (eigen.eigenvalues()[0] >= 0) return;
    matrix = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

} // namespace pliant
