#include "elastic/energy/arap.h"

#include "pliant_format.h"

#include <Eigen/Dense>

namespace pliant {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Half the cotangent of the angle at i.
double half_cotangent(const Shape& shape, std::uint32_t i, std::uint32_t j, std::uint32_t k)
{
    const Vector3d u = point(shape, j) - point(shape, i), v = point(shape, k) - point(shape, i);
    return 0.5 * u.dot(v) / u.cross(v).norm();
}

Matrix3d cross_matrix(const Vector3d& v)
{
    Matrix3d m;
    m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return m;
}

// The rotation R that maximises tr(R^T M), and that maximum.
struct BestRotation {
    Matrix3d rotation;
    double trace;
};

BestRotation best_rotation(const Matrix3d& m)
{
    const Eigen::JacobiSVD<Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Matrix3d u = svd.matrixU(), v = svd.matrixV();
    const double sign = (u * v.transpose()).determinant() < 0 ? -1 : 1;
    const Vector3d signs(1, 1, sign);
    return { u * signs.asDiagonal() * v.transpose(), svd.singularValues().dot(signs) };
}

} // namespace

Arap::Arap(const NormalizedPoses& set)
    : pose_count_(Eigen::Index(set.pose_count()))
    , dof_count_(set.dof_count())
    , cells_(std::size_t(set.dof_count() / 3))
{
    require_manifold(set.triangles, cells_.size(), set.source_vertices, "--material arap",
                     "repair it the same way in all poses, or use --material discrete-shells, which does not need one");
    const std::vector<Fan> fans = find_fans(set.triangles, cells_.size());

    for (std::size_t i = 0; i < cells_.size(); ++i) {
        Cell& cell = cells_[i];
        const Fan& fan = fans[i];
        const int valence = int(fan.ring.size());
        cell.is_closed = fan.is_closed;
        cell.vertices.push_back(std::uint32_t(i));
        cell.vertices.insert(cell.vertices.end(), fan.ring.begin(), fan.ring.end());
        for (int j = 0; j < valence; ++j) cell.edges.push_back({ 0, 1 + j });
        for (int j = 0; j + 1 < valence; ++j) cell.edges.push_back({ 1 + j, 2 + j });
        if (fan.is_closed) cell.edges.push_back({ valence, 1 });
        cell.cotangents.setZero(pose_count_, Eigen::Index(cell.edges.size()));
        cell.rest_edges.resize(3 * pose_count_, Eigen::Index(cell.edges.size()));
        for (Eigen::Index k = 0; k < pose_count_; ++k) {
            const Shape& shape = set.shapes[std::size_t(k)];
            for (std::size_t e = 0; e < cell.edges.size(); ++e) {
                const std::uint32_t a = cell.vertices[std::size_t(cell.edges[e][0])];
                const std::uint32_t b = cell.vertices[std::size_t(cell.edges[e][1])];
                cell.rest_edges.block<3, 1>(3 * k, Eigen::Index(e)) = point(shape, b) - point(shape, a);
            }
            // Triangle by triangle: the cell is a sum of Dirichlet energies of y - R x_k, none of which is negative, however
            // obtuse the triangles are. A rim's angle outside of the cell would make it indefinite.
            for (int j = 0; j < (fan.is_closed ? valence : valence - 1); ++j) {
                const int next = (j + 1) % valence;
                const std::uint32_t centre = std::uint32_t(i), a = fan.ring[std::size_t(j)], b = fan.ring[std::size_t(next)];
                cell.cotangents(k, j) += half_cotangent(shape, b, centre, a);
                cell.cotangents(k, next) += half_cotangent(shape, a, b, centre);
                cell.cotangents(k, valence + j) = half_cotangent(shape, centre, a, b);
            }
        }
    }
}

const std::uint32_t* Arap::element_vertices(std::size_t element, std::size_t& count) const
{
    count = cells_[element].vertices.size();
    return cells_[element].vertices.data();
}

