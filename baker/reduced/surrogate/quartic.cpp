#include "reduced/surrogate/quartic.h"

#include "base/common/parallel.h"

#include <algorithm>
#include <array>

namespace pliant {

namespace {

// Tetrahedra whose rows go into one symmetric update: long enough to be a matrix product, short enough for the cache.
constexpr std::size_t block_size = 64;

// Sums over the mesh are made in this many parts, which may run on threads; each part holds matrices of its own.
constexpr std::size_t part_count = 4;

Eigen::Index pair_count(Eigen::Index n) { return n * (n + 1) / 2; }

// The metric of one tetrahedron's edges as a linear function of the pairs (6 x pairs).
void metric_rows(const Tetrahedron& tet, const Subspace& subspace, Eigen::MatrixXd& rows)
{
    const Eigen::Index n = subspace.dimension() + 1;
    std::array<Eigen::Matrix3Xd, 3> edges; // of x: 3 x n
    for (int i = 0; i < 3; ++i) {
        const Eigen::Index from = 3 * Eigen::Index(tet[0]), to = 3 * Eigen::Index(tet[std::size_t(i) + 1]);
        edges[std::size_t(i)].resize(3, n);
        edges[std::size_t(i)].col(0) = subspace.rest.segment<3>(to) - subspace.rest.segment<3>(from);
        edges[std::size_t(i)].rightCols(n - 1) = subspace.basis.middleRows<3>(to) - subspace.basis.middleRows<3>(from);
    }
    Eigen::Index component = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j, ++component) {
            const Eigen::MatrixXd product = edges[i].transpose() * edges[j];
            Eigen::Index t = 0;
            for (Eigen::Index a = 0; a < n; ++a)
                for (Eigen::Index b = a; b < n; ++b, ++t)
                    rows(component, t) = a == b ? product(a, a) : product(a, b) + product(b, a);
        }
}

// The products x_a x_b.
Eigen::VectorXd pairs_of(const Eigen::VectorXd& x)
{
    Eigen::VectorXd pairs(pair_count(x.size()));
    Eigen::Index t = 0;
    for (Eigen::Index a = 0; a < x.size(); ++a)
        for (Eigen::Index b = a; b < x.size(); ++b) pairs[t++] = x[a] * x[b];
    return pairs;
}

// Their derivatives by the coordinates, which are x without its first entry (pairs x d).
Eigen::MatrixXd pair_derivatives(const Eigen::VectorXd& x)
{
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(pair_count(x.size()), x.size());
    Eigen::Index t = 0;
    for (Eigen::Index a = 0; a < x.size(); ++a)
        for (Eigen::Index b = a; b < x.size(); ++b, ++t) {
            out(t, a) += x[b];
            out(t, b) += x[a];
        }
    return out.rightCols(x.size() - 1);
}

Eigen::VectorXd homogeneous(const Eigen::VectorXd& q)
{
    Eigen::VectorXd x(q.size() + 1);
    x << 1, q;
    return x;
}

} // namespace

Quartic::Quartic(const Solid& solid, const Subspace& subspace, Progress* progress)
    : dimension_(subspace.dimension())
{
    const std::size_t m = solid.pose_count(), count = solid.element_count();
    const Eigen::Index pairs = pair_count(dimension_ + 1);
    std::vector<std::vector<Eigen::MatrixXd>> parts(part_count);
    SharedProgress shared(progress);
    shared.describe("quartic", 0, "");
    for_each_task(part_count, [&](std::size_t part, std::size_t) {
        parts[part].assign(m, Eigen::MatrixXd::Zero(pairs, pairs));
        std::vector<Eigen::MatrixXd> blocks(m, Eigen::MatrixXd(pairs, 6 * Eigen::Index(block_size)));
        Eigen::MatrixXd metric(6, pairs);
        const std::size_t end = count * (part + 1) / part_count;
        for (std::size_t begin = count * part / part_count; begin < end; begin += block_size) {
            shared.update("", 0);
            const std::size_t size = std::min(block_size, end - begin);
            for (std::size_t i = 0; i < size; ++i) {
                std::size_t corners = 0;
                const std::uint32_t* v = solid.element_vertices(begin + i, corners);
                metric_rows({ v[0], v[1], v[2], v[3] }, subspace, metric);
                const Eigen::Matrix<double, 6, 1> constant = metric.col(0);
                for (std::size_t k = 0; k < m; ++k) {
                    metric.col(0) = constant - solid.rest_metric(begin + i, k);
                    blocks[k].middleCols<6>(6 * Eigen::Index(i)) = (solid.quadratic_root(begin + i, k) * metric).transpose();
                }
            }
            for (std::size_t k = 0; k < m; ++k)
                parts[part][k].selfadjointView<Eigen::Lower>().rankUpdate(blocks[k].leftCols(6 * Eigen::Index(size)));
        }
    });
    for (std::size_t k = 0; k < m; ++k) {
        Eigen::MatrixXd sum = parts[0][k];
        for (std::size_t part = 1; part < part_count; ++part) sum += parts[part][k];
        matrices_.push_back(sum.selfadjointView<Eigen::Lower>());
    }
}

Quartic Quartic::leading(Eigen::Index dimension) const
{
    const Eigen::Index from = dimension_ + 1, to = dimension + 1;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index a = 0; a < to; ++a)
        for (Eigen::Index b = a; b < to; ++b) kept.push_back(pair_index(a, b, from));
    Quartic out;
    out.dimension_ = dimension;
    for (const Eigen::MatrixXd& matrix : matrices_) out.matrices_.push_back(matrix(kept, kept));
    return out;
}

