// Notation of THEORY.md, section 2, for one cell and pose k: e an edge of y, r the same edge of the pose, c its cotangent, R
// the rotation; q_v = sum of +-c r over the edges at vertex v; M = sum c e r^T = sum_v y_v q_v^T; B = R^T M.
#include "elastic/energy/arap.h"

#include "elastic/energy/best_rotation.h"
#include "pliant_format.h"

#include <Eigen/Dense>
#include <algorithm>

namespace pliant {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

// Half the cotangent of the angle at i.
double half_cotangent(const Shape& shape, std::uint32_t i, std::uint32_t j, std::uint32_t k)
{
    const Vector3d u = point(shape, j) - point(shape, i), v = point(shape, k) - point(shape, i);
    return 0.5 * u.dot(v) / u.cross(v).norm();
}

// Rigid motions cost nothing, so a Hessian is at best semidefinite: rounding must not look like a negative eigenvalue.
constexpr double rounding = 1e-10;

// Rotations are free where a cell is collapsed to a line; relative to the inertia at rest.
constexpr double least_inertia = 1e-12;

// Forces of a cell at rest are differences of large numbers. Below this strain they are rounding, which would look like an
// equilibrium of forces that is not there.
constexpr double no_strain = 1e-14;

bool is_positive(const Eigen::MatrixXd& hessian)
{
    Eigen::MatrixXd shifted = hessian;
    shifted.diagonal().array() += rounding * hessian.trace();
    return Eigen::LLT<Eigen::MatrixXd>(shifted).info() == Eigen::Success;
}

} // namespace

Arap::Edge Arap::Cell::edge(Index number) const
{
    const Index spokes = spoke_count();
    if (number < spokes) return { 0, 1 + number };
    return { 1 + number - spokes, 1 + (number - spokes + 1) % spokes };
}

Vector3d Arap::Cell::rest_edge(Index pose, const Edge& edge) const
{
    const auto rest_of = [&](Index v) -> Vector3d { return rest.col(pose * spoke_count() + v - 1); };
    return edge.tail == 0 ? rest_of(edge.head) : Vector3d(rest_of(edge.head) - rest_of(edge.tail));
}

void Arap::Cell::measure()
{
    const Index pose_count = cotangents.cols(), vertex_count = spoke_count() + 1;
    moments.setZero(3, pose_count * vertex_count);
    rest_inertia.setZero(pose_count);
    for (Index k = 0; k < pose_count; ++k)
        for (Index i = 0; i < edge_count(); ++i) {
            const Edge at = edge(i);
            const Vector3d e = rest_edge(k, at), moment = cotangents(i, k) * e;
            rest_inertia[k] += 2 * cotangents(i, k) * e.squaredNorm();
            moments.col(k * vertex_count + at.head) += moment;
            moments.col(k * vertex_count + at.tail) -= moment;
        }
}

Arap::Arap(const NormalizedPoses& set, Blend blend)
    : Arap(set, std::vector<bool>(std::size_t(set.dof_count() / 3), true), blend)
{
}

Arap::Arap(const NormalizedPoses& set, const std::vector<bool>& is_centre, Blend blend)
    : blend_(blend)
    , pose_count_(Index(set.pose_count()))
    , dof_count_(set.dof_count())
{
    for (const Fan& fan : find_fans(set.triangles, set.shapes[0]))
        if (is_centre[fan.centre]) cells_.push_back(make_cell(fan, set));
    if (blend_ == Blend::layers) std::for_each(cells_.begin(), cells_.end(), turn_to_rest);
}

// Triangle by triangle: the cell is a sum of Dirichlet energies of y - R x_k, none of which is negative, however obtuse the
// triangles are. A rim's angle outside of the cell would make it indefinite.
Arap::Cell Arap::make_cell(const Fan& fan, const NormalizedPoses& set) const
{
    const Index spokes = Index(fan.ring.size()), faces = Index(fan.face_count());
    Cell cell;
    cell.is_closed = fan.is_closed;
    cell.vertices.push_back(fan.centre);
    cell.vertices.insert(cell.vertices.end(), fan.ring.begin(), fan.ring.end());
    cell.cotangents.setZero(spokes + faces, pose_count_);
    cell.rest.resize(3, pose_count_ * spokes);
    for (Index k = 0; k < pose_count_; ++k) {
        const Shape& shape = set.shapes[std::size_t(k)];
        for (Index j = 0; j < spokes; ++j)
            cell.rest.col(k * spokes + j) = point(shape, fan.ring[std::size_t(j)]) - point(shape, fan.centre);
        for (Index j = 0; j < faces; ++j) {
            const Index next = (j + 1) % spokes;
            const std::uint32_t a = fan.ring[std::size_t(j)], b = fan.ring[std::size_t(next)];
            cell.cotangents(j, k) += half_cotangent(shape, b, fan.centre, a);
            cell.cotangents(next, k) += half_cotangent(shape, a, b, fan.centre);
            cell.cotangents(spokes + j, k) = half_cotangent(shape, fan.centre, a, b);
        }
    }
    cell.measure();
    return cell;
}

