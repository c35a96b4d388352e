#include "elastic/average/restraint.h"

#include "base/mesh/surface.h"
#include "base/mesh/tets.h"

#include <Eigen/SparseCholesky>
#include <algorithm>

namespace pliant {

namespace {

// Beyond a collapsed cell the quadratic model says nothing, and energies that are finite for collapsed cells would let them
// collapse.
constexpr double least_size = 0.2;

double& diagonal(SparseLower& matrix, Eigen::Index i) { return matrix.valuePtr()[matrix.outerIndexPtr()[i]]; }

// Edges from a stiffened cell within which the step is found again.
constexpr int ring_count = 4;

// `pull`: minus the forces of the new springs after the step is added to it.
template <std::size_t Corners>
void stiffen_cell(SparseLower& hessian, const std::array<std::uint32_t, Corners>& cell, double share, const Shape& step,
                  Shape& pull)
{
    double stiffness = 0;
    for (const std::uint32_t v : cell)
        for (int c = 0; c < 3; ++c) stiffness = std::max(stiffness, share * diagonal(hessian, 3 * Eigen::Index(v) + c));
    for (std::size_t i = 0; i < Corners; ++i)
        for (std::size_t j = 0; j < i; ++j)
            for (int c = 0; c < 3; ++c) {
                const Eigen::Index a = 3 * Eigen::Index(cell[i]) + c, b = 3 * Eigen::Index(cell[j]) + c;
                diagonal(hessian, a) += stiffness;
                diagonal(hessian, b) += stiffness;
                hessian.coeffRef(std::max(a, b), std::min(a, b)) -= stiffness;
                pull[a] -= stiffness * (step[a] - step[b]);
                pull[b] += stiffness * (step[a] - step[b]);
            }
}

// Marks the corners of all cells that have a marked one.
template <std::size_t Corners>
void grow(const std::vector<std::array<std::uint32_t, Corners>>& cells, std::vector<bool>& is_marked)
{
    const std::vector<bool> before = is_marked;
    for (const auto& cell : cells)
        if (std::any_of(cell.begin(), cell.end(), [&](std::uint32_t v) { return before[v]; }))
            for (const std::uint32_t v : cell) is_marked[v] = true;
}

// The degrees of freedom near the cells, ascending.
template <std::size_t Corners>
std::vector<Eigen::Index> dofs_near(const std::vector<std::array<std::uint32_t, Corners>>& all,
                                    const std::vector<std::uint32_t>& cells, const std::vector<Eigen::Index>& pins,
                                    std::size_t vertex_count)
{
    std::vector<bool> is_near(vertex_count);
    for (const std::uint32_t c : cells)
        for (const std::uint32_t v : all[c]) is_near[v] = true;
    for (int ring = 0; ring < ring_count; ++ring) grow(all, is_near);
    std::vector<bool> is_pinned(3 * vertex_count);
    for (const Eigen::Index i : pins) is_pinned[std::size_t(i)] = true;
    std::vector<Eigen::Index> dofs;
    for (std::size_t i = 0; i < is_pinned.size(); ++i)
        if (is_near[i / 3] && !is_pinned[i]) dofs.push_back(Eigen::Index(i));
    return dofs;
}

// Rows and columns of these degrees of freedom, which ascend.
SparseLower block_of(const SparseLower& matrix, const std::vector<Eigen::Index>& dofs)
{
    std::vector<Eigen::Index> place(std::size_t(matrix.cols()), -1);
    for (std::size_t i = 0; i < dofs.size(); ++i) place[std::size_t(dofs[i])] = Eigen::Index(i);
    std::vector<Eigen::Triplet<double, std::int64_t>> entries;
    for (std::size_t j = 0; j < dofs.size(); ++j)
        for (SparseLower::InnerIterator entry(matrix, dofs[j]); entry; ++entry)
            if (place[std::size_t(entry.row())] >= 0)
                entries.emplace_back(place[std::size_t(entry.row())], Eigen::Index(j), entry.value());
    SparseLower block(Eigen::Index(dofs.size()), Eigen::Index(dofs.size()));
    block.setFromTriplets(entries.begin(), entries.end());
    return block;
}

template <std::size_t Corners>
void restrain_cells(SparseLower& hessian, const std::vector<std::array<std::uint32_t, Corners>>& all,
                    const std::vector<std::uint32_t>& cells, double share, const std::vector<Eigen::Index>& pins,
                    Shape& step)
{
    Shape pull = Shape::Zero(step.size());
    for (const std::uint32_t c : cells) stiffen_cell(hessian, all[c], share, step, pull);
    const std::vector<Eigen::Index> dofs = dofs_near(all, cells, pins, std::size_t(step.size() / 3));
    const Eigen::SimplicialLLT<SparseLower, Eigen::Lower, Eigen::AMDOrdering<std::int64_t>> factor(block_of(hessian, dofs));
    if (factor.info() == Eigen::Success) step(dofs) += factor.solve(Eigen::VectorXd(pull(dofs)));
}

} // namespace

std::vector<std::uint32_t> collapsing_cells(const NormalizedPoses& set, const Shape& y, const Shape& moved)
{
    std::vector<std::uint32_t> cells;
    for (std::size_t c = 0; c < set.tets.size(); ++c) {
        const double before = tet_edges(y, set.tets[c]).determinant(), after = tet_edges(moved, set.tets[c]).determinant();
        if (!(after >= least_size * before)) cells.push_back(std::uint32_t(c));
    }
    if (set.is_solid()) return cells;
    for (std::size_t c = 0; c < set.triangles.size(); ++c) {
        const double before = double_area_vector(y, set.triangles[c]).norm();
        const double after = double_area_vector(moved, set.triangles[c]).norm();
        if (!(after >= least_size * before)) cells.push_back(std::uint32_t(c));
    }
    return cells;
}

void restrain(SparseLower& hessian, const NormalizedPoses& set, const std::vector<std::uint32_t>& cells, double share,
              const std::vector<Eigen::Index>& pins, Shape& step)
{
    if (set.is_solid())
        restrain_cells(hessian, set.tets, cells, share, pins, step);
    else
        restrain_cells(hessian, set.triangles, cells, share, pins, step);
}

} // namespace pliant