// Gradient per edge 2 c (e - R ebar). Hessian: 2 sum c |de|^2 - 2 s^T (tr(B) I - B)^-1 s with B = R^T M and
// s = sum c ebar x (R^T de): the rotation follows the edges (M = sum c e ebar^T).
void Arap::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                    ElementResult& result) const
{
    const Cell& cell = cells_[element];
    const Eigen::Index edge_count = Eigen::Index(cell.edges.size()), local = 3 * Eigen::Index(cell.vertices.size());
    Eigen::Matrix3Xd edges(3, edge_count);
    for (Eigen::Index e = 0; e < edge_count; ++e)
        for (int c = 0; c < 3; ++c)
            edges(c, e) = x[3 * cell.edges[std::size_t(e)][1] + c] - x[3 * cell.edges[std::size_t(e)][0] + c];

    result.value = 0;
    if (order >= Order::gradient) result.gradient.setZero(local);
    if (order == Order::hessian) result.hessian.setZero(local, local);
    for (Eigen::Index k = 0; k < pose_count_; ++k) {
        if (weights[k] == 0) continue;
        const auto rest = cell.rest_edges.middleRows<3>(3 * k);
        const Eigen::RowVectorXd c = cell.cotangents.row(k);
        const Matrix3d m = edges * c.asDiagonal() * rest.transpose();
        const Matrix3d rotation = best_rotation(m).rotation;
        const Eigen::Matrix3Xd off = edges - rotation * rest;
        result.value += weights[k] * off.colwise().squaredNorm().dot(c);
        if (order < Order::gradient) continue;
        Eigen::MatrixXd turn(3, local); // s as a linear map of the local coordinates
        turn.setZero();
        for (Eigen::Index e = 0; e < edge_count; ++e) {
            const Eigen::Index a = 3 * cell.edges[std::size_t(e)][0], b = 3 * cell.edges[std::size_t(e)][1];
            const Vector3d force = 2 * weights[k] * c[e] * off.col(e);
            result.gradient.segment<3>(b) += force;
            result.gradient.segment<3>(a) -= force;
            if (order < Order::hessian) continue;
            const Matrix3d j = c[e] * cross_matrix(rest.col(e)) * rotation.transpose();
            turn.middleCols<3>(b) += j;
            turn.middleCols<3>(a) -= j;
            for (int i = 0; i < 3; ++i) {
                const double stiffness = 2 * weights[k] * c[e];
                result.hessian(a + i, a + i) += stiffness;
                result.hessian(b + i, b + i) += stiffness;
                result.hessian(a + i, b + i) -= stiffness;
                result.hessian(b + i, a + i) -= stiffness;
            }
        }
        if (order < Order::hessian) continue;
        const Matrix3d b = rotation.transpose() * m;
        const Matrix3d k_matrix = b.trace() * Matrix3d::Identity() - b;
        result.hessian -= 2 * weights[k] * turn.transpose() * k_matrix.inverse() * turn;
    }
    if (order == Order::hessian && kind == HessianKind::projected) {
        result.hessian = (0.5 * (result.hessian + result.hessian.transpose())).eval();
        project_positive(result.hessian);
    }
}

RuntimeElement Arap::runtime_element(std::size_t element, const Shape& reference) const
{
    const Cell& cell = cells_[element];
    const Eigen::Index edge_count = Eigen::Index(cell.edges.size());
    RuntimeElement out;
    out.kind = PLIANT_ELEMENT_ARAP_CELL;
    out.valence = std::uint32_t(cell.vertices.size() - 1);
    out.is_closed = cell.is_closed;
    for (std::size_t i = 1; i < cell.vertices.size(); ++i) out.differences.push_back({ cell.vertices[0], cell.vertices[i] });
    out.pose_numbers.resize(pose_count_, 4 * edge_count + 1);
    Eigen::Matrix3Xd edges(3, edge_count);
    for (Eigen::Index e = 0; e < edge_count; ++e)
        edges.col(e) = point(reference, cell.vertices[std::size_t(cell.edges[std::size_t(e)][1])])
            - point(reference, cell.vertices[std::size_t(cell.edges[std::size_t(e)][0])]);
    for (Eigen::Index k = 0; k < pose_count_; ++k) {
        const auto rest = cell.rest_edges.middleRows<3>(3 * k);
        for (Eigen::Index e = 0; e < edge_count; ++e) {
            out.pose_numbers(k, 4 * e) = cell.cotangents(k, e);
            out.pose_numbers.block<1, 3>(k, 4 * e + 1) = cell.cotangents(k, e) * rest.col(e).transpose();
        }
        out.pose_numbers(k, 4 * edge_count)
            = best_rotation(edges * cell.cotangents.row(k).asDiagonal() * rest.transpose()).trace;
    }
    return out;
}

} // namespace pliant
