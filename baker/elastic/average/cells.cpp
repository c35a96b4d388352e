#include "elastic/average/cells.h"

#include "base/mesh/tets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace pliant {

namespace {

// Weights of the Laplacian's edges are cotangents. They stay above this part of the mean one, so that it is definite for
// every mesh.
constexpr double least_weight = 0.05;

// What keeps parts without fixed vertices at their centroid, over the weights: far too little to bend anything.
constexpr double anchoring = 1e-7;

// -size grad_i . grad_j for the pairs i < j of corners; of a triangle half the cotangents.
template <std::size_t Corners>
void append_weights(const Shape& rest, const Cell<Corners>& cell, double size, std::vector<double>& weights)
{
    Eigen::Matrix<double, int(Corners), 3> gradients;
    gradients.template bottomRows<int(Corners) - 1>() = dual(edges_of(rest, cell), collapsed_cell);
    gradients.row(0) = -gradients.template bottomRows<int(Corners) - 1>().colwise().sum();
    for (int i = 0; i < int(Corners); ++i)
        for (int j = i + 1; j < int(Corners); ++j) weights.push_back(-size * gradients.row(i).dot(gradients.row(j)));
}

template <std::size_t Corners>
std::vector<double> edge_weights(const NormalizedPoses& set, const std::vector<Cell<Corners>>& cells, double most_weight)
{
    std::vector<double> weights;
    const Eigen::VectorXd sizes = cell_sizes(set, set.shapes[0]).cwiseAbs();
    for (std::size_t i = 0; i < cells.size(); ++i) append_weights(set.shapes[0], cells[i], sizes[Eigen::Index(i)], weights);
    std::vector<double> amounts;
    for (double weight : weights) amounts.push_back(std::abs(weight));
    const double mean = std::accumulate(amounts.begin(), amounts.end(), 0.0) / double(amounts.size());
    std::nth_element(amounts.begin(), amounts.begin() + std::ptrdiff_t(amounts.size() / 2), amounts.end());
    const double least = least_weight * mean, most = std::max(least, most_weight * amounts[amounts.size() / 2]);
    for (double& weight : weights) weight = std::clamp(weight, least, most);
    return weights;
}

template <std::size_t Corners>
SparseLower laplacian_of(const NormalizedPoses& set, const std::vector<Cell<Corners>>& cells,
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

template <std::size_t Corners>
void add_pulls(const std::vector<Cell<Corners>>& cells, const std::vector<double>& weights, const Eigen::Matrix3Xd& changes,
               Eigen::MatrixXd& pulls)
{
    std::size_t edge = 0;
    Eigen::Matrix<double, 3, int(Corners)> off = Eigen::Matrix<double, 3, int(Corners)>::Zero(); // corners from corner 0
    for (std::size_t i = 0; i < cells.size(); ++i) {
        constexpr int edges = int(Corners) - 1;
        off.template rightCols<edges>() = changes.middleCols<edges>(edges * Eigen::Index(i));
        for (std::size_t a = 0; a < Corners; ++a)
            for (std::size_t b = a + 1; b < Corners; ++b) {
                const Eigen::RowVector3d pull
                    = weights[edge++] * (off.col(Eigen::Index(b)) - off.col(Eigen::Index(a))).transpose();
                pulls.row(cells[i][b]) += pull;
                pulls.row(cells[i][a]) -= pull;
            }
    }
}

} // namespace

Eigen::Matrix3d rotation_by(const Eigen::Vector3d& vector)
{
    const double angle = vector.norm();
    if (!(angle > 0)) return Eigen::Matrix3d::Identity();
    return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

CellFit::CellFit(const NormalizedPoses& set, SolverKind kind, double most_weight)
    : set_(set)
    , weights_(set.is_solid() ? edge_weights(set, set.tets, most_weight) : edge_weights(set, set.triangles, most_weight))
    , laplacian_(kind)
{
    laplacian_.factorize(set.is_solid() ? laplacian_of(set, set.tets, weights_)
                                        : laplacian_of(set, set.triangles, weights_));
}

Shape CellFit::operator()(const Shape& shape, const Eigen::Matrix3Xd& changes) const
{
    Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(shape.size() / 3, 3);
    if (set_.is_solid())
        add_pulls(set_.tets, weights_, changes, pulls);
    else
        add_pulls(set_.triangles, weights_, changes, pulls);
    for (std::uint32_t v : set_.fixed_vertices) pulls.row(v).setZero();
    const Eigen::MatrixXd moves = laplacian_.solve(pulls);
    Shape out = shape;
    for (Eigen::Index v = 0; v < moves.rows(); ++v) out.segment<3>(3 * v) += moves.row(v).transpose();
    return out;
}

} // namespace pliant
