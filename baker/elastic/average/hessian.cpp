#include "elastic/average/hessian.h"

#include <algorithm>

namespace pliant {

namespace {

// Calls visit(i, j) for the blocks of an element in the lower triangle: row vertex i, column vertex j.
template <class Visit> void for_each_block(const std::uint32_t* vertices, std::size_t count, Visit visit)
{
    for (std::size_t j = 0; j < count; ++j)
        for (std::size_t i = 0; i < count; ++i)
            if (vertices[i] >= vertices[j]) visit(i, j);
}

} // namespace

HessianAssembler::HessianAssembler(const Energy& energy)
    : energy_(energy)
{
    make_pattern();
    find_places();
}

void HessianAssembler::make_pattern()
{
    const std::size_t n = std::size_t(energy_.dof_count() / 3);
    std::vector<std::vector<std::uint32_t>> below(n);
    for (std::size_t v = 0; v < n; ++v) below[v].push_back(std::uint32_t(v));
    for (std::size_t e = 0; e < energy_.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        for_each_block(vertices, count, [&](std::size_t i, std::size_t j) {
            if (i != j) below[vertices[j]].push_back(vertices[i]);
        });
    }
    starts_.push_back(0);
    for (auto& rows : below) {
        std::sort(rows.begin(), rows.end());
        rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
        rows_.insert(rows_.end(), rows.begin(), rows.end());
        starts_.push_back(std::int64_t(rows_.size()));
    }

    // Column 3v + c holds rows c..2 of the diagonal block, then the full blocks below it.
    matrix_.resize(energy_.dof_count(), energy_.dof_count());
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

void HessianAssembler::find_places()
{
    for (std::size_t e = 0; e < energy_.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        for_each_block(vertices, count, [&](std::size_t i, std::size_t j) {
            const auto first = rows_.begin() + starts_[vertices[j]], last = rows_.begin() + starts_[vertices[j] + 1];
            places_.push_back(std::uint32_t(std::lower_bound(first, last, vertices[i]) - first));
        });
    }
}

void HessianAssembler::assemble(const Weights& w, const Shape& y, HessianKind kind)
{
    double* values = matrix_.valuePtr();
    std::fill(values, values + matrix_.nonZeros(), 0.0);
    ElementResult result;
    std::vector<double> x;
    auto place = places_.begin();
    for (std::size_t e = 0; e < energy_.element_count(); ++e) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        x.resize(3 * count);
        gather(vertices, count, y, x.data());
        energy_.evaluate(e, w.data(), x.data(), Order::hessian, kind, result);
        for_each_block(vertices, count, [&](std::size_t i, std::size_t j) {
            for (int c = 0; c < 3; ++c) {
                // Column c of a diagonal block starts with row c, and so do the columns of the blocks below it.
                double* column
                    = values + matrix_.outerIndexPtr()[3 * std::int64_t(vertices[j]) + c] + 3 * std::int64_t(*place) - c;
                for (int r = i == j ? c : 0; r < 3; ++r)
                    column[r] += result.hessian(Eigen::Index(3 * i) + r, Eigen::Index(3 * j) + c);
            }
            ++place;
        });
    }
}

Eigen::MatrixXd times_symmetric(const Eigen::MatrixXd& rows, const SparseLower& lower)
{
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(rows.rows(), rows.cols());
    for (Eigen::Index column = 0; column < lower.cols(); ++column)
        for (SparseLower::InnerIterator it(lower, column); it; ++it) {
            out.col(it.row()) += it.value() * rows.col(column);
            if (it.row() != column) out.col(column) += it.value() * rows.col(it.row());
        }
    return out;
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