// Of pose k stiffness |along q - wanted_k|^2. The first N pairs are those of x_0 = 1 with x.
void Quartic::hold(const Eigen::MatrixXd& along, const Eigen::MatrixXd& wanted, double stiffness)
{
    Eigen::MatrixXd off(along.rows(), dimension_ + 1);
    off.rightCols(dimension_) = along;
    for (std::size_t k = 0; k < matrices_.size(); ++k) {
        off.col(0) = -wanted.col(Eigen::Index(k));
        matrices_[k].topLeftCorner(off.cols(), off.cols()) += stiffness * off.transpose() * off;
    }
}

Quartic Quartic::transformed(const Eigen::VectorXd& mean, const Eigen::MatrixXd& whitening) const
{
    const Eigen::Index n = dimension_ + 1;
    Eigen::MatrixXd t = Eigen::MatrixXd::Zero(n, n); // x = t (1, z)
    t(0, 0) = 1;
    t.col(0).tail(dimension_) = mean;
    t.bottomRightCorner(dimension_, dimension_) = whitening;
    Eigen::MatrixXd pairs(pair_count(n), pair_count(n)); // old pairs of new ones
    for (Eigen::Index a = 0, row = 0; a < n; ++a)
        for (Eigen::Index b = a; b < n; ++b, ++row)
            for (Eigen::Index c = 0, column = 0; c < n; ++c)
                for (Eigen::Index e = c; e < n; ++e, ++column)
                    pairs(row, column) = c == e ? t(a, c) * t(b, c) : t(a, c) * t(b, e) + t(a, e) * t(b, c);
    Quartic out;
    out.dimension_ = dimension_;
    for (const Eigen::MatrixXd& matrix : matrices_) {
        const Eigen::MatrixXd product = matrix * pairs;
        out.matrices_.push_back(pairs.transpose() * product);
    }
    return out;
}

Eigen::MatrixXd Quartic::combined(const Eigen::VectorXd& w) const
{
    Eigen::MatrixXd sum = w[0] * matrices_[0];
    for (std::size_t k = 1; k < matrices_.size(); ++k) sum += w[Eigen::Index(k)] * matrices_[k];
    return sum;
}

double Quartic::value(const Eigen::VectorXd& w, const Eigen::VectorXd& q) const
{
    const Eigen::VectorXd p = pairs_of(homogeneous(q));
    double sum = 0;
    for (std::size_t k = 0; k < matrices_.size(); ++k)
        if (w[Eigen::Index(k)] != 0) sum += w[Eigen::Index(k)] * p.dot(matrices_[k] * p);
    return sum;
}

double Quartic::gradient(const Eigen::VectorXd& w, const Eigen::VectorXd& q, Eigen::VectorXd& gradient) const
{
    const Eigen::VectorXd x = homogeneous(q), p = pairs_of(x);
    Eigen::VectorXd y = Eigen::VectorXd::Zero(p.size());
    for (std::size_t k = 0; k < matrices_.size(); ++k)
        if (w[Eigen::Index(k)] != 0) y += w[Eigen::Index(k)] * (matrices_[k] * p);
    gradient.setZero(dimension_);
    for (Eigen::Index a = 0, t = 0; a < x.size(); ++a)
        for (Eigen::Index b = a; b < x.size(); ++b, ++t) {
            if (a > 0) gradient[a - 1] += 2 * y[t] * x[b];
            if (b > 0) gradient[b - 1] += 2 * y[t] * x[a];
        }
    return p.dot(y);
}

Eigen::MatrixXd Quartic::hessian(const Eigen::VectorXd& w, const Eigen::VectorXd& q) const
{
    const Eigen::VectorXd x = homogeneous(q), p = pairs_of(x);
    const Eigen::MatrixXd matrix = combined(w), d = pair_derivatives(x), product = matrix * d;
    const Eigen::VectorXd y = matrix * p;
    Eigen::MatrixXd h = 2 * d.transpose() * product;
    for (Eigen::Index a = 1; a < x.size(); ++a)
        for (Eigen::Index b = a; b < x.size(); ++b) {
            h(a - 1, b - 1) += 2 * y[pair_index(a, b, x.size())];
            h(b - 1, a - 1) += 2 * y[pair_index(a, b, x.size())];
        }
    return 0.5 * (h + h.transpose());
}

Eigen::VectorXd Quartic::coefficients(std::size_t pose) const
{
    const Eigen::Index n = dimension_ + 1, pairs = pair_count(n), padded = (pairs + 7) / 8 * 8;
    // Where the row of (i, j) begins, less what it lacks of the pairs before it.
    std::vector<Eigen::Index> starts(static_cast<std::size_t>(pairs));
    Eigen::Index size = 0;
    for (Eigen::Index j = 0; j < n; ++j) {
        const Eigen::Index skipped = pair_index(j, j, n) / 8 * 8;
        for (Eigen::Index i = 0; i <= j; ++i) {
            starts[std::size_t(pair_index(i, j, n))] = size - skipped;
            size += padded - skipped;
        }
    }
    Eigen::VectorXd out = Eigen::VectorXd::Zero(size);
    const Eigen::MatrixXd& matrix = matrices_[pose];
    std::vector<std::array<Eigen::Index, 2>> members;
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = a; b < n; ++b) members.push_back({ a, b });
    for (Eigen::Index s = 0; s < pairs; ++s)
        for (Eigen::Index t = 0; t < pairs; ++t) {
            if (s == 0 && t == 0) continue; // the constant
            std::array<Eigen::Index, 4> m = { members[std::size_t(s)][0], members[std::size_t(s)][1],
                                              members[std::size_t(t)][0], members[std::size_t(t)][1] };
            std::sort(m.begin(), m.end());
            out[starts[std::size_t(pair_index(m[0], m[1], n))] + pair_index(m[2], m[3], n)] += matrix(s, t);
        }
    return out;
}

} // namespace pliant
