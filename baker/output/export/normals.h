// Normals of shapes as linear functions of morph weights: n(w) = base + sum_j w_j delta_j, to be brought to unit length.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace pliant {

// Unit normals (3n) of positions (3n): the area-weighted sums of the adjacent triangles' normals; zero where a vertex has
// none. groups: one number a vertex, and vertices of the same number share their normal; empty: each has its own.
Eigen::VectorXd vertex_normals(const Eigen::VectorXd& positions, const std::vector<std::uint32_t>& triangles,
                               const std::vector<std::uint32_t>& groups = {});

// Gathers normals at sampled weights, then fits. Memory: 3n (d+1) doubles.
class NormalFit {
public:
    NormalFit(std::size_t vertex_count, Eigen::Index target_count);

    // `weights` (d x shapes) and the normals (3n x shapes) that go with them; many at once are quicker.
    void add(const Eigen::MatrixXd& weights, const Eigen::MatrixXd& normals);

    struct Result {
        Eigen::VectorXd base;   // 3n, unit vectors
        Eigen::MatrixXd deltas; // 3n x d, scaled along with their vertex's base: only directions count
    };
    // Least squares over what was added. Cost: O(n d^2).
    Result solve() const;

private:
    Eigen::MatrixXd gram_;   // (d+1) x (d+1) of (1, w)
    Eigen::MatrixXd moment_; // 3n x (d+1)
    double count_ = 0;
};

// Angles between fitted and recomputed normals.
struct NormalError {
    double mean_degrees = 0, worst_degrees = 0;
    double percentile_degrees = 0; // 99.9 % are below, to a hundredth of a degree
};

// Collects the angles of many shapes.
class NormalErrorMeter {
public:
    void add(const NormalFit::Result& fit, const Eigen::VectorXd& weights, const Eigen::VectorXd& normals);
    NormalError error() const;

private:
    std::vector<std::uint64_t> histogram_ = std::vector<std::uint64_t>(18001); // of hundredths of a degree
    double sum_ = 0, worst_ = 0;
    std::uint64_t count_ = 0;
};

} // namespace pliant
