#include "mesh/check_surface.h"
#include "mesh/union_find.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

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
    Checker(const MeshFile& mesh, const Triangulation& triangulation, FindingList& findings)
        : mesh_(mesh)
        , triangulation_(triangulation)
        , findings_(findings)
        , is_left_out_(mesh.faces.count(), false)
    {
    }

    void check();

private:
    void find_repeated_vertices();
    void find_duplicate_faces();
    void collect_half_edges();
    void check_edges();
    void check_edge(const HalfEdge* begin, const HalfEdge* end);
    void find_unreferenced_vertices();
    void find_components();
    void find_bow_ties();
    void error(int number, std::size_t face, std::string what, const char* hint) const
    {
        findings_.add({ Finding::Severity::error, number, where_is_face(mesh_, face), std::move(what), hint });
    }

    template <class Visit> void for_each_edge(Visit visit) const
    {
        const HalfEdge* const last = half_edges_.data() + half_edges_.size();
        for (const HalfEdge *begin = half_edges_.data(), *end = begin; begin != last; begin = end) {
            while (end != last && end->same_edge(*begin)) ++end;
            visit(begin, end);
        }
    }

    const MeshFile& mesh_;
    const Triangulation& triangulation_;
    FindingList& findings_;
    std::vector<bool> is_left_out_;    // per face: reported already, would only cause further findings
    std::vector<HalfEdge> half_edges_; // sorted by edge, then by triangle
};

void Checker::check()
{
    const std::size_t errors_before = findings_.error_count();
    find_repeated_vertices();
    find_duplicate_faces();
    collect_half_edges();
    check_edges();
    find_unreferenced_vertices();
    find_components();
    if (findings_.error_count() == errors_before) find_bow_ties(); // fans exist on manifold edges only
}

void Checker::find_repeated_vertices()
{
    std::vector<Index> corners;
    for (std::size_t face = 0; face < mesh_.faces.count(); ++face) {
        const auto begin = mesh_.faces.indices.begin() + mesh_.faces.offsets[face];
        corners.assign(begin, begin + static_cast<std::ptrdiff_t>(mesh_.faces.size(face)));
        std::sort(corners.begin(), corners.end());
        const auto repeated = std::adjacent_find(corners.begin(), corners.end());
        if (repeated == corners.end()) continue;
        is_left_out_[face] = true;
        error(2201, face, fmt::format("face {} uses vertex {} more than once", face, *repeated),
              "remove the face from all poses");
    }
}

void Checker::find_duplicate_faces()
{
    // Faces in the order of their sorted corners: equal ones become neighbours.
    std::vector<Index> sorted = mesh_.faces.indices;
    const auto begin_of = [&](Index face) { return sorted.begin() + mesh_.faces.offsets[face]; };
    const auto end_of = [&](Index face) { return sorted.begin() + mesh_.faces.offsets[face + 1]; };
    std::vector<Index> order(mesh_.faces.count());
    std::iota(order.begin(), order.end(), Index(0));
    for (const Index face : order) std::sort(begin_of(face), end_of(face));
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
        return std::lexicographical_compare(begin_of(a), end_of(a), begin_of(b), end_of(b));
    });
    Index first = 0; // of a run of equal faces
    for (std::size_t i = 1; i < order.size(); ++i) {
        const bool is_equal = std::equal(begin_of(order[i]), end_of(order[i]), begin_of(order[first]), end_of(order[first]));
        if (!is_equal) {
            first = static_cast<Index>(i);
            continue;
        }
        if (is_left_out_[order[i]]) continue;
        is_left_out_[order[i]] = true;
        error(2205, order[i], fmt::format("face {} has the same vertices as face {}", order[i], order[first]),
              "remove one of the two from all poses");
    }
}