const std::uint32_t* Arap::element_vertices(std::size_t element, std::size_t& count) const
{
    count = cells_[element].vertices.size();
    return cells_[element].vertices.data();
}

// One pose of a cell, rotated to where it is nearest to y.
struct Arap::Rotated {
    Matrix3d rotation; // R
    Matrix3d inertia;  // tr(B) I - B: the derivative of the torque R^T y x q by the rotation; positive semidefinite
    double trace;      // of B

    Rotated(const Cell& cell, Index pose, const PointMap& y)
    {
        Matrix3d m = Matrix3d::Zero();
        for (Index v = 1; v < y.cols(); ++v) m += (y.col(v) - y.col(0)) * cell.moment(pose, v).transpose();
        rotation = best_rotation(m);
        const Matrix3d b = rotation.transpose() * m;
        trace = b.trace();
        inertia = trace * Matrix3d::Identity() - 0.5 * (b + b.transpose());
    }

    double value(const Cell& cell, Index pose, const PointMap& y) const
    {
        double sum = 0;
        for (Index i = 0; i < cell.edge_count(); ++i) {
            const Edge edge = cell.edge(i);
            const Vector3d off = y.col(edge.head) - y.col(edge.tail) - rotation * cell.rest_edge(pose, edge);
            sum += cell.cotangents(i, pose) * off.squaredNorm();
        }
        return sum;
    }

    // Three rows that, squared, are the part of the rotation in the Hessian: sqrt(K^-1) [q]x R^T for every vertex.
    template <class Rows> void turn(const Cell& cell, Index pose, double factor, Rows rows) const
    {
        const double least = least_inertia * cell.rest_inertia[pose];
        const Matrix3d k = inertia + least * Matrix3d::Identity();
        const Matrix3d root = factor * Matrix3d(Matrix3d(k.inverse()).llt().matrixU());
        for (Index v = 0; v <= cell.spoke_count(); ++v)
            rows.template middleCols<3>(3 * v).noalias()
                = root * (cross_matrix(cell.moment(pose, v)) * rotation.transpose());
    }
};

void Arap::turn_to_rest(Cell& cell)
{
    const Index spokes = cell.spoke_count();
    for (Index k = 1; k < cell.cotangents.cols(); ++k) {
        Matrix3Xd y = Matrix3Xd::Zero(3, spokes + 1); // the centre first
        y.rightCols(spokes) = cell.rest.middleCols(k * spokes, spokes);
        const Matrix3d rotation = Rotated(cell, 0, PointMap(y.data(), 3, y.cols())).rotation;
        cell.rest.middleCols(k * spokes, spokes) = rotation.transpose() * y.rightCols(spokes);
        cell.cotangents.col(k) = cell.cotangents.col(0);
    }
    cell.measure();
}

// The cell with its one rest state at these weights.
Arap::Cell Arap::layered_cell(const Cell& cell, const double* weights)
{
    const Index size = 3 * cell.spoke_count();
    const Eigen::Map<const Eigen::MatrixXd> poses(cell.rest.data(), size, cell.cotangents.cols());
    const Eigen::VectorXd rest = layered(poses, weights);
    Cell out;
    out.vertices = cell.vertices;
    out.cotangents = cell.cotangents.col(0);
    out.rest = PointMap(rest.data(), 3, cell.spoke_count());
    out.measure();
    return out;
}

void Arap::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                    ElementResult& result) const
{
    const Cell& cell = cells_[element];
    const PointMap y(x, 3, cell.spoke_count() + 1);
    constexpr double whole = 1;
    if (blend_ == Blend::layers)
        evaluate_cell(layered_cell(cell, weights), &whole, y, order, kind, result);
    else
        evaluate_cell(cell, weights, y, order, kind, result);
}

