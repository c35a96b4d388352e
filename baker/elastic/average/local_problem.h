// A part of a body whose vertices move while all others are held.
#pragma once

#include "base/mesh/normalized_poses.h"
#include "elastic/energy/energy.h"

#include <Eigen/SparseCholesky>

namespace pliant {

struct Patch {
    std::vector<std::uint32_t> vertices;        // ascending
    std::vector<std::uint32_t> elements, cells; // those with one of the vertices, ascending

    // Index of the vertex's first coordinate among those of the patch; -1 if the vertex is held.
    Eigen::Index place_of(std::uint32_t vertex) const;
};

// The triangles or tetrahedra that shrink below a fifth of their area or volume from y to `moved`, and tetrahedra that are
// inverted. Beyond that a quadratic model says nothing, and energies that are finite for collapsed cells would let them
// collapse.
std::vector<std::uint32_t> collapsing_cells(const NormalizedPoses& set, const Shape& y, const Shape& moved);

// The minimum of W(w, .) over the vertices of one patch. All arguments must outlive it.
class LocalProblem {
public:
    LocalProblem(const Energy& energy, const NormalizedPoses& set, const Weights& w, const Patch& patch);

    // Replaces the displacements in the patch from `before` to y: each becomes the mean of those around it. False: some
    // cell collapses, and y is as it was.
    bool smooth(const Shape& before, Shape& y) const;

    // Newton's method with projected Hessians, which collapses no cell. Changes y in the patch. Cost: factorizations for
    // its vertices.
    void minimize(Shape& y);

private:
    // Calls visit(vertices, count) after each element has been evaluated into result_; returns the energy.
    template <class Visit> double evaluate(const Shape& y, Order order, Visit visit);
    double assemble(const Shape& y);
    bool advance(const Eigen::VectorXd& step, double slope, double energy, Shape& y);
    Eigen::VectorXd sizes(const Shape& y) const;
    bool collapses(const Eigen::VectorXd& before, const Shape& y) const;
    Eigen::VectorXd gather(const Shape& y) const;
    void scatter(const Eigen::VectorXd& coordinates, Shape& y) const;

    const Energy& energy_;
    const NormalizedPoses& set_;
    const Weights& w_;
    const Patch& patch_;
    ElementResult result_;
    std::vector<double> x_; // of an element
    Eigen::VectorXd gradient_;
    Eigen::SparseMatrix<double> hessian_; // lower triangle
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
};

} // namespace pliant
