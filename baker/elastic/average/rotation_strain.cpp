#include "elastic/average/rotation_strain.h"

#include "base/common/union_find.h"
#include "base/mesh/align.h"
#include "elastic/energy/best_rotation.h"
#include "elastic/energy/hyperelastic.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>

namespace pliant {

namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;
template <int Edges> using Frame = Eigen::Matrix<double, 3, Edges>;
template <int Edges> using Strain = Eigen::Matrix<double, Edges, Edges>;

constexpr double turn = 2 * 3.14159265358979323846;

// Largest move of a vertex in the difference quotients, of 1: the root of the area or the cube root of the volume.
constexpr double small_move = 1e-5;

// Regularization of flat cells, so small that long triangles come back as they were.
constexpr double flat = 1e-12;

// What a cell does from the base to a shape: rotation * frame * (1 + strain) along the frame.
template <int Edges> struct Motion {
    Matrix3d rotation;
    Strain<Edges> strain;
};

// The inverse of symmetric().
SymmetricVector upper_half(const Matrix3d& m)
{
    return (SymmetricVector() << m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)).finished();
}

// Two columns orthonormal in the plane of a triangle.
Frame<2> frame_of(const Frame<2>& edges)
{
    Frame<2> frame;
    frame.col(0) = edges.col(0).squaredNorm() > 0 ? Vector3d(edges.col(0).normalized()) : Vector3d::UnitX();
    const Vector3d across = edges.col(1) - edges.col(1).dot(frame.col(0)) * frame.col(0);
    frame.col(1) = across.squaredNorm() > 0 ? Vector3d(across.normalized()) : frame.col(0).unitOrthogonal();
    return frame;
}

Frame<3> frame_of(const Frame<3>&) { return Frame<3>::Identity(); }

Matrix3d with_normal(const Frame<2>& frame)
{
    Matrix3d out;
    out << frame, Vector3d(frame.col(0)).cross(Vector3d(frame.col(1)));
    return out;
}

// Of the gradient along the frame. Gradient + its cofactor = rotation * trace of the stretch, also of flat cells.
Motion<2> motion_of(const Frame<2>& gradient, const Frame<2>& frame)
{
    const Vector3d a = gradient.col(0), b = gradient.col(1), cross = a.cross(b);
    const Vector3d normal = cross.squaredNorm() > 0 ? Vector3d(cross.normalized()) : with_normal(frame).col(2);
    Frame<2> turned;
    turned << a + b.cross(normal), b + normal.cross(a);
    turned = frame_of(turned);
    const Strain<2> stretch = turned.transpose() * gradient;
    return { with_normal(turned) * with_normal(frame).transpose(),
             0.5 * (stretch + stretch.transpose()) - Strain<2>::Identity() };
}

Motion<3> motion_of(const Frame<3>& gradient, const Frame<3>&)
{
    const Matrix3d rotation = best_rotation(gradient), stretch = rotation.transpose() * gradient;
    return { rotation, 0.5 * (stretch + stretch.transpose()) - Matrix3d::Identity() };
}

Vector3d rotation_vector(const Matrix3d& rotation)
{
    const Eigen::AngleAxisd turned(rotation);
    return turned.angle() * turned.axis();
}

// The same rotation, with as many full turns as bring the vector nearest to another.
Vector3d unwound(const Vector3d& vector, const Vector3d& other)
{
    const double angle = vector.norm(), length = other.norm();
    if (angle < 1e-9 && length < 1e-9) return vector;
    const Vector3d axis = angle < 1e-9 ? Vector3d(other / length) : Vector3d(vector / angle);
    return (angle + turn * std::round((other.dot(axis) - angle) / turn)) * axis;
}

template <std::size_t Corners>
void append_motions(const std::vector<Cell<Corners>>& cells, const Shape& base, const Shape& shape, Eigen::VectorXd& out)
{
    constexpr int edges = int(Corners) - 1, size = 3 + edges * (edges + 1) / 2;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Frame<edges> before = edges_of(base, cells[i]), frame = frame_of(before);
        const Frame<edges> gradient = edges_of(shape, cells[i]) * (dual(before, flat) * frame);
        const Motion<edges> motion = motion_of(gradient, frame);
        double* at = out.data() + size * Index(i);
        Eigen::Map<Vector3d> vector(at);
        vector = rotation_vector(motion.rotation);
        at += 3;
        for (int a = 0; a < edges; ++a)
            for (int b = a; b < edges; ++b) *at++ = motion.strain(a, b);
    }
}

