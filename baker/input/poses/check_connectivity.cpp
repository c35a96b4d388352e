#include "input/poses/check_connectivity.h"

#include "base/common/union_find.h"
#include "input/poses/check_surface.h"

#include <algorithm>
#include <fmt/format.h>

namespace pliant {
namespace {

using Index = std::uint32_t;

// One side of a triangle.
struct HalfEdge {
    Index low, high; // its vertices
    Index triangle;
    Index corner;   // of the triangle, where the half-edge begins
    bool is_upward; // from low to high

    bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

class Checker {
public:
    Checker(const MeshFile& mesh, SimulationMesh& surface, DiagnosticList& diagnostics)
        : mesh_(mesh)
        , surface_(surface)
        , triangulation_(surface.triangulation)
        , diagnostics_(diagnostics)
    {
    }

    void check();

private:
    void collect_half_edges();
    void find_crowded_edges();
    void find_turned_neighbours();
    void find_unreferenced_vertices();
    void find_components();
    void find_bow_ties();
    Index face(const HalfEdge& half_edge) const { return triangulation_.faces[half_edge.triangle]; }
    // About the faces at these edges; it is found at the first one's face number `at`.
    void warn(int number, const std::vector<std::pair<const HalfEdge*, const HalfEdge*>>& edges, std::size_t at,
              std::string what, const char* hint) const
    {
        std::vector<Index> faces;
        for (std::size_t i = 0; i < edges.size() && faces.size() < Diagnostic::element_limit; ++i)
            for (const HalfEdge* h = edges[i].first; h != edges[i].second; ++h) faces.push_back(face(*h));
        const std::string where = where_is_face(mesh_, face(edges[0].first[at]));
        diagnostics_.add(about_faces(warning_at(number, where, std::move(what), hint), faces));
    }

    template <class Visit> void for_each_edge(Visit visit) const
    {
        const HalfEdge* const last = half_edges_.data() + half_edges_.size();
        for (const HalfEdge *begin = half_edges_.data(), *end = begin; begin != last; begin = end) {
            while (end != last && end->same_edge(*begin)) ++end;
            visit(begin, end);
        }
    }

    // The edges that are so, in the order of the faces, which is the order of the file, not in that of the vertices.
    using Edge = std::pair<const HalfEdge*, const HalfEdge*>;
    template <class IsSo> std::vector<Edge> edges_that(IsSo is_so) const
    {
        std::vector<Edge> edges;
        for_each_edge([&](const HalfEdge* begin, const HalfEdge* end) {
            if (is_so(begin, end)) edges.emplace_back(begin, end);
        });
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            const HalfEdge &ea = *a.first, &eb = *b.first;
            return ea.triangle != eb.triangle ? ea.triangle < eb.triangle : ea.corner < eb.corner;
        });
        return edges;
    }

