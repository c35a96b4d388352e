#include "elastic/energy/reinforced_shells.h"

#include "elastic/energy/hinge.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

// Per vertex; zero where it has no hinge.
Eigen::VectorXd roughness(const NormalizedPoses& set, const DiscreteShells& shells)
{
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(set.dof_count() / 3), count = sum;
    for (std::size_t hinge = 0; hinge < shells.hinge_count(); ++hinge) {
        std::size_t four = 0;
        const std::uint32_t* v = shells.element_vertices(hinge, four);
        double largest = 0;
        for (const Shape& shape : set.shapes)
            largest = std::max(
                largest,
                std::abs(hinge_angle(point(shape, v[0]), point(shape, v[1]), point(shape, v[2]), point(shape, v[3]))));
        for (const std::uint32_t end : { v[0], v[1] }) sum[end] += largest, count[end] += 1;
    }
    return sum.cwiseQuotient(count.cwiseMax(1));
}

std::vector<bool> rough_vertices(const Eigen::VectorXd& angles, const DiscreteShells& shells)
{
    std::vector<bool> is_rough(std::size_t(angles.size()));
    for (Eigen::Index v = 0; v < angles.size(); ++v) is_rough[std::size_t(v)] = angles[v] > rough_angle;
    for (const std::size_t hinge : shells.foldover_hinges()) {
        std::size_t count = 0;
        const std::uint32_t* v = shells.element_vertices(hinge, count);
        is_rough[v[0]] = is_rough[v[1]] = true;
    }
    return is_rough;
}

std::size_t count_of(const std::vector<bool>& flags) { return std::size_t(std::count(flags.begin(), flags.end(), true)); }

} // namespace

std::size_t count_rough_vertices(const NormalizedPoses& set, const ShellOptions& options)
{
    const DiscreteShells shells(set, options);
    return count_of(rough_vertices(roughness(set, shells), shells));
}

ReinforcedShells::ReinforcedShells(const NormalizedPoses& set, const ShellOptions& options, Blend blend)
    : shells_(set, options, blend)
    , angles_(roughness(set, shells_))
    , is_rough_(rough_vertices(angles_, shells_))
    , cells_(set, is_rough_, blend)
{
    for (std::size_t i = 0; i < shells_.element_count(); ++i)
        if (const double share = smooth_share(i); share > 0) elements_.push_back({ false, i, share });
    for (std::size_t i = 0; i < cells_.element_count(); ++i) elements_.push_back({ true, i, 1 });
}

std::size_t ReinforcedShells::rough_count() const { return count_of(is_rough_); }

std::uint32_t ReinforcedShells::roughest_vertex() const
{
    Eigen::Index vertex = 0;
    angles_.maxCoeff(&vertex);
    return std::uint32_t(vertex);
}

double ReinforcedShells::smooth_share(std::size_t shell_element) const
{
    std::size_t count = 0;
    const std::uint32_t* v = shells_.element_vertices(shell_element, count);
    if (shell_element < shells_.hinge_count()) count = 2; // the ends of its edge come first
    return double(std::count_if(v, v + count, [&](std::uint32_t vertex) { return !is_rough_[vertex]; })) / double(count);
}

const Energy& ReinforcedShells::energy_of(const Element& element) const
{
    return element.is_cell ? static_cast<const Energy&>(cells_) : shells_;
}

const std::uint32_t* ReinforcedShells::element_vertices(std::size_t element, std::size_t& count) const
{
    return energy_of(elements_[element]).element_vertices(elements_[element].number, count);
}

void ReinforcedShells::evaluate(std::size_t element, const double* weights, const double* x, Order order, HessianKind kind,
                                ElementResult& result) const
{
    const Element& part = elements_[element];
    energy_of(part).evaluate(part.number, weights, x, order, kind, result);
    if (part.share == 1) return;
    result.value *= part.share;
    if (order >= Order::gradient) result.gradient *= part.share;
    if (order == Order::hessian) result.hessian *= part.share;
}

RuntimeElement ReinforcedShells::runtime_element(std::size_t element, const Shape& reference) const
{
    const Element& part = elements_[element];
    RuntimeElement out = energy_of(part).runtime_element(part.number, reference);
    out.scale(part.share);
    return out;
}

} // namespace pliant
