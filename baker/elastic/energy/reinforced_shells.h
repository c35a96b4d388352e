// Discrete shells with the ARAP cell of every rough vertex in place of the hinges and triangles around it. Source: this
// project, THEORY.md, section 10.
#pragma once

#include "elastic/energy/arap.h"
#include "elastic/energy/discrete_shells.h"

namespace pliant {

// A vertex is rough if its roughness exceeds this (radians): the mean over its hinges of the largest dihedral angle in any
// pose. So are both ends of every fold-over hinge.
constexpr double rough_angle = 0.35;

// How many vertices are rough, without the memory of their cells.
std::size_t count_rough_vertices(const NormalizedPoses& set, const ShellOptions& options);

// Elements: hinges and triangles with a vertex that is not rough, each weighted by its share of such vertices (of a hinge:
// of the ends of its edge), then the cells.
class ReinforcedShells final : public Energy {
public:
    ReinforcedShells(const NormalizedPoses& set, const ShellOptions& options, Blend blend = Blend::average);

    std::size_t pose_count() const override { return shells_.pose_count(); }
    Blend blend() const override { return shells_.blend(); }
    Eigen::Index dof_count() const override { return shells_.dof_count(); }
    std::size_t element_count() const override { return elements_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

    const std::vector<bool>& is_rough() const { return is_rough_; } // per vertex
    std::size_t rough_count() const;
    std::uint32_t roughest_vertex() const;

private:
    struct Element {
        bool is_cell;
        std::size_t number; // in cells_ or shells_
        double share;
    };
    double smooth_share(std::size_t shell_element) const;
    const Energy& energy_of(const Element& element) const;

    DiscreteShells shells_;
    Eigen::VectorXd angles_; // roughness per vertex
    std::vector<bool> is_rough_;
    Arap cells_;
    std::vector<Element> elements_;
};

} // namespace pliant