    const MeshFile& mesh_;
    SimulationMesh& surface_;
    const Triangulation& triangulation_;
    DiagnosticList& diagnostics_;
    std::vector<HalfEdge> half_edges_; // sorted by edge, then by triangle
};

void Checker::check()
{
    collect_half_edges();
    find_crowded_edges();
    find_turned_neighbours();
    find_unreferenced_vertices();
    find_components();
    if (surface_.repairs.crowded_edge_count == 0) find_bow_ties(); // fans exist on edges of two faces only
}

void Checker::collect_half_edges()
{
    const std::vector<Triangle>& triangles = triangulation_.triangles;
    half_edges_.reserve(3 * triangles.size());
    for (Index t = 0; t < triangles.size(); ++t) {
        for (Index corner = 0; corner < 3; ++corner) {
            const Index from = triangles[t][corner], to = triangles[t][(corner + 1) % 3];
            half_edges_.push_back({ std::min(from, to), std::max(from, to), t, corner, from < to });
        }
    }
    std::sort(half_edges_.begin(), half_edges_.end(), [](const HalfEdge& a, const HalfEdge& b) {
        if (a.low != b.low) return a.low < b.low;
        if (a.high != b.high) return a.high < b.high;
        return a.triangle < b.triangle;
    });
}

void Checker::find_crowded_edges()
{
    const std::vector<Edge> edges = edges_that([](const HalfEdge* begin, const HalfEdge* end) { return end - begin > 2; });
    surface_.repairs.crowded_edge_count = edges.size();
    if (edges.empty()) return;
    const auto [begin, end] = edges[0];
    std::vector<Index> faces;
    for (const HalfEdge* h = begin; h != end; ++h) faces.push_back(face(*h));
    warn(2203, edges, 2,
         fmt::format("edge {} {} belongs to {} faces: {}{}", begin->low, begin->high, faces.size(), first_few(faces),
                     edges.size() > 1 ? fmt::format(" ({} edges have more than two faces)", edges.size()) : ""),
         "each face bends against the next one around the edge; if this is not intended, separate the sheets the same "
         "way in all poses");
}

void Checker::find_turned_neighbours()
{
    const std::vector<Edge> edges = edges_that([](const HalfEdge* begin, const HalfEdge* end) {
        return end - begin == 2 && begin[0].is_upward == begin[1].is_upward;
    });
    surface_.repairs.turned_edge_count = edges.size();
    if (edges.empty()) return;
    const HalfEdge* const h = edges[0].first;
    warn(2204, edges, 1,
         fmt::format("faces {} and {} have opposite orientations at their edge {} {}{}", face(h[0]), face(h[1]), h->low,
                     h->high, edges.size() > 1 ? fmt::format(" ({} such pairs)", edges.size()) : ""),
         "blends are not affected, lighting is: orient all faces consistently, in all poses");
}

void Checker::find_unreferenced_vertices()
{
    std::vector<bool> is_used(surface_.targets.size(), false);
    for (const Triangle& t : triangulation_.triangles)
        for (const Index vertex : t) is_used[vertex] = true;
    std::vector<Index> unused;
    for (Index vertex = 0; vertex < is_used.size(); ++vertex)
        if (!is_used[vertex] && !surface_.is_welded(vertex)) unused.push_back(vertex);
    surface_.repairs.lone_vertex_count = unused.size();
    if (unused.empty()) return;
    diagnostics_.add(about_vertices(
        warning_at(2207, mesh_.path,
                   fmt::format("{} vertices belong to no face of the simulation mesh: {}", unused.size(), first_few(unused)),
                   "ties hold them to the parts next to them; remove them from all poses if they are not needed"),
        unused));
}

void Checker::find_components()
{
    UnionFind sets(triangulation_.triangles.size());
    for_each_edge([&](const HalfEdge* begin, const HalfEdge* end) {
        for (const HalfEdge* h = begin + 1; h < end; ++h) sets.join(begin->triangle, h->triangle);
    });
    std::vector<std::size_t> sizes(triangulation_.triangles.size(), 0); // in polygons, at the set's first triangle
    std::vector<bool> is_counted(mesh_.faces.count(), false);
    for (Index t = 0; t < sizes.size(); ++t) {
        const Index face = triangulation_.faces[t];
        if (!is_counted[face]) ++sizes[sets.find(t)];
        is_counted[face] = true;
    }
    std::vector<Index> components;
    for (Index t = 0; t < sizes.size(); ++t) {
        if (sizes[t] != 0) components.push_back(t);
    }
    surface_.repairs.component_count = components.size();
    if (components.size() < 2) return;
    std::stable_sort(components.begin(), components.end(), [&](Index a, Index b) { return sizes[a] > sizes[b]; });
    std::string list;
    for (std::size_t i = 0; i < components.size() && i < 5; ++i) {
        list += fmt::format("{}{} faces with face {}", i == 0 ? "" : ", ", sizes[components[i]],
                            triangulation_.faces[components[i]]);
    }
    std::vector<Index> smaller; // a face of each but the largest
    for (std::size_t i = 1; i < components.size(); ++i) smaller.push_back(triangulation_.faces[components[i]]);
    diagnostics_.add(about_faces(
        warning_at(2208, mesh_.path,
                   fmt::format("has {} components: {}{}", components.size(), list, components.size() > 5 ? ", ..." : ""),
                   "ties hold each component to the one next to it, and a bake reports how far it drifts; join them if they "
                   "should be one; --weld 1e-4 (or 1e-3) joins borders that compression has moved apart"),
        smaller));
}

void Checker::find_bow_ties()
{
    // The corners at a vertex, joined across edges: each set is one fan.
    UnionFind fans(3 * triangulation_.triangles.size());
    for_each_edge([&](const HalfEdge* begin, const HalfEdge* end) {
        if (end - begin != 2) return;
        const HalfEdge &a = begin[0], &b = begin[1];
        fans.join(3 * a.triangle + a.corner, 3 * b.triangle + (b.corner + 1) % 3);
        fans.join(3 * a.triangle + (a.corner + 1) % 3, 3 * b.triangle + b.corner);
    });
    std::vector<Index> fan_counts(surface_.targets.size(), 0);
    Index corner = 0;
    for (const Triangle& triangle : triangulation_.triangles) {
        for (const Index vertex : triangle) {
            if (fans.find(corner) == corner) ++fan_counts[vertex];
            ++corner;
        }
    }
    for (Index vertex = 0; vertex < fan_counts.size(); ++vertex) {
        if (fan_counts[vertex] < 2) continue;
        diagnostics_.add(about_vertices(
            warning_at(2206, mesh_.path,
                       fmt::format("{} parts of the surface touch in vertex {} only", fan_counts[vertex], vertex),
                       "the parts turn freely about it: if they should not, split the vertex the same way in all poses"),
            { vertex }));
    }
}

} // namespace

void check_connectivity(const MeshFile& first, SimulationMesh& surface, DiagnosticList& diagnostics)
{
    Checker(first, surface, diagnostics).check();
}

} // namespace pliant