void Checker::collect_half_edges()
{
    const std::vector<Triangle>& triangles = triangulation_.triangles;
    half_edges_.reserve(3 * triangles.size());
    for (Index t = 0; t < triangles.size(); ++t) {
        if (is_left_out_[triangulation_.faces[t]]) continue;
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

void Checker::check_edges()
{
    // Findings in the order of the faces, which is the order of the file, not in that of the vertices.
    std::vector<std::pair<const HalfEdge*, const HalfEdge*>> bad;
    for_each_edge([&](const HalfEdge* begin, const HalfEdge* end) {
        const bool is_opposed = end - begin == 2 && begin[0].is_upward != begin[1].is_upward;
        if (end - begin > 1 && !is_opposed) bad.emplace_back(begin, end);
    });
    std::sort(bad.begin(), bad.end(), [](const auto& a, const auto& b) {
        const HalfEdge &ea = *a.first, &eb = *b.first;
        return ea.triangle != eb.triangle ? ea.triangle < eb.triangle : ea.corner < eb.corner;
    });
    for (const auto& [begin, end] : bad) check_edge(begin, end);
}

void Checker::check_edge(const HalfEdge* begin, const HalfEdge* end)
{
    const auto face = [&](const HalfEdge& half_edge) { return triangulation_.faces[half_edge.triangle]; };
    if (end - begin == 2) {
        error(2204, face(begin[1]),
              fmt::format("faces {} and {} run along their edge {} {} in the same direction", face(begin[0]), face(begin[1]),
                          begin->low, begin->high),
              "turn all faces the same way round, alike in all poses");
        return;
    }
    constexpr std::ptrdiff_t listed = 5;
    std::string faces;
    for (const HalfEdge* h = begin; h != end && h != begin + listed; ++h)
        faces += fmt::format("{}{}", h == begin ? "" : ", ", face(*h));
    error(2203, face(begin[2]),
          fmt::format("edge {} {} belongs to {} faces: {}{}", begin->low, begin->high, end - begin, faces,
                      end - begin > listed ? ", ..." : ""),
          "bending is defined between two faces: separate the sheets or remove faces, alike in all poses");
}

void Checker::find_unreferenced_vertices()
{
    std::vector<bool> is_used(static_cast<std::size_t>(mesh_.positions.rows()), false);
    for (const Index vertex : mesh_.faces.indices) is_used[vertex] = true;
    const std::size_t count = static_cast<std::size_t>(std::count(is_used.begin(), is_used.end(), false));
    if (count == 0) return;
    std::string list;
    std::size_t listed = 0;
    for (std::size_t vertex = 0; vertex < is_used.size() && listed < 5; ++vertex) {
        if (!is_used[vertex]) list += fmt::format("{}{}", listed++ == 0 ? "" : ", ", vertex);
    }
    findings_.add(warning_at(2207, mesh_.path,
                             fmt::format("{} vertices belong to no face: {}{}", count, list, count > listed ? ", ..." : ""),
                             "nothing says where they should go: remove them from all poses"));
}

void Checker::find_components()
{
    UnionFind sets(triangulation_.triangles.size());
    for_each_edge([&](const HalfEdge* begin, const HalfEdge* end) {
        for (const HalfEdge* h = begin + 1; h < end; ++h) sets.join(begin->triangle, h->triangle);
    });
    std::vector<std::size_t> sizes(triangulation_.triangles.size(), 0); // in polygons, at the set's first triangle
    std::vector<bool> is_counted = is_left_out_;
    for (Index t = 0; t < sizes.size(); ++t) {
        const Index face = triangulation_.faces[t];
        if (!is_counted[face]) ++sizes[sets.find(t)];
        is_counted[face] = true;
    }
    std::vector<Index> components;
    for (Index t = 0; t < sizes.size(); ++t) {
        if (sizes[t] != 0) components.push_back(t);
    }
    if (components.size() < 2) return;
    std::stable_sort(components.begin(), components.end(), [&](Index a, Index b) { return sizes[a] > sizes[b]; });
    std::string list;
    for (std::size_t i = 0; i < components.size() && i < 5; ++i) {
        list += fmt::format("{}{} faces with face {}", i == 0 ? "" : ", ", sizes[components[i]],
                            triangulation_.faces[components[i]]);
    }
    findings_.add(
        warning_at(2208, mesh_.path,
                   fmt::format("has {} components: {}{}", components.size(), list, components.size() > 5 ? ", ..." : ""),
                   "no elastic energy holds parts together that share no edge: join them or bake them one by one"));
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
    std::vector<Index> fan_counts(static_cast<std::size_t>(mesh_.positions.rows()), 0);
    Index corner = 0;
    for (const Triangle& triangle : triangulation_.triangles) {
        for (const Index vertex : triangle) {
            if (fans.find(corner) == corner) ++fan_counts[vertex];
            ++corner;
        }
    }
    for (Index vertex = 0; vertex < fan_counts.size(); ++vertex) {
        if (fan_counts[vertex] < 2) continue;
        findings_.add(warning_at(2206, mesh_.path,
                                 fmt::format("{} parts of the surface touch in vertex {} only", fan_counts[vertex], vertex),
                                 "discrete shells can do it, ARAP cannot: split the vertex, alike in all poses"));
    }
}

} // namespace

void check_connectivity(const MeshFile& mesh, const Triangulation& triangulation, FindingList& findings)
{
    Checker(mesh, triangulation, findings).check();
}

std::string where_is_face(const MeshFile& mesh, std::size_t face)
{
    if (face >= mesh.face_lines.size()) return mesh.path;
    return mesh.path + ":" + std::to_string(mesh.face_lines[face]);
}

} // namespace pliant
