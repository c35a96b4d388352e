// An elastic energy of several parts and what ties them together:
//     W_k(y) = inner_k(y) + sum_ties kappa |place(y) - place in pose k|^2,
// the place of a vertex among its anchors as elastic/parts/tie_set.h measures it. Polynomial in y, zero at pose k, and the same for every rigid motion.
#pragma once

#include "elastic/energy/energy.h"
#include "elastic/parts/tie_set.h"

#include <memory>
#include <vector>

namespace pliant {

// Elements of the inner energy first, with its numbers, then those of joints, then those of ties.
class TiedEnergy final : public Energy {
public:
    TiedEnergy(std::unique_ptr<Energy> inner, TieSet ties);

    std::size_t pose_count() const override { return inner_->pose_count(); }
    Eigen::Index dof_count() const override { return inner_->dof_count(); }
    std::size_t element_count() const override { return inner_->element_count() + terms_.size(); }
    const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const override;
    void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                  ElementResult& result) const override;
    RuntimeElement runtime_element(std::size_t element, const Shape& reference) const override;

    const Energy& inner() const { return *inner_; }
    const TieSet& ties() const { return ties_; }

    // A stiffness for each tie, and for each joint whether it is used; what is not used has no energy, and the elements stay the same.
    void choose(const std::vector<double>& stiffness, const std::vector<bool>& joints);

    // Ends the choice: what is not used is no element any more. The last call of these two.
    void drop_unused();

private:
    void apply_choice();

    std::unique_ptr<Energy> inner_;
    TieSet ties_;
    std::vector<PenaltyTerm> terms_; // the joints', then the ties'
};

// The same energy if it needs no ties.
std::unique_ptr<Energy> tie_parts(std::unique_ptr<Energy> energy, TieSet ties);

// The ties of an energy; null: it has none.
const TieSet* ties_of(const Energy& energy);

// What an energy is without its ties.
const Energy& without_ties(const Energy& energy);

} // namespace pliant
