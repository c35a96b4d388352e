// Elastic solids of linear tetrahedra:
//     W_k(y) = sum over tetrahedra of V psi(F),  F = D_s(y) D_m^-1,
// D the edge vectors from the first corner as columns, D_m and the volume V those of pose k, psi of hyperelastic.h.
#pragma once

#include "base/mesh/align.h"
#include "elastic/energy/energy.h"
#include "elastic/energy/hyperelastic.h"

namespace pliant {

struct SolidOptions {
    SolidLaw law = SolidLaw::stvk;
    double poisson = -1; // negative: 0.4 for stvk, 0.45 for mooney-rivlin; regions of a file have their own
};

class Solid final : public Energy {
public:
    // All tetrahedra of all poses must have a positive volume.
    Solid(const NormalizedPoses& set, const SolidOptions& options, Blend blend = Blend::average);

    std::size_t pose_count() const override { return pose_count_; }
    Blend blend() const override { return blend_; }
    Eigen::Index dof_count() const override { return dof_count_; }
    std::size_t element_count() const override { return tets_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

    SolidLaw law() const { return law_; }

    // The energy of an StVK tetrahedron is a quadratic form in the metric of its edges: the root of that form for pose
    // `pose`, R (6 x 6) with sum over rows of (R (G - rest))^2 = its energy, G = (e.e, e.a, e.b, a.a, a.b, b.b).
    SymmetricMatrix6 quadratic_root(std::size_t element, std::size_t pose) const;
    SymmetricVector rest_metric(std::size_t element, std::size_t pose) const
    {
        return rests_[element * pose_count_ + pose].metric;
    }

private:
    // One tetrahedron of one pose.
    struct Rest {
        Eigen::Matrix3d inverse; // D_m^-1
        SymmetricVector metric;  // D_m^T D_m
        double volume;
    };
    static Rest rest_of(const Eigen::Matrix3d& edges);
    Rest layered_rest(std::size_t element, const double* weights) const;
    const Rest& rest(std::size_t element, std::size_t pose) const { return rests_[element * pose_count_ + pose]; }

    SolidLaw law_;
    Blend blend_;
    std::size_t pose_count_;
    Eigen::Index dof_count_;
    std::vector<Tetrahedron> tets_;
    std::vector<SolidModuli> moduli_;      // per material
    std::vector<std::uint32_t> materials_; // per tetrahedron
    std::vector<Rest> rests_;
    std::vector<SymmetricVector> logarithms_; // of layers: per tetrahedron and pose, log(D_0^-T D_k^T D_k D_0^-1)
};

} // namespace pliant
