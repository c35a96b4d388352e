#include "elastic/average/warp.h"

#include "base/mesh/tets.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Weights of the Laplacian's edges are cotangents. They stay above this part of the mean one, so that it is definite for
// every mesh.
constexpr double least_weight = 0.05;

// What keeps parts without fixed vertices at their centroid, over the weights: far too little to bend anything.
constexpr double anchoring = 1e-7;

// A collapsed cell says nothing about its rotation: Gram matrices are regularized by this part of their trace.
constexpr double collapsed = 1e-6;

// Corner 0 to the others, as columns.
template <std::size_t Corners>
Eigen::Matrix<double, 3, int(Corners) - 1> edges_of(const Shape& shape, const std::array<std::uint32_t, Corners>& cell)
{
    Eigen::Matrix<double, 3, int(Corners) - 1> edges;
    for (std::size_t i = 1; i < Corners; ++i) edges.col(Eigen::Index(i) - 1) = point(shape, cell[i]) - point(shape, cell[0]);
    return edges;
}

// Rows: gradients of the coordinates along the edges.
template <int Edges> Eigen::Matrix<double, Edges, 3> dual(const Eigen::Matrix<double, 3, Edges>& edges)
{
    Eigen::Matrix<double, Edges, Edges> gram = edges.transpose() * edges;
    gram.diagonal().array() += collapsed * gram.trace() + 1e-300;
    return gram.inverse() * edges.transpose();
}

// The gradient of the displacement; of a triangle with the normal part that keeps the normal a normal.
template <int Edges>
Eigen::Matrix3d gradient_of(const Eigen::Matrix<double, 3, Edges>& edges, const Eigen::Matrix<double, 3, Edges>& change)
{
    Eigen::Matrix3d gradient = change * dual(edges);
    if constexpr (Edges == 2) {
        const Eigen::Vector3d normal = edges.col(0).cross(edges.col(1)).normalized();
        gradient -= (gradient.transpose() * normal).eval() * normal.transpose();
    }
    return gradient;
}

// 1 + S where that stretches; exp(S) along the axes that shrink, so that no cell is asked to collapse.
Eigen::Matrix3d stretch_of(const Eigen::Matrix3d& strain)
{
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
    eigen.computeDirect(strain);
    const Eigen::Vector3d stretches
        = eigen.eigenvalues().unaryExpr([](double value) { return value < 0 ? std::exp(value) : 1 + value; });
    return eigen.eigenvectors() * stretches.asDiagonal() * eigen.eigenvectors().transpose();
}

// Rotation times stretch, less 1 + gradient: of second order whatever the cell. W: the skew part of the gradient, S: the
// symmetric one; the rotation is exp(W).
Eigen::Matrix3d beyond_first_order(const Eigen::Matrix3d& gradient)
{
    const Eigen::Matrix3d skew = 0.5 * (gradient - gradient.transpose()), strain = gradient - skew;
    const Eigen::Vector3d axis(skew(2, 1), skew(0, 2), skew(1, 0));
    const double angle = axis.norm();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (angle > 0) rotation = Eigen::AngleAxisd(angle, axis / angle).toRotationMatrix();
    return rotation * stretch_of(strain) - Eigen::Matrix3d::Identity() - gradient;
}

// -size grad_i . grad_j for the pairs i < j of corners; of a triangle half the cotangents.
template <std::size_t Corners>
void append_weights(const Shape& rest, const std::array<std::uint32_t, Corners>& cell, double size,
                    std::vector<double>& weights)
{
    Eigen::Matrix<double, int(Corners), 3> gradients;
    gradients.template bottomRows<int(Corners) - 1>() = dual(edges_of(rest, cell));
    gradients.row(0) = -gradients.template bottomRows<int(Corners) - 1>().colwise().sum();
    for (int i = 0; i < int(Corners); ++i)
        for (int j = i + 1; j < int(Corners); ++j) weights.push_back(-size * gradients.row(i).dot(gradients.row(j)));
}

