// The unreduced elastic energy as Python holds it.
#pragma once

#include "arrays.h"
#include "work.h"

#include "bake/options.h"
#include "base/mesh/normalized_poses.h"
#include "elastic/average/hessian.h"

#include <memory>

namespace pliant {

// W(w, .) as a function of the positions of all vertices of the input, in its order and units. Of vertices that were welded
// it looks at the first. Immutable: calls may come from several threads.
class EnergyView {
public:
    // Checks and aligns the poses, and makes their energy. Throws Failure as an average does.
    EnergyView(const SourcePoses& poses, const nb::dict& given, const Listener& listener);

    // x is (n, 3), weights (weight_count). The value may be +infinity; derivatives are not a number then. Throws Failure
    // (usage, P1204) for weights that are none.
    double value(const Array<double, 2>& x, const Array<double, 1>& weights) const;
    nb::object gradient(const Array<double, 2>& x, const Array<double, 1>& weights) const; // (n, 3)
    // Rows, columns and values (k) of the entries of the (3n, 3n) matrix, both triangles, each entry once.
    nb::object hessian(const Array<double, 2>& x, const Array<double, 1>& weights, bool is_projected);

    nb::object poses() const;    // (m, n, 3) as aligned, in units of the input
    nb::object masses() const;   // (n), sum 1, of welded vertices at the first
    nb::object vertices() const; // numbers of the vertices that it looks at, ascending by their place in the elastic mesh
    double length() const { return set_.length; }
    std::size_t vertex_count() const { return vertex_count_; }
    std::size_t weight_count() const { return pliant::weight_count(*energy_); }

private:
    void make(const PoseSet& poses, const EnergyOptions& options, Progress& progress);
    Shape to_shape(const Array<double, 2>& x) const;
    Weights to_weights(const Array<double, 1>& weights) const;
    std::int64_t input_dof(Eigen::Index dof) const { return 3 * std::int64_t(vertices_[std::size_t(dof / 3)]) + dof % 3; }

    std::size_t vertex_count_ = 0;
    std::vector<std::uint32_t> vertices_;   // per vertex of the elastic mesh the input's
    std::vector<std::uint32_t> stands_for_; // per vertex of the input the elastic mesh's
    NormalizedPoses set_;
    std::unique_ptr<Energy> energy_;
    // From the call before, or none. Changes only while the interpreter is locked: a lock that forked children have, too.
    std::unique_ptr<HessianAssembler> idle_;
};

} // namespace pliant
