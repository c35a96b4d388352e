#include "input/poses/check_solid.h"

#include "base/common/union_find.h"
#include "base/mesh/solid.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace pliant {
namespace {

using Index = std::uint32_t;
using Edge = std::pair<Index, Index>; // ascending

class TetChecker {
public:
    TetChecker(const MeshFile& mesh, DiagnosticList& diagnostics)
        : mesh_(mesh)
        , diagnostics_(diagnostics)
        , is_left_out_(mesh.tets.size(), false)
    {
    }

    void check(bool has_good_volumes);

private:
    void find_repeated_vertices();
    void find_duplicates();
    void check_faces(bool has_good_volumes);
    void check_face(const TetFace* begin, const TetFace* end, bool has_good_volumes);
    void find_unused_vertices();
    void find_components();
    void error(int number, std::size_t tet, std::string what, const char* hint) const
    {
        diagnostics_.add({ Diagnostic::Severity::error, number, where_is_tet(mesh_, tet), std::move(what), hint });
    }
    template <class Visit> void for_each_face(Visit visit) const
    {
        const TetFace* const last = faces_.data() + faces_.size();
        for (const TetFace *begin = faces_.data(), *end = begin; begin != last; begin = end) {
            while (end != last && end->same_vertices(*begin)) ++end;
            visit(begin, end);
        }
    }

    const MeshFile& mesh_;
    DiagnosticList& diagnostics_;
    std::vector<bool> is_left_out_; // reported already, would only cause further diagnostics
    std::vector<TetFace> faces_;
};

void TetChecker::check(bool has_good_volumes)
{
    find_repeated_vertices();
    find_duplicates();
    faces_ = collect_faces(mesh_.tets, is_left_out_);
    check_faces(has_good_volumes);
    find_unused_vertices();
    find_components();
}

void TetChecker::find_repeated_vertices()
{
    for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
        Tetrahedron corners = mesh_.tets[t];
        std::sort(corners.begin(), corners.end());
        const auto repeated = std::adjacent_find(corners.begin(), corners.end());
        if (repeated == corners.end()) continue;
        is_left_out_[t] = true;
        error(2211, t, fmt::format("tetrahedron {} uses vertex {} more than once", t, *repeated),
              "remove it from all poses");
    }
}

void TetChecker::find_duplicates()
{
    std::vector<std::pair<Tetrahedron, Index>> sorted;
    sorted.reserve(mesh_.tets.size());
    for (Index t = 0; t < mesh_.tets.size(); ++t) {
        if (is_left_out_[t]) continue;
        sorted.emplace_back(mesh_.tets[t], t);
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::pair<Index, Index>> duplicates; // the later and the one before
    for (std::size_t i = 1; i < sorted.size(); ++i) {
        if (sorted[i].first == sorted[i - 1].first) duplicates.emplace_back(sorted[i].second, sorted[i - 1].second);
    }
    std::sort(duplicates.begin(), duplicates.end());
    for (const auto& [later, before] : duplicates) {
        is_left_out_[later] = true;
        error(2215, later, fmt::format("tetrahedron {} has the same vertices as tetrahedron {}", later, before),
              "remove one of the two from all poses");
    }
}

void TetChecker::check_faces(bool has_good_volumes)
{
    // Diagnostics in the order of the file, not in that of the vertices.
    std::vector<std::pair<const TetFace*, const TetFace*>> bad;
    for_each_face([&](const TetFace* begin, const TetFace* end) {
        const bool is_opposed = end - begin == 2 && begin[0].is_even != begin[1].is_even;
        if (end - begin > 1 && !is_opposed) bad.emplace_back(begin, end);
    });
    std::sort(bad.begin(), bad.end(), [](const auto& a, const auto& b) {
        return a.first->tet != b.first->tet ? a.first->tet < b.first->tet : a.first->face < b.first->face;
    });
    for (const auto& [begin, end] : bad) check_face(begin, end, has_good_volumes);
}

void TetChecker::check_face(const TetFace* begin, const TetFace* end, bool has_good_volumes)
{
    const std::string vertices = fmt::format("{} {} {}", begin->sorted[0], begin->sorted[1], begin->sorted[2]);
    if (end - begin == 2) {
        if (!has_good_volumes) return;
        error(
            2218, begin[1].tet,
            fmt::format("tetrahedra {} and {} lie on the same side of their face {}", begin[0].tet, begin[1].tet, vertices),
            "they overlap: remove one of the two from all poses");
        return;
    }
    constexpr std::ptrdiff_t listed = 5;
    std::string tets;
    for (const TetFace* f = begin; f != end && f != begin + listed; ++f)
        tets += fmt::format("{}{}", f == begin ? "" : ", ", f->tet);
    error(2216, begin[2].tet,
          fmt::format("face {} belongs to {} tetrahedra: {}{}", vertices, end - begin, tets,
                      end - begin > listed ? ", ..." : ""),
          "at most two tetrahedra can share a face: remove the others from all poses");
}

void TetChecker::find_unused_vertices()
{
    std::vector<bool> is_used(static_cast<std::size_t>(mesh_.positions.rows()), false);
    for (const Tetrahedron& tet : mesh_.tets) {
        for (const Index vertex : tet) is_used[vertex] = true;
    }
    const auto count = static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), false));
    if (count == 0) return;
    std::string list;
    std::size_t listed = 0;
    for (std::size_t vertex = 0; vertex < is_used.size() && listed < 5; ++vertex) {
        if (!is_used[vertex]) list += fmt::format("{}{}", listed++ == 0 ? "" : ", ", vertex);
    }
    diagnostics_.add(
        error_at(2207, mesh_.path,
                 fmt::format("{} vertices belong to no tetrahedron: {}{}", count, list, count > listed ? ", ..." : ""),
                 "no energy determines where they move: remove them from all poses"));
}

