// Elastic energies of deforming the poses of a NormalizedPoses into one shape y:
//     W(w, y) = sum_k w_k W_k(y),    w_k >= 0, y in R^(3n),
// or of the layers on pose 0 (elastic/energy/blend.h): there `weights` are v, one finite number for each pose but pose 0.
// All lengths are those of the NormalizedPoses (normalized). Everything is a sum of elements that look at a few vertices
// each, so that the full energy, its surrogate energy by cubature and the runtime's version of an element come from one
// place.
#pragma once

#include "base/mesh/surface.h"
#include "base/weights/weights.h"
#include "elastic/energy/blend.h"

#include <string>

namespace pliant {

// exact: second derivatives. projected: each element's part replaced by a positive semidefinite one, for Newton steps where
// the exact Hessian is indefinite.
enum class HessianKind { exact, projected };

// Value and derivatives of one element with respect to the coordinates of its vertices (3v, and 3v x 3v).
struct ElementResult {
    double value = 0;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;
};

enum class Order { value, gradient, hessian };

// One element in the form that formats/SPEC.md (chunk ELEM) defines: the numbers for the runtime, in double, before the
// cubature weight is multiplied in. `differences` lists (from, to): difference i is x_to - x_from.
struct RuntimeElement {
    std::uint32_t kind = 0;
    std::uint32_t valence = 0;
    bool is_closed = false;
    std::vector<std::array<std::uint32_t, 2>> differences;
    Eigen::MatrixXd combination;  // differences x c: the element looks at these combinations of them; empty: at themselves
    std::vector<double> fixed;    // F numbers
    Eigen::MatrixXd pose_numbers; // m x K; of layers: those of the rest shape, then what each layer adds

    // As of an element that counts so many times: a cubature weight.
    void scale(double factor);
};

// The only virtual interface of the mathematics. Immutable after construction: may be shared by threads.
class Energy {
public:
    virtual ~Energy() = default;

    virtual std::size_t pose_count() const = 0;
    virtual Blend blend() const = 0;
    virtual Eigen::Index dof_count() const = 0;
    virtual std::size_t element_count() const = 0;

    // Vertices of an element; the pointer lives as long as the energy.
    virtual const std::uint32_t* element_vertices(std::size_t element, std::size_t& count) const = 0;

    // sum_k weights[k] * (part of the element in W_k) at the local coordinates x (3v). Fills `result` as far as `order`
    // asks. Of averages no weight may be negative. A collapsed element may be +infinity; its derivatives are then
    // meaningless.
    virtual void evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                          ElementResult& result) const = 0;

    // Whether triangles and tetrahedra may collapse and flip on the way to a minimum: the energy is finite there, and its
    // forces lead on.
    virtual bool allows_collapse() const { return false; }

    // The element for the runtime; `reference` is the shape at z = 0, to which the runtime's energies are relative.
    virtual RuntimeElement runtime_element(std::size_t element, const Shape& reference) const = 0;
};

// One per pose, or one per layer.
inline std::size_t weight_count(const Energy& energy) { return energy.pose_count() - (energy.blend() == Blend::layers); }

// The weights at which pose `pose` has no energy: e_pose, or for layers 0 (pose 0) and e_(pose - 1).
Weights weights_of_pose(const Energy& energy, std::size_t pose);

// Those of all poses; of layers without pose 0, which is the centre of their weights.
std::vector<Weights> corner_weights_of(const Energy& energy);

// Copies the coordinates of an element's vertices out of a shape.
void gather(const std::uint32_t* vertices, std::size_t count, const Shape& y, double* x);

double energy_value(const Energy& energy, const Weights& w, const Shape& y);

// The value of every element.
std::vector<double> element_energies(const Energy& energy, const Weights& w, const Shape& y);

// Adds the gradient (3n) to `gradient`, returns the value. If `force_scale` is given, adds to it the sum over elements of
// the norms of their forces per vertex, squared and rooted over vertices: the scale against which a gradient is small.
double add_gradient(const Energy& energy, const Weights& w, const Shape& y, Shape& gradient, double* force_scale = nullptr);

// How the gradient at y changes with the weights along directions (columns), 3n x directions. Of averages, whose energy is
// linear in the weights, exact; of layers central differences, to nine digits. Cost: pose_count() gradients, or two for each
// direction.
Eigen::MatrixXd weight_forces(const Energy& energy, const Weights& w, const Shape& y, const Eigen::MatrixXd& directions);

// Symmetric positive semidefinite part: negative eigenvalues become zero.
void project_positive(Eigen::Ref<Eigen::MatrixXd> matrix);

} // namespace pliant
