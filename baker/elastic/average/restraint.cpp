#include "elastic/average/restraint.h"

#include "base/mesh/surface.h"
#include "base/mesh/tets.h"

#include <algorithm>

namespace pliant {

namespace {

// Beyond a collapsed cell the quadratic model says nothing, and energies that are finite for collapsed cells would let them
// collapse.
constexpr double least_size = 0.2;

double& diagonal(SparseLower& matrix, Eigen::Index i) { return matrix.valuePtr()[matrix.outerIndexPtr()[i]]; }

template <std::size_t Corners>
void stiffen_cell(SparseLower& hessian, const std::array<std::uint32_t, Corners>& cell, double share)
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
            }
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

void stiffen(SparseLower& hessian, const NormalizedPoses& set, const std::vector<std::uint32_t>& cells, double share)
{
    for (const std::uint32_t c : cells)
        if (set.is_solid())
            stiffen_cell(hessian, set.tets[c], share);
        else
            stiffen_cell(hessian, set.triangles[c], share);
}

} // namespace pliant