// Gradient at a vertex: 2 sum_k w_k (sum of +-c e - R q). Hessian: 2 sum_k w_k (sum c |de|^2 - s^T (tr(B) I - B)^-1 s),
// s = sum_v q_v x R^T dy_v: the rotation follows the edges.
void Arap::evaluate_cell(const Cell& cell, const double* weights, const PointMap& y, Order order, HessianKind kind,
                         ElementResult& result)
{
    const Index count = y.cols(), pose_count = cell.cotangents.cols();
    result.value = 0;
    if (order >= Order::gradient) result.gradient.setZero(3 * count);
    double inertia = 0;
    Eigen::MatrixXd turns;
    if (order == Order::hessian) turns.setZero(3 * pose_count, 3 * count);
    for (Index k = 0; k < pose_count; ++k) {
        if (weights[k] == 0) continue;
        inertia += weights[k] * cell.rest_inertia[k];
        const Rotated pose(cell, k, y);
        result.value += weights[k] * pose.value(cell, k, y);
        if (order < Order::gradient) continue;
        for (Index v = 0; v < count; ++v)
            result.gradient.segment<3>(3 * v) -= 2 * weights[k] * (pose.rotation * cell.moment(k, v));
        if (order < Order::hessian) continue;
        pose.turn(cell, k, std::sqrt(2 * weights[k]), turns.middleRows<3>(3 * k));
    }
    if (order == Order::hessian) result.hessian.noalias() = -(turns.transpose() * turns);
    if (order >= Order::gradient) add_edges(cell, weights, y, order, result);
    if (order >= Order::gradient && result.value <= no_strain * no_strain * inertia) result.gradient.setZero();
    if (order == Order::hessian && kind == HessianKind::projected && !is_positive(result.hessian))
        project_positive(result.hessian);
}

// The part without rotations: springs of no length.
void Arap::add_edges(const Cell& cell, const double* weights, const PointMap& y, Order order, ElementResult& result)
{
    for (Index i = 0; i < cell.edge_count(); ++i) {
        double stiffness = 0;
        for (Index k = 0; k < cell.cotangents.cols(); ++k) stiffness += 2 * weights[k] * cell.cotangents(i, k);
        const Edge edge = cell.edge(i);
        const Vector3d force = stiffness * (y.col(edge.head) - y.col(edge.tail));
        result.gradient.segment<3>(3 * edge.head) += force;
        result.gradient.segment<3>(3 * edge.tail) -= force;
        if (order < Order::hessian) continue;
        for (int c = 0; c < 3; ++c) {
            const Index a = 3 * edge.tail + c, b = 3 * edge.head + c;
            result.hessian(a, a) += stiffness;
            result.hessian(b, b) += stiffness;
            result.hessian(a, b) -= stiffness;
            result.hessian(b, a) -= stiffness;
        }
    }
}

// Kind 11 of formats/SPEC.md.
void Arap::add_layers(const Cell& cell, RuntimeElement& out)
{
    out.kind = PLIANT_ELEMENT_LAYERED_ARAP_CELL;
    out.fixed.assign(cell.cotangents.col(0).begin(), cell.cotangents.col(0).end());
    const Index pose_count = cell.cotangents.cols();
    out.pose_numbers.resize(pose_count, 3 * cell.edge_count());
    for (Index k = 0; k < pose_count; ++k)
        for (Index i = 0; i < cell.edge_count(); ++i)
            out.pose_numbers.block<1, 3>(k, 3 * i) = cell.cotangents(i, 0) * cell.rest_edge(k, cell.edge(i)).transpose();
    out.pose_numbers.bottomRows(pose_count - 1).rowwise() -= out.pose_numbers.row(0).eval();
}

RuntimeElement Arap::runtime_element(std::size_t element, const Shape& reference) const
{
    const Cell& cell = cells_[element];
    RuntimeElement out;
    out.kind = PLIANT_ELEMENT_ARAP_CELL;
    out.valence = std::uint32_t(cell.spoke_count());
    out.is_closed = cell.is_closed;
    Matrix3Xd y(3, Index(cell.vertices.size()));
    for (std::size_t i = 0; i < cell.vertices.size(); ++i) {
        if (i > 0) out.differences.push_back({ cell.vertices[0], cell.vertices[i] });
        y.col(Index(i)) = point(reference, cell.vertices[i]);
    }
    if (blend_ == Blend::layers) {
        add_layers(cell, out);
        return out;
    }
    out.pose_numbers.resize(pose_count_, 4 * cell.edge_count() + 1);
    for (Index k = 0; k < pose_count_; ++k) {
        for (Index i = 0; i < cell.edge_count(); ++i) {
            out.pose_numbers(k, 4 * i) = cell.cotangents(i, k);
            out.pose_numbers.block<1, 3>(k, 4 * i + 1) = cell.cotangents(i, k) * cell.rest_edge(k, cell.edge(i)).transpose();
        }
        out.pose_numbers(k, 4 * cell.edge_count()) = Rotated(cell, k, PointMap(y.data(), 3, y.cols())).trace;
    }
    return out;
}

} // namespace pliant
