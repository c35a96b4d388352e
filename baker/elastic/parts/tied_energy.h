// The elastic energy of a character in several parts, with its ties and joints:
//     W_k(y) = inner_k(y) + sum_terms stiffness |place(y) - rest_k|^2,
// with the place as in elastic/parts/tie_set.h; of layers the one rest place is rest_0 + sum_k v_k (rest_k - rest_0). Each
// term is a polynomial of degree 6 in y, is zero at pose k and invariant under rigid motions.
#pragma once

#include "elastic/energy/energy.h"
#include "elastic/parts/tie_set.h"

#include <memory>
#include <vector>

namespace pliant {

// Elements: those of the inner energy with their numbers, then one per term of a joint, then one per tie.
class TiedEnergy final : public Energy {
public:
    TiedEnergy(std::unique_ptr<Energy> inner, TieSet ties);

    std::size_t pose_count() const override { return inner_->pose_count(); }
    Blend blend() const override { return inner_->blend(); }
    Eigen::Index dof_count() const override { return inner_->dof_count(); }
    std::size_t element_count() const override { return inner_->element_count() + terms_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    bool allows_collapse() const override { return inner_->allows_collapse(); }
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

    const Energy& inner() const { return *inner_; }
    const TieSet& ties() const { return ties_; }

    // Sets the stiffness of every tie and whether each joint is used in place of its ties. Unused terms get stiffness 0 and
    // stay elements, so that solvers built on this energy remain valid. Not while other threads evaluate.
    void choose(const std::vector<double>& stiffness, const std::vector<bool>& joints);

    // Removes the elements of unused terms. Call it last; choose() must not follow.
    void drop_unused();

private:
    void apply_choice();

    std::unique_ptr<Energy> inner_;
    TieSet ties_;
    std::vector<PenaltyTerm> terms_; // of the joints, then of the ties
};

// Adds the ties to an energy. Returns the energy itself if there are none.
std::unique_ptr<Energy> tie_parts(std::unique_ptr<Energy> energy, TieSet ties);

// The ties of an energy, or null. Owned by the energy.
const TieSet* ties_of(const Energy& energy);

// The energy of the parts alone; the energy itself if it has no ties.
const Energy& without_ties(const Energy& energy);

} // namespace pliant
