// As-rigid-as-possible energy, "spokes and rims" (Sorkine, Alexa 2007; Chao, Pinkall, Sanan, Schroeder 2010):
//     W_k(y) = sum_cells min_R sum_{edges of cell} c |e(y) - R e(x_k)|^2,
// a cell being a vertex with the edges to its neighbours (spokes) and the edges opposite to it (rims), c in pose k: of a
// spoke (cot + cot)/2 of the angles opposite to it, of a rim cot/2 of the angle at the vertex. Never negative, though
// cotangents may be.
#pragma once

#include "base/mesh/align.h"
#include "elastic/energy/energy.h"

namespace pliant {

// Element i is the cell of vertex i.
class Arap final : public Energy {
public:
    explicit Arap(const NormalizedPoses& set);

    std::size_t pose_count() const override { return std::size_t(pose_count_); }
    Eigen::Index dof_count() const override { return dof_count_; }
    std::size_t element_count() const override { return cells_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

private:
    // Edges are pairs of local vertices: 0 is the centre, 1 + i neighbour i of the fan.
    struct Cell {
        std::vector<std::uint32_t> vertices;
        std::vector<std::array<int, 2>> edges; // spokes, then rims
        Eigen::MatrixXd cotangents;            // m x edges
        Eigen::MatrixXd rest_edges;            // 3m x edges
        bool is_closed = false;
    };
    Eigen::Index pose_count_, dof_count_;
    std::vector<Cell> cells_;
};

} // namespace pliant
