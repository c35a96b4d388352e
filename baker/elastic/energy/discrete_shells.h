// Discrete Shells (Grinspun, Hirani, Desbrun, Schroeder 2003): bending of hinges plus stretching of triangles.
//     W_k(y) = thickness^2 sum_hinges 3 lbar^2 / A (theta - thetabar)^2 + membrane_k(y),    barred: pose k,
// lbar the edge's length, A the area of its two faces.
#pragma once

#include "base/mesh/align.h"
#include "elastic/energy/energy.h"
#include "elastic/energy/membrane.h"

namespace pliant {

struct ShellOptions {
    Membrane membrane = Membrane::neo_hookean;
    MembraneModuli moduli;
    double thickness = 0.002;       // in units of the root of the mean surface area
    double foldover_damping = 1e-3; // factor on the bending stiffness of fold-over hinges; 1 = off
    double foldover_angle = 2.0;    // radians: a hinge folded further than this in some pose ...
    double foldover_range = 1.0;    // ... or whose angle differs by more than this between poses
};

// Elements 0 .. hinge_count-1 are hinges, then come the faces.
class DiscreteShells final : public Energy {
public:
    DiscreteShells(const NormalizedPoses& set, const ShellOptions& options, Blend blend = Blend::average);

    std::size_t pose_count() const override { return std::size_t(pose_count_); }
    Blend blend() const override { return blend_; }
    Eigen::Index dof_count() const override { return dof_count_; }
    std::size_t element_count() const override { return hinges_.size() + triangles_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

    std::size_t hinge_count() const { return hinges_.size(); }
    // Hinges whose bending was damped: a few of them can carry half of the energy and make several minima. Report them.
    const std::vector<std::size_t>& foldover_hinges() const { return foldovers_; }

private:
    // Bending of one hinge for all poses: stiffness beta_k, angle s_k relative to `centre` (radians).
    double relative_angle(std::size_t hinge, double theta) const;
    void evaluate_hinge(std::size_t hinge, const double* weights, const double* x, Order order, HessianKind kind,
                        ElementResult& result) const;
    void evaluate_face(std::size_t face, const double* weights, const double* x, Order order, HessianKind kind,
                       ElementResult& result) const;
    RuntimeElement runtime_hinge(std::size_t hinge, const Shape& reference) const;
    RuntimeElement runtime_face(std::size_t face, const Shape& reference) const;
    RuntimeElement runtime_layered_face(std::size_t face, const Shape& reference) const;
    RuntimeElement seen_face(std::size_t face) const;
    void find_shears(const NormalizedPoses& set);
    void measure_hinges(const NormalizedPoses& set);
    void take_logarithms();
    Metric metric_of(const Shape& shape, std::size_t face) const;
    Metric layered_metric(std::size_t face, const double* weights) const;
    Metric rest_metric(std::size_t face, Eigen::Index pose) const
    {
        return rest_metrics_.block<3, 1>(3 * pose, Eigen::Index(face));
    }

    ShellOptions options_;
    Blend blend_;
    Eigen::Index pose_count_, dof_count_;
    std::vector<Hinge> hinges_;
    // A face is seen along its longest edge x1 - x0 and its height x2 - x0 - s (x1 - x0). From a corner, the terms of a
    // sliver's energy are of the order of (length/height)^2 times their sum: too much for the single precision of the
    // runtime. An edge membrane sees edges, from the widest corner (s = 0).
    std::vector<Triangle> triangles_;
    Eigen::VectorXd shears_;       // per face: s
    Eigen::VectorXd centres_;      // per hinge
    Eigen::MatrixXd stiffness_;    // m x hinges: beta
    Eigen::MatrixXd rest_angles_;  // m x hinges: s, relative to the centre
    Eigen::MatrixXd rest_metrics_; // 3m x faces; of layers: that of pose 0, then the logarithms of the others
    std::vector<std::size_t> foldovers_;
};

} // namespace pliant
