#include "corner_mesh.h"

#include <map>
#include <stdexcept>
#include <utility>

namespace pliant::creature {

CornerMesh::CornerMesh(const Mesh& mesh)
    : points_(mesh.points)
    , origin_(mesh.faces.size() * 3)
    , twin_(mesh.faces.size() * 3, -1)
    , out_(mesh.points.size(), -1)
    , alive_vertices_(int(mesh.points.size()))
{
    std::map<std::pair<int, int>, int> half_edges;
    for (int h = 0; h < half_edge_count(); ++h) {
        origin_[h] = mesh.faces[h / 3][h % 3];
        out_[origin_[h]] = h;
    }
    for (int h = 0; h < half_edge_count(); ++h)
        if (!half_edges.emplace(std::pair(origin(h), target(h)), h).second)
            throw std::logic_error("an edge has three faces or two of opposite orientation");
    for (int h = 0; h < half_edge_count(); ++h) {
        const auto found = half_edges.find({ target(h), origin(h) });
        if (found == half_edges.end()) throw std::logic_error("the mesh has a border");
        twin_[h] = found->second;
    }
}

Vec3 CornerMesh::face_normal(int face) const
{
    const Vec3& a = points_[origin_[3 * face]];
    return (points_[origin_[3 * face + 1]] - a).cross(points_[origin_[3 * face + 2]] - a);
}

int CornerMesh::valence(int v) const
{
    int count = 0;
    for_each_out(v, [&](int) { ++count; });
    return count;
}

bool CornerMesh::adjacent(int u, int v) const
{
    bool found = false;
    for_each_out(u, [&](int h) { found |= target(h) == v; });
    return found;
}

void CornerMesh::link(int h, int g)
{
    twin_[h] = g;
    twin_[g] = h;
}

void CornerMesh::set_face(int face, int a, int b, int c)
{
    const int v[3] = { a, b, c };
    for (int i = 0; i < 3; ++i) {
        origin_[3 * face + i] = v[i];
        out_[v[i]] = 3 * face + i;
    }
}

void CornerMesh::split(int h, const Vec3& p)
{
    const int g = twin_[h];
    const int a = origin(h), b = target(h), c = origin(previous(h)), d = origin(previous(g));
    const int bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
    const int m = vertex_count();
    points_.push_back(p);
    out_.push_back(-1);
    ++alive_vertices_;
    const int f0 = h / 3, f1 = g / 3, f2 = half_edge_count() / 3, f3 = f2 + 1;
    origin_.resize(origin_.size() + 6);
    twin_.resize(twin_.size() + 6);
    set_face(f0, a, m, c);
    set_face(f1, m, a, d);
    set_face(f2, m, b, c);
    set_face(f3, b, m, d);
    link(3 * f0, 3 * f1);
    link(3 * f0 + 1, 3 * f2 + 2);
    link(3 * f0 + 2, ca);
    link(3 * f1 + 1, ad);
    link(3 * f1 + 2, 3 * f3 + 1);
    link(3 * f2, 3 * f3);
    link(3 * f2 + 1, bc);
    link(3 * f3 + 2, db);
}

bool CornerMesh::can_collapse(int h) const
{
    const int a = origin(h), b = target(h), c = origin(previous(h)), d = origin(previous(twin_[h]));
    // Link condition: both ends share exactly the two opposite vertices, and each of those keeps at least three neighbours.
    int common = 0;
    for_each_out(a, [&](int g) { common += adjacent(b, target(g)); });
    return common == 2 && valence(c) > 3 && valence(d) > 3 && valence(a) + valence(b) > 6;
}

void CornerMesh::collapse(int h)
{
    const int g = twin_[h];
    const int a = origin(h), b = target(h), c = origin(previous(h)), d = origin(previous(g));
    const int bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
    std::vector<int> leaving;
    for_each_out(a, [&](int o) { leaving.push_back(o); });
    for (int o : leaving) origin_[o] = b;
    link(bc, ca);
    link(ad, db);
    out_[a] = -1;
    out_[b] = ca; // ca left a before, so it leaves b now
    out_[c] = bc;
    out_[d] = ad;
    for (int face : { h / 3, g / 3 })
        for (int i = 0; i < 3; ++i) origin_[3 * face + i] = -1;
    --alive_vertices_;
}

bool CornerMesh::can_flip(int h) const
{
    const int c = origin(previous(h)), d = origin(previous(twin_[h]));
    return valence(origin(h)) > 3 && valence(target(h)) > 3 && c != d && !adjacent(c, d);
}

void CornerMesh::flip(int h)
{
    const int g = twin_[h];
    const int a = origin(h), b = target(h), c = origin(previous(h)), d = origin(previous(g));
    const int bc = twin_[next(h)], ca = twin_[previous(h)], ad = twin_[next(g)], db = twin_[previous(g)];
    const int f0 = h / 3, f1 = g / 3;
    set_face(f0, c, a, d);
    set_face(f1, d, b, c);
    link(3 * f0, ca);
    link(3 * f0 + 1, ad);
    link(3 * f0 + 2, 3 * f1 + 2);
    link(3 * f1, db);
    link(3 * f1 + 1, bc);
}

Mesh CornerMesh::mesh() const
{
    Mesh mesh;
    std::vector<std::int32_t> number(points_.size(), -1);
    for (int h = 0; h < half_edge_count(); h += 3) {
        if (!half_edge_alive(h)) continue;
        Face face;
        for (int i = 0; i < 3; ++i) {
            std::int32_t& n = number[origin_[h + i]];
            if (n < 0) {
                n = std::int32_t(mesh.points.size());
                mesh.points.push_back(points_[origin_[h + i]]);
            }
            face[i] = n;
        }
        mesh.faces.push_back(face);
    }
    return mesh;
}

} // namespace pliant::creature
