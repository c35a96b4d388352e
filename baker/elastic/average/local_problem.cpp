#include "elastic/average/local_problem.h"

#include "base/mesh/tets.h"

#include <algorithm>

namespace pliant {

namespace {

// Cells may shrink to this part of their size in one step.
constexpr double least_size = 0.2;

constexpr int local_iteration_limit = 20;

// A patch is at its minimum when the next step promises less than this share of its energy.
constexpr double least_decrease = 1e-4;

constexpr double shortest_local_length = 1e-3;

double size_of(const NormalizedPoses& set, std::size_t cell, const Shape& y)
{
    if (set.is_solid()) return tet_edges(y, set.tets[cell]).determinant();
    return double_area_vector(y, set.triangles[cell]).norm();
}

} // namespace

std::vector<std::uint32_t> collapsing_cells(const NormalizedPoses& set, const Shape& y, const Shape& moved)
{
    const std::size_t count = set.is_solid() ? set.tets.size() : set.triangles.size();
    std::vector<std::uint32_t> cells;
    for (std::size_t c = 0; c < count; ++c)
        if (!(size_of(set, c, moved) >= least_size * size_of(set, c, y))) cells.push_back(std::uint32_t(c));
    return cells;
}

Eigen::Index Patch::place_of(std::uint32_t vertex) const
{
    const auto at = std::lower_bound(vertices.begin(), vertices.end(), vertex);
    return at != vertices.end() && *at == vertex ? 3 * (at - vertices.begin()) : -1;
}

LocalProblem::LocalProblem(const Energy& energy, const NormalizedPoses& set, const Weights& w, const Patch& patch)
    : energy_(energy)
    , set_(set)
    , w_(w)
    , patch_(patch)
{
}

Eigen::VectorXd LocalProblem::gather(const Shape& y) const
{
    Eigen::VectorXd out(3 * Eigen::Index(patch_.vertices.size()));
    for (std::size_t i = 0; i < patch_.vertices.size(); ++i)
        out.segment<3>(3 * Eigen::Index(i)) = y.segment<3>(3 * Eigen::Index(patch_.vertices[i]));
    return out;
}

void LocalProblem::scatter(const Eigen::VectorXd& coordinates, Shape& y) const
{
    for (std::size_t i = 0; i < patch_.vertices.size(); ++i)
        y.segment<3>(3 * Eigen::Index(patch_.vertices[i])) = coordinates.segment<3>(3 * Eigen::Index(i));
}

Eigen::VectorXd LocalProblem::sizes(const Shape& y) const
{
    Eigen::VectorXd out(Eigen::Index(patch_.cells.size()));
    for (std::size_t i = 0; i < patch_.cells.size(); ++i) out[Eigen::Index(i)] = size_of(set_, patch_.cells[i], y);
    return out;
}

bool LocalProblem::collapses(const Eigen::VectorXd& before, const Shape& y) const
{
    return !(sizes(y).array() >= least_size * before.array()).all();
}

bool LocalProblem::smooth(const Shape& before, Shape& y) const
{
    const Eigen::VectorXd start = gather(before), end = gather(y);
    const Eigen::Index count = Eigen::Index(patch_.vertices.size());
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(count, 3);
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
        const Eigen::Index row = patch_.place_of(a) / 3, column = patch_.place_of(b);
        entries.emplace_back(row, row, 1.0);
        if (column >= 0)
            entries.emplace_back(row, column / 3, -1.0);
        else
            right.row(row) += (point(y, b) - point(before, b)).transpose();
    };
    const auto add = [&](const auto& corners) {
        for (const std::uint32_t a : corners)
            for (const std::uint32_t b : corners)
                if (a != b && patch_.place_of(a) >= 0) join(a, b);
    };
    for (const std::uint32_t c : patch_.cells) set_.is_solid() ? add(set_.tets[c]) : add(set_.triangles[c]);
    Eigen::SparseMatrix<double> laplacian(count, count);
    laplacian.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor(laplacian);
    if (factor.info() != Eigen::Success) return false; // nothing around it is held
    const Eigen::Matrix3Xd moves = factor.solve(right).transpose();
    scatter(start + Eigen::Map<const Eigen::VectorXd>(moves.data(), moves.size()), y);
    if (!collapses(sizes(before), y)) return true;
    scatter(end, y);
    return false;
}

template <class Visit> double LocalProblem::evaluate(const Shape& y, Order order, Visit visit)
{
    double energy = 0;
    for (const std::uint32_t e : patch_.elements) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        x_.resize(3 * count);
        pliant::gather(vertices, count, y, x_.data());
        energy_.evaluate(e, w_.data(), x_.data(), order, HessianKind::projected, result_);
        energy += result_.value;
        visit(vertices, count);
    }
    return energy;
}

// Fills the gradient and the Hessian at y; returns the energy.
double LocalProblem::assemble(const Shape& y)
{
    const Eigen::Index dof_count = 3 * Eigen::Index(patch_.vertices.size());
    gradient_.setZero(dof_count);
    std::vector<Eigen::Triplet<double>> entries;
    const auto add_block = [&](Eigen::Index row, Eigen::Index column, Eigen::Index i, Eigen::Index j) {
        for (Eigen::Index c = 0; c < 3; ++c)
            for (Eigen::Index r = row == column ? c : 0; r < 3; ++r)
                entries.emplace_back(row + r, column + c, result_.hessian(3 * i + r, 3 * j + c));
    };
    const double energy = evaluate(y, Order::hessian, [&](const std::uint32_t* vertices, std::size_t count) {
        for (std::size_t j = 0; j < count; ++j) {
            const Eigen::Index column = patch_.place_of(vertices[j]);
            if (column < 0) continue;
            gradient_.segment<3>(column) += result_.gradient.segment<3>(3 * Eigen::Index(j));
            for (std::size_t i = 0; i < count; ++i)
                if (const Eigen::Index row = patch_.place_of(vertices[i]); row >= column)
                    add_block(row, column, Eigen::Index(i), Eigen::Index(j));
        }
    });
    hessian_.resize(dof_count, dof_count);
    hessian_.setFromTriplets(entries.begin(), entries.end());
    return energy;
}

// Goes along the step as far as that collapses no cell and lowers the energy. False: nowhere.
bool LocalProblem::advance(const Eigen::VectorXd& step, double slope, double energy, Shape& y)
{
    const Eigen::VectorXd start = gather(y), old_sizes = sizes(y);
    for (double length = 1; length > shortest_local_length; length /= 2) {
        scatter(start + length * step, y);
        if (!energy_.allows_collapse() && collapses(old_sizes, y)) continue;
        const double lower = evaluate(y, Order::value, [](const std::uint32_t*, std::size_t) {});
        if (lower <= energy + 1e-4 * length * slope) return true;
    }
    scatter(start, y);
    return false;
}

void LocalProblem::minimize(Shape& y)
{
    for (int i = 0; i < local_iteration_limit; ++i) {
        const double energy = assemble(y);
        factor_.compute(hessian_);
        if (factor_.info() != Eigen::Success) return;
        const Eigen::VectorXd step = -factor_.solve(gradient_);
        const double slope = gradient_.dot(step);
        if (!(slope < -least_decrease * energy) || !advance(step, slope, energy, y)) return;
    }
}

} // namespace pliant
