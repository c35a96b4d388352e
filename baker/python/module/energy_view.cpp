#include "energy_view.h"

#include "checks.h"
#include "options.h"
#include "unlocked.h"

#include "bake/make_energy.h"
#include "bake/warnings.h"
#include "base/mesh/render_mesh.h"

#include <cmath>
#include <limits>
#include <numeric>

namespace pliant {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Per vertex of the input the vertex of the elastic mesh that it moves with.
std::vector<std::uint32_t> elastic_vertices(const PoseSet& poses)
{
    std::vector<std::uint32_t> out(poses.vertex_count());
    std::iota(out.begin(), out.end(), 0u);
    if (poses.render_mesh) {
        out.clear();
        for (const Tetrahedron& corners : poses.render_mesh->embedding.corners) out.push_back(corners[0]);
    }
    for (std::size_t v = 0; v < poses.source_vertices.size(); ++v) out[poses.source_vertices[v]] = std::uint32_t(v);
    return out;
}

} // namespace

EnergyView::EnergyView(const SourcePoses& poses, const nb::dict& given, const Listener& listener)
{
    EnergyOptions options = energy_options(given);
    const unsigned threads = given.contains("threads") ? nb::cast<unsigned>(given["threads"]) : 0;
    work_interruptibly(listener, threads, [&](Progress& progress) {
        std::vector<Diagnostic> warnings;
        const PoseSet set = check(poses, options, warnings, progress);
        options.material = material_of(options, set.is_solid());
        make(set, options, progress);
    });
}

void EnergyView::make(const PoseSet& poses, const EnergyOptions& options, Progress& progress)
{
    set_ = normalize_poses(poses, options, progress);
    energy_ = make_energy(set_, options, &progress);
    stands_for_ = elastic_vertices(poses);
    vertex_count_ = stands_for_.size();
    vertices_.resize(poses.vertex_count());
    for (std::size_t v = vertex_count_; v-- > 0;) vertices_[stands_for_[v]] = std::uint32_t(v); // the first stays
}

Shape EnergyView::to_shape(const Array<double, 2>& x) const
{
    if (x.shape(0) != vertex_count_ || x.shape(1) != 3) throw nb::value_error("x: not the vertices of these poses");
    Shape y(set_.dof_count());
    for (Eigen::Index i = 0; i < y.size(); ++i)
        y[i] = (x(vertices_[std::size_t(i / 3)], std::size_t(i % 3)) - set_.centre[i % 3]) / set_.length;
    return y;
}

Weights EnergyView::to_weights(const Array<double, 1>& weights) const
{
    const std::vector<double> values(weights.data(), weights.data() + weights.size());
    return energy_->blend() == Blend::layers ? layer_weights(values, weight_count())
                                             : normalized_weights(values, weight_count());
}

double EnergyView::value(const Array<double, 2>& x, const Array<double, 1>& weights) const
{
    const Weights w = to_weights(weights);
    const Shape y = to_shape(x);
    const Unlocked unlocked;
    const double value = energy_value(*energy_, w, y);
    return std::isnan(value) ? std::numeric_limits<double>::infinity() : value; // collapsed, or beyond all doubles
}

nb::object EnergyView::gradient(const Array<double, 2>& x, const Array<double, 1>& weights) const
{
    const Weights w = to_weights(weights);
    const Shape y = to_shape(x);
    std::vector<double> out(3 * vertex_count_);
    {
        const Unlocked unlocked;
        Shape sum = Shape::Zero(y.size());
        const double scale = std::isfinite(add_gradient(*energy_, w, y, sum)) ? 1 / set_.length : nan;
        for (Eigen::Index i = 0; i < sum.size(); ++i) out[std::size_t(input_dof(i))] = sum[i] * scale;
    }
    return to_numpy(std::move(out), { vertex_count_, 3 });
}

nb::object EnergyView::hessian(const Array<double, 2>& x, const Array<double, 1>& weights, bool is_projected)
{
    const Weights w = to_weights(weights);
    const Shape y = to_shape(x);
    std::vector<std::int64_t> rows, columns;
    std::vector<double> values;
    std::unique_ptr<HessianAssembler> assembler = std::move(idle_); // one more for a call that comes meanwhile
    {
        const Unlocked unlocked;
        const double scale = std::isfinite(energy_value(*energy_, w, y)) ? 1 / (set_.length * set_.length) : nan;
        if (!assembler) assembler = std::make_unique<HessianAssembler>(*energy_);
        assembler->assemble(w, y, is_projected ? HessianKind::projected : HessianKind::exact);
        const SparseLower& lower = assembler->matrix();
        for (Eigen::Index column = 0; column < lower.cols(); ++column)
            for (SparseLower::InnerIterator it(lower, column); it; ++it) {
                const std::int64_t r = input_dof(it.row()), c = input_dof(column);
                for (const auto& [row, place] : { std::pair(r, c), std::pair(c, r) }) {
                    rows.push_back(row);
                    columns.push_back(place);
                    values.push_back(it.value() * scale);
                    if (r == c) break;
                }
            }
    }
    idle_ = std::move(assembler);
    const std::size_t count = values.size();
    return nb::make_tuple(to_numpy(std::move(rows), { count }), to_numpy(std::move(columns), { count }),
                          to_numpy(std::move(values), { count }));
}

nb::object EnergyView::poses() const
{
    std::vector<double> out;
    for (const Shape& shape : set_.shapes) {
        const Positions positions = to_input_units(set_, shape);
        for (const std::uint32_t v : stands_for_)
            for (int c = 0; c < 3; ++c) out.push_back(positions(v, c));
    }
    return to_numpy(std::move(out), { set_.pose_count(), vertex_count_, 3 });
}

nb::object EnergyView::masses() const
{
    std::vector<double> out(vertex_count_);
    for (std::size_t v = 0; v < vertices_.size(); ++v) out[vertices_[v]] = set_.masses[Eigen::Index(v)];
    return to_numpy(std::move(out), { vertex_count_ });
}

nb::object EnergyView::vertices() const
{
    std::vector<std::uint32_t> out = vertices_;
    return to_numpy(std::move(out), { vertices_.size() });
}

} // namespace pliant
