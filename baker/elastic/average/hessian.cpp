#include "elastic/average/hessian.h"

#include <algorithm>

namespace pliant {

HessianAssembler::HessianAssembler(const Energy& energy)
    : energy_(energy)
{
    const std::size_t n = std::size_t(energy.dof_count() / 3);
    std::vector<std::vector<std::uint32_t>> below(n);
    for (std::size_t v = 0; v < n; ++v) below[v].push_back(std::uint32_t(v));
    for (std::size_t e = 0; e < energy.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy.element_vertices(e, count);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                if (vertices[i] > vertices[j]) below[vertices[j]].push_back(vertices[i]);
    }
    starts_.push_back(0);
    for (auto& rows : below) {
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        rows_.insert(rows_.end(), rows.begin(), rows.end());
        starts_.push_back(std::int64_t(rows_.size()));
    }

    // Column 3v + c holds rows c..2 of the diagonal block, then the full blocks below it.
    matrix_.resize(energy.dof_count(), energy.dof_count());
    matrix_.resizeNonZeros(std::int64_t(9 * rows_.size()) - std::int64_t(3 * n));
    std::int64_t position = 0;
    for (std::size_t v = 0; v < n; ++v)
        for (int c = 0; c < 3; ++c) {
            matrix_.outerIndexPtr()[3 * v + std::size_t(c)] = position;
            for (std::int64_t i = starts_[v]; i < starts_[v + 1]; ++i)
                for (int r = i == starts_[v] ? c : 0; r < 3; ++r)
                    matrix_.innerIndexPtr()[position++] = 3 * std::int64_t(rows_[std::size_t(i)]) + r;
        }
    matrix_.outerIndexPtr()[3 * n] = position;
}

// Where entry (0, c) of the block of two vertices lies is returned + stride[c]; for diagonal blocks only rows >= c exist.
double* HessianAssembler::block(std::uint32_t row_vertex, std::uint32_t column_vertex, std::int64_t stride[3])
{
    const auto first = rows_.begin() + starts_[column_vertex], last = rows_.begin() + starts_[column_vertex + 1];
    const std::int64_t place = std::lower_bound(first, last, row_vertex) - first;
    for (int c = 0; c < 3; ++c) stride[c] = matrix_.outerIndexPtr()[3 * std::int64_t(column_vertex) + c] + 3 * place - c;
    return matrix_.valuePtr();
}

void HessianAssembler::assemble(const Weights& w, const Shape& y, HessianKind kind)
{
    std::fill(matrix_.valuePtr(), matrix_.valuePtr() + matrix_.nonZeros(), 0.0);
    ElementResult result;
    std::vector<double> x;
    for (std::size_t e = 0; e < energy_.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        x.resize(3 * count);
        gather(vertices, count, y, x.data());
        energy_.evaluate(e, w.data(), x.data(), Order::hessian, kind, result);
        for (std::size_t j = 0; j < count; ++j)
            for (std::size_t i = 0; i < count; ++i) {
                if (vertices[i] < vertices[j]) continue;
                std::int64_t offset[3];
                double* values = block(vertices[i], vertices[j], offset);
                for (int c = 0; c < 3; ++c)
                    for (int r = i == j ? c : 0; r < 3; ++r)
                        values[offset[c] + r] += result.hessian(Eigen::Index(3 * i) + r, Eigen::Index(3 * j) + c);
            }
    }
}

void pin(SparseLower& matrix, const std::vector<Eigen::Index>& dofs)
{
    std::vector<char> is_pinned(std::size_t(matrix.cols()), 0);
    for (Eigen::Index dof : dofs) is_pinned[std::size_t(dof)] = 1;
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
        for (SparseLower::InnerIterator it(matrix, column); it; ++it)
            if (is_pinned[std::size_t(column)] || is_pinned[std::size_t(it.row())])
                it.valueRef() = it.row() == column ? 1.0 : 0.0;
}

} // namespace pliant
