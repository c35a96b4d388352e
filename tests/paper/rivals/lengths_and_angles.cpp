#include "face_motions.h"
#include "rival.h"

#include "elastic/average/sparse_cholesky.h"
#include "elastic/energy/hinge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace pliant {

namespace {

using Eigen::Index;
using Edge = std::array<std::uint32_t, 2>;

// Froehlich and Botsch: lengths count by the square of what they differ by over the length, angles by length^2 / area.
constexpr double length_weight = 100, angle_weight = 1;

constexpr double turn = 2 * 3.14159265358979323846;

// Levenberg's parameter, of the mean of the diagonal, which also holds the rigid motions.
constexpr double first_damping = 1e-6, least_damping = 1e-9, most_damping = 1e6;
constexpr int iteration_limit = 300;
constexpr double enough = 1e-9; // relative decrease of the sum of squares

std::vector<Edge> edges_of_mesh(const std::vector<Triangle>& triangles)
{
    std::set<Edge> edges;
    for (const Triangle& t : triangles)
        for (int i = 0; i < 3; ++i)
            edges.insert({ std::min(t[std::size_t(i)], t[std::size_t(i + 1) % 3]),
                           std::max(t[std::size_t(i)], t[std::size_t(i + 1) % 3]) });
    return { edges.begin(), edges.end() };
}

double length_of(const Shape& y, const Edge& edge) { return (point(y, edge[1]) - point(y, edge[0])).norm(); }

double angle_of(const Shape& y, const Hinge& hinge)
{
    const auto& v = hinge.vertices;
    return hinge_angle(point(y, v[0]), point(y, v[1]), point(y, v[2]), point(y, v[3]));
}

// The same angle, with as many full turns as bring it nearest to another.
double near(double angle, double other) { return angle - turn * std::round((angle - other) / turn); }

class LengthsAndAngles final : public Rival {
public:
    explicit LengthsAndAngles(const NormalizedPoses& set)
        : set_(set)
        , edges_(edges_of_mesh(set.triangles))
        , hinges_(find_hinges(set.triangles, set.shapes[0]))
        , normal_equations_(default_solver())
    {
    }
    const RivalTraits& traits() const override
    {
        static const RivalTraits traits { "lengths and angles", "Winkler et al. 2010, Froehlich and Botsch 2011", true, true,
                                          "small triangles fold" };
        return traits;
    }
    Shape blend(const Weights& w) override
    {
        aim(w);
        Index nearest = 0;
        w.maxCoeff(&nearest);
        Shape y = set_.shapes[std::size_t(nearest)];
        double damping = first_damping, value = residuals(y).squaredNorm();
        for (int i = 0; i < iteration_limit && damping < most_damping && value > 1e-24; ++i) {
            const Shape next = y + step(y, damping);
            const double lower = residuals(next).squaredNorm();
            if (!(lower < value)) {
                damping *= 10;
                continue;
            }
            const bool is_done = value - lower < enough * value;
            y = next;
            value = lower;
            damping = std::max(least_damping, damping / 10);
            if (is_done) break;
        }
        return y;
    }

private:
    // Wanted lengths and angles, and their weights: edges first, then hinges.
    void aim(const Weights& w)
    {
        wanted_ = scale_ = Eigen::VectorXd::Zero(Index(edges_.size() + hinges_.size()));
        Eigen::VectorXd areas = Eigen::VectorXd::Zero(Index(set_.triangles.size()));
        for (std::size_t k = 0; k < set_.pose_count(); ++k) {
            const double share = w[Index(k)];
            areas += share * triangle_areas(set_.shapes[k], set_.triangles);
            for (std::size_t i = 0; i < edges_.size(); ++i)
                wanted_[Index(i)] += share * length_of(set_.shapes[k], edges_[i]);
            for (std::size_t i = 0; i < hinges_.size(); ++i)
                wanted_[Index(edges_.size() + i)]
                    += share * near(angle_of(set_.shapes[k], hinges_[i]), angle_of(set_.shapes[0], hinges_[i]));
        }
        for (std::size_t i = 0; i < edges_.size(); ++i) scale_[Index(i)] = std::sqrt(length_weight) / wanted_[Index(i)];
        for (std::size_t i = 0; i < hinges_.size(); ++i) {
            const Hinge& hinge = hinges_[i];
            double length = 0;
            for (std::size_t k = 0; k < set_.pose_count(); ++k)
                length += w[Index(k)] * length_of(set_.shapes[k], { hinge.vertices[0], hinge.vertices[1] });
            scale_[Index(edges_.size() + i)]
                = std::sqrt(angle_weight / (areas[hinge.faces[0]] + areas[hinge.faces[1]])) * length;
        }
    }

    Eigen::VectorXd residuals(const Shape& y) const
    {
        Eigen::VectorXd r(wanted_.size());
        for (std::size_t i = 0; i < edges_.size(); ++i) r[Index(i)] = length_of(y, edges_[i]) - wanted_[Index(i)];
        for (std::size_t i = 0; i < hinges_.size(); ++i) {
            const Index row = Index(edges_.size() + i);
            r[row] = near(angle_of(y, hinges_[i]), wanted_[row]) - wanted_[row];
        }
        return r.cwiseProduct(scale_);
    }

    // -(J^T J + damping)^-1 J^T r.
    Shape step(const Shape& y, double damping)
    {
        const Eigen::VectorXd r = residuals(y);
        std::vector<Eigen::Triplet<double, std::int64_t>> entries;
        Shape right = Shape::Zero(y.size());
        const auto add = [&](const std::uint32_t* vertices, Index count, const Eigen::VectorXd& row, double residual) {
            const auto dof = [&](Index i) { return 3 * std::int64_t(vertices[i / 3]) + i % 3; };
            for (Index i = 0; i < 3 * count; ++i) {
                right[dof(i)] -= row[i] * residual;
                for (Index j = 0; j < 3 * count; ++j)
                    if (dof(i) >= dof(j)) entries.emplace_back(dof(i), dof(j), row[i] * row[j]);
            }
        };
        for (std::size_t i = 0; i < edges_.size(); ++i) {
            const Eigen::Vector3d along = (point(y, edges_[i][1]) - point(y, edges_[i][0])).normalized();
            Eigen::VectorXd row(6);
            row << -along, along;
            add(edges_[i].data(), 2, scale_[Index(i)] * row, r[Index(i)]);
        }
        for (std::size_t i = 0; i < hinges_.size(); ++i) {
            const auto& v = hinges_[i].vertices;
            const Index row = Index(edges_.size() + i);
            Vector12 gradient;
            hinge_angle(point(y, v[0]), point(y, v[1]), point(y, v[2]), point(y, v[3]), &gradient, nullptr);
            add(v.data(), 4, scale_[row] * gradient, r[row]);
        }
        SparseLower matrix(y.size(), y.size());
        matrix.setFromTriplets(entries.begin(), entries.end());
        const double shift = damping * matrix.diagonal().mean();
        for (Index i = 0; i < y.size(); ++i) matrix.coeffRef(i, i) += shift;
        if (!normal_equations_.factorize(matrix)) throw std::runtime_error("the normal equations are singular");
        return normal_equations_.solve(right);
    }

    const NormalizedPoses& set_;
    std::vector<Edge> edges_;
    std::vector<Hinge> hinges_;
    SparseCholesky normal_equations_;
    Eigen::VectorXd wanted_, scale_;
};

} // namespace

std::unique_ptr<Rival> make_lengths_and_angles(const NormalizedPoses& set)
{
    return std::make_unique<LengthsAndAngles>(set);
}

} // namespace pliant