template <std::size_t Corners>
Eigen::Matrix3Xd changes_of(const std::vector<Cell<Corners>>& cells, const Shape& base, const Eigen::VectorXd& coordinates)
{
    constexpr int edges = int(Corners) - 1, size = 3 + edges * (edges + 1) / 2;
    Eigen::Matrix3Xd changes(3, edges * Index(cells.size()));
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Frame<edges> before = edges_of(base, cells[i]), frame = frame_of(before);
        const double* at = coordinates.data() + size * Index(i);
        const Matrix3d rotation = rotation_by(Vector3d(at));
        at += 3;
        Strain<edges> stretch = Strain<edges>::Identity();
        for (int a = 0; a < edges; ++a)
            for (int b = a; b < edges; ++b, ++at) {
                stretch(a, b) += *at;
                if (a != b) stretch(b, a) += *at;
            }
        changes.middleCols<edges>(edges * Index(i)) = rotation * frame * stretch * (frame.transpose() * before) - before;
    }
    return changes;
}

// Cells that have a facet (an edge of triangles, a face of tetrahedra) in common.
template <std::size_t Corners> std::vector<std::vector<std::uint32_t>> neighbours_of(const std::vector<Cell<Corners>>& cells)
{
    std::vector<std::pair<Cell<Corners - 1>, std::uint32_t>> facets;
    for (std::uint32_t i = 0; i < cells.size(); ++i)
        for (std::size_t left_out = 0; left_out < Corners; ++left_out) {
            Cell<Corners - 1> facet {};
            for (std::size_t c = 1; c < Corners; ++c) facet[c - 1] = cells[i][(left_out + c) % Corners];
            std::sort(facet.begin(), facet.end());
            facets.emplace_back(facet, i);
        }
    std::sort(facets.begin(), facets.end());
    std::vector<std::vector<std::uint32_t>> out(cells.size());
    for (std::size_t i = 1; i < facets.size(); ++i)
        if (facets[i].first == facets[i - 1].first) {
            out[facets[i].second].push_back(facets[i - 1].second);
            out[facets[i - 1].second].push_back(facets[i].second);
        }
    return out;
}

template <std::size_t Corners> void join_corners(const std::vector<Cell<Corners>>& cells, UnionFind& vertices)
{
    for (const Cell<Corners>& cell : cells)
        for (std::uint32_t v : cell) vertices.join(cell[0], v);
}

} // namespace

RotationStrain::RotationStrain(const NormalizedPoses& set, Shape base)
    : set_(set)
    , base_(std::move(base))
    , neighbours_(set.is_solid() ? neighbours_of(set.tets) : neighbours_of(set.triangles))
    , component_of_vertex_(std::size_t(set.dof_count() / 3))
{
    UnionFind vertices(component_of_vertex_.size());
    if (set.is_solid())
        join_corners(set.tets, vertices);
    else
        join_corners(set.triangles, vertices);
    std::uint32_t count = 0;
    for (std::uint32_t v = 0; v < component_of_vertex_.size(); ++v) { // the lowest vertex represents its component
        const std::uint32_t first = vertices.find(v);
        component_of_vertex_[v] = first == v ? count++ : component_of_vertex_[first];
    }
    is_held_.resize(count);
    for (std::uint32_t v : set.fixed_vertices) is_held_[component_of_vertex_[v]] = true;
}

Eigen::Matrix3Xd RotationStrain::centroids(const Shape& shape) const
{
    Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, Index(is_held_.size()));
    Eigen::VectorXd masses = Eigen::VectorXd::Zero(sums.cols());
    for (std::uint32_t v = 0; v < component_of_vertex_.size(); ++v) {
        sums.col(component_of_vertex_[v]) += set_.masses[v] * point(shape, v);
        masses[component_of_vertex_[v]] += set_.masses[v];
    }
    return sums * masses.cwiseInverse().asDiagonal();
}

// Every rotation by at most half a turn.
Eigen::VectorXd RotationStrain::principal(const Shape& shape) const
{
    const Index inner = cell_size() * cell_count();
    Eigen::VectorXd out(inner + 3 * Index(is_held_.size()));
    if (set_.is_solid())
        append_motions(set_.tets, base_, shape, out);
    else
        append_motions(set_.triangles, base_, shape, out);
    Eigen::Map<Eigen::Matrix3Xd>(out.data() + inner, 3, Index(is_held_.size())) = centroids(shape);
    return out;
}

// From the cell of each component that turns least to its neighbours, always to the cell that turns least against one before
// it: a cell that is turned over is among the last, and misleads no other.
void RotationStrain::make_continuous(Eigen::VectorXd& coordinates) const
{
    const auto vector = [&](std::uint32_t cell) { return coordinates.segment<3>(cell_size() * Index(cell)); };
    std::vector<std::uint32_t> order(neighbours_.size());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<double> angles;
    std::vector<Eigen::Quaterniond> turns;
    for (std::uint32_t cell : order) {
        angles.push_back(vector(cell).norm());
        turns.emplace_back(rotation_by(vector(cell)));
    }
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return std::make_pair(angles[a], a) < std::make_pair(angles[b], b); });
    struct Visit {
        double difference;
        std::uint32_t cell, from;
        bool operator<(const Visit& other) const // the least difference first
        {
            return std::tie(other.difference, other.cell, other.from) < std::tie(difference, cell, from);
        }
    };
    std::vector<bool> is_done(order.size());
    std::priority_queue<Visit> queue;
    for (std::uint32_t root : order) {
        if (!is_done[root]) queue.push({ 0, root, root });
        while (!queue.empty()) {
            const Visit visit = queue.top();
            queue.pop();
            if (is_done[visit.cell]) continue;
            is_done[visit.cell] = true;
            vector(visit.cell) = unwound(vector(visit.cell), vector(visit.from));
            for (std::uint32_t other : neighbours_[visit.cell])
                if (!is_done[other]) queue.push({ 1 - std::abs(turns[visit.cell].dot(turns[other])), other, visit.cell });
        }
    }
}