template <std::size_t Corners>
std::vector<double> edge_weights(const NormalizedPoses& set, const std::vector<std::array<std::uint32_t, Corners>>& cells)
{
    std::vector<double> weights;
    const Eigen::VectorXd sizes = cell_sizes(set, set.shapes[0]).cwiseAbs();
    for (std::size_t i = 0; i < cells.size(); ++i) append_weights(set.shapes[0], cells[i], sizes[Eigen::Index(i)], weights);
    double mean = 0;
    for (double weight : weights) mean += std::abs(weight) / double(weights.size());
    for (double& weight : weights) weight = std::max(weight, least_weight * mean);
    return weights;
}

template <std::size_t Corners>
SparseLower laplacian_of(const NormalizedPoses& set, const std::vector<std::array<std::uint32_t, Corners>>& cells,
                         const std::vector<double>& weights)
{
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    double sum = 0;
    std::size_t edge = 0;
    for (const auto& cell : cells)
        for (std::size_t i = 0; i < Corners; ++i)
            for (std::size_t j = i + 1; j < Corners; ++j) {
                const double weight = weights[edge++];
                entries.emplace_back(cell[i], cell[i], weight);
                entries.emplace_back(cell[j], cell[j], weight);
                entries.emplace_back(std::max(cell[i], cell[j]), std::min(cell[i], cell[j]), -weight);
                sum += weight;
            }
    const Eigen::Index n = set.dof_count() / 3;
    for (Eigen::Index v = 0; v < n; ++v) entries.emplace_back(v, v, anchoring * sum / double(n) * set.masses[v]);
    SparseLower matrix(n, n);
    matrix.setFromTriplets(entries.begin(), entries.end());
    pin(matrix, { set.fixed_vertices.begin(), set.fixed_vertices.end() });
    return matrix;
}

// Right-hand side: how far the edges of the turned cells are from those of y + step.
template <std::size_t Corners>
void add_pulls(const std::vector<std::array<std::uint32_t, Corners>>& cells, const std::vector<double>& weights,
               const Shape& y, const Shape& step, Eigen::MatrixXd& pulls)
{
    std::size_t edge = 0;
    for (const auto& cell : cells) {
        const auto edges = edges_of(y, cell), change = edges_of(step, cell);
        Eigen::Matrix<double, 3, int(Corners)> off
            = Eigen::Matrix<double, 3, int(Corners)>::Zero(); // of corners from corner 0
        off.template rightCols<int(Corners) - 1>() = beyond_first_order(gradient_of(edges, change)) * edges;
        for (std::size_t i = 0; i < Corners; ++i)
            for (std::size_t j = i + 1; j < Corners; ++j) {
                const Eigen::RowVector3d pull
                    = weights[edge++] * (off.col(Eigen::Index(j)) - off.col(Eigen::Index(i))).transpose();
                pulls.row(cell[j]) += pull;
                pulls.row(cell[i]) -= pull;
            }
    }
}

} // namespace

Warp::Warp(const NormalizedPoses& set, SolverKind kind)
    : set_(set)
    , weights_(set.is_solid() ? edge_weights(set, set.tets) : edge_weights(set, set.triangles))
    , laplacian_(kind)
{
    laplacian_.factorize(set.is_solid() ? laplacian_of(set, set.tets, weights_)
                                        : laplacian_of(set, set.triangles, weights_));
}

Shape Warp::operator()(const Shape& y, const Shape& step) const
{
    Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(y.size() / 3, 3);
    if (set_.is_solid())
        add_pulls(set_.tets, weights_, y, step, pulls);
    else
        add_pulls(set_.triangles, weights_, y, step, pulls);
    for (std::uint32_t v : set_.fixed_vertices) pulls.row(v).setZero();
    const Eigen::MatrixXd off = laplacian_.solve(pulls);
    Shape out = y + step;
    for (Eigen::Index v = 0; v < off.rows(); ++v) out.segment<3>(3 * v) += off.row(v).transpose();
    return out;
}

} // namespace pliant
