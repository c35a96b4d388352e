#include "elastic/average/relaxation.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace pliant {

namespace {

// Vertices move that are no more elements than this away from those in question.
constexpr int reach = 2;

// Patches with more of the vertices are no small part of the body: a step of all of it serves them better. Fewer vertices
// than this are little work anyhow.
constexpr double largest_share = 0.5;
constexpr std::size_t always_local = 1000;

// What is around a patch that has settled may be unsettled then. Little is after the second time.
constexpr int settle_limit = 2;

// What a vertex gains that moves alone by Newton's method, with curvatures taken as positive.
double gain_alone(const Eigen::Vector3d& force, const Eigen::Matrix3d& hessian)
{
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(hessian);
    return 0.5 * (axes.eigenvectors().transpose() * force).cwiseAbs2().cwiseQuotient(axes.eigenvalues().cwiseAbs()).sum();
}

void sort_unique(std::vector<std::uint32_t>& numbers)
{
    std::sort(numbers.begin(), numbers.end());
    numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

template <class Visit> void for_vertices(const Energy& energy, std::uint32_t element, Visit visit)
{
    std::size_t count = 0;
    const std::uint32_t* vertices = energy.element_vertices(element, count);
    std::for_each(vertices, vertices + count, visit);
}

} // namespace

Relaxation::Relaxation(const Energy& energy, const NormalizedPoses& set)
    : energy_(energy)
    , set_(set)
    , elements_(std::size_t(energy.dof_count() / 3))
    , cells_(elements_.size())
    , is_fixed_(elements_.size())
{
    for (std::uint32_t e = 0; e < energy.element_count(); ++e)
        for_vertices(energy, e, [&](std::uint32_t v) { elements_[v].push_back(e); });
    const auto add_cells = [&](const auto& cells) {
        for (std::uint32_t c = 0; c < cells.size(); ++c)
            for (const std::uint32_t v : cells[c]) cells_[v].push_back(c);
    };
    set.is_solid() ? add_cells(set.tets) : add_cells(set.triangles);
    for (const std::uint32_t v : set.fixed_vertices) is_fixed_[v] = true;
}

std::vector<std::uint32_t> Relaxation::vertices_near(const Elements& elements) const
{
    std::vector<bool> is_near(elements_.size());
    std::vector<std::uint32_t> near;
    const auto add = [&](std::uint32_t v) {
        if (is_near[v] || is_fixed_[v]) return;
        is_near[v] = true;
        near.push_back(v);
    };
    for (const std::uint32_t e : elements) for_vertices(energy_, e, add);
    std::size_t done = 0;
    for (int step = 0; step < reach; ++step)
        for (const std::size_t end = near.size(); done < end; ++done)
            for (const std::uint32_t e : elements_[near[done]]) for_vertices(energy_, e, add);
    std::sort(near.begin(), near.end());
    return near;
}

// All free vertices that elements connect with the first one; they are free no longer.
Patch Relaxation::grow_patch(std::uint32_t start, std::vector<bool>& is_free) const
{
    Patch patch;
    const auto take = [&](std::uint32_t v) {
        if (!is_free[v]) return;
        is_free[v] = false;
        patch.vertices.push_back(v);
    };
    take(start);
    for (std::size_t i = 0; i < patch.vertices.size(); ++i) {
        const std::uint32_t v = patch.vertices[i];
        for (const std::uint32_t e : elements_[v]) for_vertices(energy_, e, take);
        patch.elements.insert(patch.elements.end(), elements_[v].begin(), elements_[v].end());
        patch.cells.insert(patch.cells.end(), cells_[v].begin(), cells_[v].end());
    }
    for (auto* numbers : { &patch.vertices, &patch.elements, &patch.cells }) sort_unique(*numbers);
    return patch;
}

std::vector<Patch> Relaxation::patches_near(const Elements& elements) const
{
    const std::vector<std::uint32_t> near = vertices_near(elements);
    std::vector<bool> is_free(elements_.size());
    for (const std::uint32_t v : near) is_free[v] = true;
    std::vector<Patch> patches;
    for (const std::uint32_t v : near)
        if (is_free[v]) patches.push_back(grow_patch(v, is_free));
    return patches;
}

Relaxation::Elements Relaxation::elements_at(const std::vector<std::uint32_t>& vertices) const
{
    Elements elements;
    for (const std::uint32_t v : vertices) elements.insert(elements.end(), elements_[v].begin(), elements_[v].end());
    sort_unique(elements);
    return elements;
}

Relaxation::Elements Relaxation::elements_around(const std::vector<std::uint32_t>& cells) const
{
    std::vector<std::uint32_t> corners;
    const auto add = [&](const auto& cell) { corners.insert(corners.end(), cell.begin(), cell.end()); };
    for (const std::uint32_t c : cells) set_.is_solid() ? add(set_.tets[c]) : add(set_.triangles[c]);
    return elements_at(corners);
}

bool Relaxation::are_local(const std::vector<Patch>& patches) const
{
    std::size_t count = 0;
    for (const Patch& patch : patches) count += patch.vertices.size();
    return count > 0 && (count <= always_local || double(count) <= largest_share * double(elements_.size()));
}

bool Relaxation::mend(const Weights& w, const Shape& before, const std::vector<std::uint32_t>& cells, Shape& y) const
{
    const std::vector<Patch> patches = patches_near(elements_around(cells));
    if (!are_local(patches)) return false;
    for (const Patch& patch : patches)
        if (!LocalProblem(energy_, set_, w, patch).smooth(before, y)) return false;
    for (const Patch& patch : patches) LocalProblem(energy_, set_, w, patch).minimize(y);
    return true;
}

bool Relaxation::lower(const Weights& w, const Shape& before, double rise, Shape& y) const
{
    const std::vector<double> old_energies = element_energies(energy_, w, before);
    const std::vector<double> energies = element_energies(energy_, w, y);
    Elements rising;
    for (std::uint32_t e = 0; e < energies.size(); ++e)
        if (!(energies[e] <= old_energies[e] + rise)) rising.push_back(e);
    const std::vector<Patch> patches = patches_near(rising);
    if (!are_local(patches)) return false;
    for (const Patch& patch : patches) LocalProblem(energy_, set_, w, patch).minimize(y);
    return true;
}

// What elements say of one of their vertices.
struct Relaxation::VertexTerms {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
    std::size_t element_count = 0;
};

std::vector<Relaxation::VertexTerms> Relaxation::vertex_terms(const Weights& w, const Shape& y,
                                                              const Elements& elements) const
{
    std::vector<VertexTerms> terms(elements_.size());
    ElementResult result;
    std::vector<double> x;
    for (const std::uint32_t e : elements) {
        std::size_t count = 0;
        const std::uint32_t* vertices = energy_.element_vertices(e, count);
        x.resize(3 * count);
        gather(vertices, count, y, x.data());
        energy_.evaluate(e, w.data(), x.data(), Order::hessian, HessianKind::exact, result);
        for (std::size_t i = 0; i < count; ++i) {
            VertexTerms& of_vertex = terms[vertices[i]];
            of_vertex.force += result.gradient.segment<3>(3 * Eigen::Index(i));
            of_vertex.hessian += result.hessian.block<3, 3>(3 * Eigen::Index(i), 3 * Eigen::Index(i));
            ++of_vertex.element_count;
        }
    }
    return terms;
}

// Among the vertices all of whose elements are given.
std::vector<std::uint32_t> Relaxation::unsettled_vertices(const Weights& w, double gain, const Shape& y,
                                                          const Elements& elements) const
{
    const std::vector<VertexTerms> terms = vertex_terms(w, y, elements);
    std::vector<std::uint32_t> unsettled;
    for (std::uint32_t v = 0; v < terms.size(); ++v)
        if (terms[v].element_count > 0 && terms[v].element_count == elements_[v].size() && !is_fixed_[v]
            && gain_alone(terms[v].force, terms[v].hessian) > gain)
            unsettled.push_back(v);
    return unsettled;
}

void Relaxation::settle(const Weights& w, double gain, Shape& y) const
{
    Elements elements(energy_.element_count());
    std::iota(elements.begin(), elements.end(), 0u);
    for (int i = 0; i < settle_limit; ++i) {
        const std::vector<Patch> patches = patches_near(elements_at(unsettled_vertices(w, gain, y, elements)));
        if (!are_local(patches)) return;
        std::vector<std::uint32_t> moved;
        for (const Patch& patch : patches) {
            LocalProblem(energy_, set_, w, patch).minimize(y);
            moved.insert(moved.end(), patch.vertices.begin(), patch.vertices.end());
        }
        elements = elements_at(vertices_near(elements_at(moved)));
    }
}

} // namespace pliant