void TetChecker::find_components()
{
    UnionFind sets(mesh_.tets.size());
    for_each_face([&](const TetFace* begin, const TetFace* end) {
        for (const TetFace* f = begin + 1; f < end; ++f) sets.join(begin->tet, f->tet);
    });
    std::vector<std::size_t> sizes(mesh_.tets.size(), 0); // at the set's first tetrahedron
    for (Index t = 0; t < sizes.size(); ++t) {
        if (!is_left_out_[t]) ++sizes[sets.find(t)];
    }
    std::vector<Index> components;
    for (Index t = 0; t < sizes.size(); ++t) {
        if (sizes[t] != 0) components.push_back(t);
    }
    if (components.size() < 2) return;
    std::stable_sort(components.begin(), components.end(), [&](Index a, Index b) { return sizes[a] > sizes[b]; });
    std::string list;
    for (std::size_t i = 0; i < components.size() && i < 5; ++i) {
        list += fmt::format("{}{} tetrahedra with tetrahedron {}", i == 0 ? "" : ", ", sizes[components[i]], components[i]);
    }
    diagnostics_.add(
        error_at(2208, mesh_.path,
                 fmt::format("has {} components: {}{}", components.size(), list, components.size() > 5 ? ", ..." : ""),
                 "the elastic energy does not hold parts together that share no face: join them, or bake them one by one"));
}

// ------------------------------------------------------------------------------------------------------------ the boundary

// Where the boundary is no surface. It need not be one for the energy of a solid, but it seldom is meant: two parts that
// touch.
class BoundaryChecker {
public:
    BoundaryChecker(const MeshFile& mesh, DiagnosticList& diagnostics)
        : mesh_(mesh)
        , diagnostics_(diagnostics)
        , triangles_(boundary_of(mesh.tets))
    {
    }

    void check()
    {
        collect_sides();
        find_edges();
        find_vertices();
    }

private:
    struct Side {
        Edge edge;
        Index triangle, corner; // where it begins
    };
    template <class Visit> void for_each_edge(Visit visit) const
    {
        for (std::size_t begin = 0, end = 0; begin < sides_.size(); begin = end) {
            while (end < sides_.size() && sides_[end].edge == sides_[begin].edge) ++end;
            visit(begin, end);
        }
    }
    void collect_sides();
    void find_edges();
    void find_vertices();

    const MeshFile& mesh_;
    DiagnosticList& diagnostics_;
    std::vector<Triangle> triangles_;
    std::vector<Side> sides_;   // those of an edge behind each other
    std::vector<bool> is_told_; // vertices at an edge that was reported
};

void BoundaryChecker::collect_sides()
{
    for (Index t = 0; t < triangles_.size(); ++t) {
        for (Index corner = 0; corner < 3; ++corner) {
            const Index from = triangles_[t][corner], to = triangles_[t][(corner + 1) % 3];
            sides_.push_back({ { std::min(from, to), std::max(from, to) }, t, corner });
        }
    }
    std::sort(sides_.begin(), sides_.end(),
              [](const Side& a, const Side& b) { return a.edge != b.edge ? a.edge < b.edge : a.triangle < b.triangle; });
}

void BoundaryChecker::find_edges()
{
    is_told_.assign(static_cast<std::size_t>(mesh_.positions.rows()), false);
    std::size_t count = 0;
    Edge first;
    for_each_edge([&](std::size_t begin, std::size_t end) {
        if (end - begin <= 2) return;
        const Edge& edge = sides_[begin].edge;
        if (count++ == 0) first = edge;
        is_told_[edge.first] = is_told_[edge.second] = true;
    });
    if (count == 0) return;
    diagnostics_.add(warning_at(
        2217, mesh_.path,
        fmt::format("the boundary touches itself along {} edges, the first of them {} {}", count, first.first, first.second),
        "the parts can rotate there as at a hinge: join them by a face, or give each its own vertices"));
}

void BoundaryChecker::find_vertices()
{
    // The corners at a vertex, joined across edges: each set is one fan.
    UnionFind fans(3 * triangles_.size());
    for_each_edge([&](std::size_t begin, std::size_t end) {
        if (end - begin != 2) return;
        const Side &a = sides_[begin], &b = sides_[begin + 1];
        fans.join(3 * a.triangle + a.corner, 3 * b.triangle + (b.corner + 1) % 3);
        fans.join(3 * a.triangle + (a.corner + 1) % 3, 3 * b.triangle + b.corner);
    });
    std::vector<Index> fan_counts(is_told_.size(), 0);
    for (Index corner = 0; corner < 3 * triangles_.size(); ++corner) {
        if (fans.find(corner) == corner) ++fan_counts[triangles_[corner / 3][corner % 3]];
    }
    for (Index vertex = 0; vertex < fan_counts.size(); ++vertex) {
        if (fan_counts[vertex] < 2 || is_told_[vertex]) continue;
        diagnostics_.add(about_vertices(
            warning_at(2217, mesh_.path, fmt::format("the boundary touches itself in vertex {}", vertex),
                       "the parts can rotate there freely: join them by a face, or give each its own vertices"),
            { vertex }));
    }
}

} // namespace

void check_tets(const MeshFile& mesh, bool has_good_volumes, DiagnosticList& diagnostics)
{
    const std::size_t errors_before = diagnostics.error_count();
    TetChecker(mesh, diagnostics).check(has_good_volumes);
    if (diagnostics.error_count() == errors_before) BoundaryChecker(mesh, diagnostics).check();
}

} // namespace pliant
