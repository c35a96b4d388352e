// Local minimizations: a few cells that resist a step must not shorten the step of the whole body.
#pragma once

#include "elastic/average/local_problem.h"

namespace pliant {

// Nonlinear elimination (Lanzkron, Rose, Wilkes 1996): where a step collapses cells or raises the energy of single elements,
// the vertices around them move to the minimum of the energy, with all others held. Immutable after construction: may be
// shared by threads. The energy and the set must outlive it.
class Relaxation {
public:
    Relaxation(const Energy& energy, const NormalizedPoses& set);

    // The move from `before` to y collapses these cells: around them it is replaced by a smooth one, and W(w, y) is lowered
    // there. False: smooth ones collapse some, too, or the patches are most of the body. Cost: factorizations for some
    // hundred vertices a cell.
    bool mend(const Weights& w, const Shape& before, const std::vector<std::uint32_t>& cells, Shape& y) const;

    // Lowers W(w, y) around the elements whose energy is more than `rise` above that at `before`. False: there are none, or
    // they are most of the body. Cost: two looks at all elements, and that of mend().
    bool lower(const Weights& w, const Shape& before, double rise, Shape& y) const;

    // Lowers W(w, y) around the vertices that could lower it by more than `gain` if they moved alone: small creases of a
    // shape that is nearly an average. Cost: the Hessians of all elements, and that of mend().
    void settle(const Weights& w, double gain, Shape& y) const;

private:
    using Elements = std::vector<std::uint32_t>;
    struct VertexTerms;
    std::vector<std::uint32_t> vertices_near(const Elements& elements) const; // ascending
    std::vector<Patch> patches_near(const Elements& elements) const;
    Patch grow_patch(std::uint32_t start, std::vector<bool>& is_free) const;
    bool are_local(const std::vector<Patch>& patches) const;
    Elements elements_at(const std::vector<std::uint32_t>& vertices) const;
    std::vector<VertexTerms> vertex_terms(const Weights& w, const Shape& y, const Elements& elements) const;
    std::vector<std::uint32_t> unsettled_vertices(const Weights& w, double gain, const Shape& y,
                                                  const Elements& elements) const;
    Elements elements_around(const std::vector<std::uint32_t>& cells) const;

    const Energy& energy_;
    const NormalizedPoses& set_;
    std::vector<std::vector<std::uint32_t>> elements_, cells_; // around each vertex
    std::vector<bool> is_fixed_;
};

} // namespace pliant
