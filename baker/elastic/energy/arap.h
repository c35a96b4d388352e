// As-rigid-as-possible energy, "spokes and rims" (Sorkine, Alexa 2007; Chao, Pinkall, Sanan, Schroeder 2010):
//     W_k(y) = sum_cells min_R sum_{edges of cell} c |e(y) - R e(x_k)|^2,
// a cell being a vertex with the edges to its neighbours (spokes) and the edges opposite to it (rims), c in pose k: of a
// spoke (cot + cot)/2 of the angles opposite to it, of a rim cot/2 of the angle at the vertex. Never negative, though
// cotangents may be. Of layers: one such sum with the edges e(v) = e(x_0) + sum_k v_k (R_k^T e(x_k) - e(x_0)), R_k the
// rotation that brings the cell of pose 0 closest to that of pose k, and c in pose 0.
#pragma once

#include "base/mesh/align.h"
#include "base/mesh/fans.h"
#include "elastic/energy/energy.h"

namespace pliant {

// An element is the cell of a fan (base/mesh/fans.h): one for each vertex of a manifold.
class Arap final : public Energy {
public:
    explicit Arap(const NormalizedPoses& set, Blend blend = Blend::average);
    // Cells of these vertices only.
    Arap(const NormalizedPoses& set, const std::vector<bool>& is_centre, Blend blend = Blend::average);

    std::size_t pose_count() const override { return std::size_t(pose_count_); }
    Blend blend() const override { return blend_; }
    Eigen::Index dof_count() const override { return dof_count_; }
    std::size_t element_count() const override { return cells_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    bool allows_collapse() const override { return true; }
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

private:
    struct Edge {
        Eigen::Index tail, head; // local vertices: 0 is the centre, 1 + i neighbour i of the fan
    };
    struct Cell {
        std::vector<std::uint32_t> vertices;
        bool is_closed = false;
        Eigen::MatrixXd cotangents;   // edges x m
        Eigen::Matrix3Xd rest;        // the neighbours relative to the centre, pose after pose
        Eigen::VectorXd rest_inertia; // per pose: trace of the inertia of R at rest
        Eigen::Matrix3Xd moments;     // of the vertices, pose after pose: sum of +-c e(x_k) over the edges there

        Eigen::Index spoke_count() const { return Eigen::Index(vertices.size()) - 1; }
        Eigen::Index edge_count() const { return cotangents.rows(); }
        Edge edge(Eigen::Index number) const; // spokes, then rims
        Eigen::Vector3d rest_edge(Eigen::Index pose, const Edge& edge) const;
        void measure(); // rest_inertia and moments from the rest
        auto moment(Eigen::Index pose, Eigen::Index v) const { return moments.col(pose * (spoke_count() + 1) + v); }
    };
    using PointMap = Eigen::Map<const Eigen::Matrix3Xd>;
    struct Rotated;

    Cell make_cell(const Fan& fan, const NormalizedPoses& set) const;
    static void turn_to_rest(Cell& cell);
    static Cell layered_cell(const Cell& cell, const double* weights);
    static void add_layers(const Cell& cell, RuntimeElement& out);
    static void evaluate_cell(const Cell& cell, const double* weights, const PointMap& y, Order order, HessianKind kind,
                              ElementResult& result);
    static void add_edges(const Cell& cell, const double* weights, const PointMap& y, Order order, ElementResult& result);

    Blend blend_;
    Eigen::Index pose_count_, dof_count_;
    std::vector<Cell> cells_; // of layers: with the poses turned to pose 0, and its cotangents
};

} // namespace pliant