Eigen::VectorXd RotationStrain::coordinates(const Shape& shape) const
{
    Eigen::VectorXd out = principal(shape);
    make_continuous(out);
    return out;
}

Eigen::MatrixXd RotationStrain::derivatives(const Shape& shape, const Eigen::VectorXd& coordinates,
                                            const Eigen::MatrixXd& displacements) const
{
    const auto along = [&](const Shape& moved) {
        Eigen::VectorXd out = principal(moved);
        for (Index i = 0; i < cell_count(); ++i) {
            auto vector = out.segment<3>(cell_size() * i);
            vector = unwound(vector, coordinates.segment<3>(cell_size() * i));
        }
        return out;
    };
    Eigen::MatrixXd out(coordinates.size(), displacements.cols());
    for (Index c = 0; c < displacements.cols(); ++c) {
        const double largest = displacements.col(c).cwiseAbs().maxCoeff();
        const double step = largest > 0 ? small_move / largest : 1;
        out.col(c) = (along(shape + step * displacements.col(c)) - along(shape - step * displacements.col(c))) / (2 * step);
    }
    return out;
}

Eigen::MatrixXd RotationStrain::at_vertices(const Eigen::VectorXd& coordinates) const
{
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(12, Index(component_of_vertex_.size()));
    Eigen::VectorXd sizes = Eigen::VectorXd::Zero(out.cols());
    for (std::size_t i = 0; i < set_.triangles.size(); ++i) {
        const auto at = coordinates.segment<6>(6 * Index(i));
        const Frame<2> edges = edges_of(base_, set_.triangles[i]), frame = frame_of(edges);
        const Matrix3d strain = frame * (Strain<2>() << at[3], at[4], at[4], at[5]).finished() * frame.transpose();
        const double size = std::abs((frame.transpose() * edges).determinant());
        for (std::uint32_t v : set_.triangles[i]) {
            out.col(v).head<3>() += size * at.head<3>();
            out.col(v).segment<6>(3) += size * upper_half(strain);
            sizes[v] += size;
        }
    }
    out *= sizes.cwiseMax(1e-300).cwiseInverse().asDiagonal();
    for (std::size_t v = 0; v < component_of_vertex_.size(); ++v)
        out.col(Index(v)).tail<3>() = coordinates.segment<3>(centroid_row(component_of_vertex_[v]));
    return out;
}

void RotationStrain::add_at_vertices(const Eigen::MatrixXd& fields, Eigen::VectorXd& coordinates) const
{
    for (std::size_t i = 0; i < set_.triangles.size(); ++i) {
        const Triangle& t = set_.triangles[i];
        const Eigen::Matrix<double, 12, 1> mean = (fields.col(t[0]) + fields.col(t[1]) + fields.col(t[2])) / 3;
        const Frame<2> frame = frame_of(edges_of(base_, t));
        const Strain<2> strain = frame.transpose() * symmetric(mean.segment<6>(3)) * frame;
        auto at = coordinates.segment<6>(6 * Index(i));
        at.head<3>() += mean.head<3>();
        at.tail<3>() += Vector3d(strain(0, 0), strain(0, 1), strain(1, 1));
    }
    std::vector<bool> is_moved(is_held_.size());
    for (std::size_t v = 0; v < component_of_vertex_.size(); ++v) {
        if (is_moved[component_of_vertex_[v]]) continue;
        is_moved[component_of_vertex_[v]] = true;
        coordinates.segment<3>(centroid_row(component_of_vertex_[v])) += fields.col(Index(v)).tail<3>();
    }
}

Shape RotationStrain::shape(const Eigen::VectorXd& coordinates, const CellFit& fit) const
{
    Shape out = fit(
        base_, set_.is_solid() ? changes_of(set_.tets, base_, coordinates) : changes_of(set_.triangles, base_, coordinates));
    const Eigen::Matrix3Xd wanted
        = Eigen::Map<const Eigen::Matrix3Xd>(coordinates.data() + cell_size() * cell_count(), 3, Index(is_held_.size()));
    const Eigen::Matrix3Xd moves = wanted - centroids(base_); // the fit keeps centroids
    for (std::uint32_t v = 0; v < component_of_vertex_.size(); ++v)
        if (!is_held_[component_of_vertex_[v]]) out.segment<3>(3 * Index(v)) += moves.col(component_of_vertex_[v]);
    align_to(set_, set_.shapes[0], out);
    return out;
}

} // namespace pliant
