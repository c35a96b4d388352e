#include "elastic/energy/energy.h"

#include "base/common/parallel.h"

#include "pliant_format.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace pliant {

Weights weights_of_pose(const Energy& energy, std::size_t pose)
{
    const Weights w = corner_weights(energy.pose_count(), pose);
    return w.tail(Eigen::Index(weight_count(energy)));
}

std::vector<Weights> corner_weights_of(const Energy& energy)
{
    std::vector<Weights> out;
    for (std::size_t k = energy.blend() == Blend::layers ? 1 : 0; k < energy.pose_count(); ++k)
        out.push_back(weights_of_pose(energy, k));
    return out;
}

// Most kinds are linear in the numbers of the poses. Of hinges and faces of layers these say what the rest state is.
void RuntimeElement::scale(double factor)
{
    if (kind == PLIANT_ELEMENT_LAYERED_HINGE) {
        fixed[1] *= factor;
    } else if (kind == PLIANT_ELEMENT_LAYERED_FACE_NEO_HOOKEAN) {
        fixed[7] *= factor;
        fixed[8] *= factor;
    } else {
        if (kind == PLIANT_ELEMENT_LAYERED_ARAP_CELL)
            for (double& stiffness : fixed) stiffness *= factor;
        pose_numbers *= factor;
    }
}

void gather(const std::uint32_t* vertices, std::size_t count, const Shape& y, double* x)
{
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) x[3 * i + c] = y[3 * Eigen::Index(vertices[i]) + c];
}

namespace {

// Calls visit(result, vertices, count) for the elements begin .. end-1, in order.
template <class Visit>
void for_elements(const Energy& energy, const Weights& w, const Shape& y, Order order, std::size_t begin, std::size_t end,
                  Visit visit)
{
    ElementResult result;
    std::vector<double> x;
    for (std::size_t e = begin; e < end; ++e) {
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
    std::array<double, piece_count> sums {};
    for_each_piece(energy.element_count(), [&](std::size_t piece, std::size_t begin, std::size_t end) {
        double sum = 0;
        for_elements(energy, w, y, Order::value, begin, end,
                     [&](const ElementResult& r, const std::uint32_t*, std::size_t) { sum += r.value; });
        sums[piece] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

std::vector<double> element_energies(const Energy& energy, const Weights& w, const Shape& y)
{
    std::vector<double> values(energy.element_count());
    for_each_piece(values.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
        auto value = values.begin() + std::ptrdiff_t(begin);
        for_elements(energy, w, y, Order::value, begin, end,
                     [&](const ElementResult& r, const std::uint32_t*, std::size_t) { *value++ = r.value; });
    });
    return values;
}

double add_gradient(const Energy& energy, const Weights& w, const Shape& y, Shape& gradient, double* force_scale)
{
    std::array<double, piece_count> sums {};
    std::array<Eigen::VectorXd, piece_count> gradients, forces;
    for_each_piece(energy.element_count(), [&](std::size_t piece, std::size_t begin, std::size_t end) {
        Eigen::VectorXd& g = gradients[piece].setZero(y.size());
        Eigen::VectorXd& f = forces[piece].setZero(force_scale ? y.size() / 3 : 0);
        double sum = 0;
        for_elements(energy, w, y, Order::gradient, begin, end,
                     [&](const ElementResult& r, const std::uint32_t* vertices, std::size_t count) {
                         sum += r.value;
                         for (std::size_t i = 0; i < count; ++i) {
                             const Eigen::Vector3d force = r.gradient.segment<3>(3 * Eigen::Index(i));
                             g.segment<3>(3 * Eigen::Index(vertices[i])) += force;
                             if (force_scale) f[vertices[i]] += force.norm();
                         }
                     });
        sums[piece] = sum;
    });
    for (std::size_t piece = 0; piece < piece_count; ++piece) {
        gradient += gradients[piece];
        if (force_scale && piece > 0) forces[0] += forces[piece];
    }
    if (force_scale) *force_scale = forces[0].norm();
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

namespace {

Eigen::MatrixXd average_forces(const Energy& energy, const Shape& y, const Eigen::MatrixXd& directions)
{
    Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(y.size(), directions.cols());
    for (Eigen::Index k = 0; k < directions.rows(); ++k) { // energies take no negative weights
        Shape force = Shape::Zero(y.size());
        add_gradient(energy, corner_weights(energy.pose_count(), std::size_t(k)), y, force);
        forces += force * directions.row(k);
    }
    return forces;
}

Eigen::MatrixXd layer_forces(const Energy& energy, const Weights& v, const Shape& y, const Eigen::MatrixXd& directions)
{
    Eigen::MatrixXd forces(y.size(), directions.cols());
    for (Eigen::Index i = 0; i < directions.cols(); ++i) {
        const double step = 1e-5 / std::max(directions.col(i).lpNorm<Eigen::Infinity>(), 1e-300);
        Shape ahead = Shape::Zero(y.size()), behind = ahead;
        add_gradient(energy, v + step * directions.col(i), y, ahead);
        add_gradient(energy, v - step * directions.col(i), y, behind);
        forces.col(i) = (ahead - behind) / (2 * step);
    }
    return forces;
}

} // namespace

Eigen::MatrixXd weight_forces(const Energy& energy, const Weights& w, const Shape& y, const Eigen::MatrixXd& directions)
{
    return energy.blend() == Blend::layers ? layer_forces(energy, w, y, directions) : average_forces(energy, y, directions);
}

void project_positive(Eigen::Ref<Eigen::MatrixXd> matrix)
{
    if (Eigen::LLT<Eigen::MatrixXd>(matrix).info() == Eigen::Success) return; // most elements, at a fraction of the cost
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    if (eigen.eigenvalues()[0] >= 0) return;
    matrix = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).asDiagonal() * eigen.eigenvectors().transpose();
}

} // namespace pliant
