// A closed triangle mesh whose edges can be split, collapsed and flipped.
#pragma once

#include "types.h"

namespace pliant::creature {

// Half-edge h runs from `origin(h)` to `target(h)` in face h / 3; `twin(h)` is its opposite. Edits only mark faces and
// vertices as removed; `mesh()` omits them.
class CornerMesh {
public:
    explicit CornerMesh(const Mesh& mesh);

    static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
    static int previous(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
    int twin(int h) const { return twin_[h]; }
    int origin(int h) const { return origin_[h]; }
    int target(int h) const { return origin_[next(h)]; }

    int half_edge_count() const { return int(origin_.size()); }
    int vertex_count() const { return int(points_.size()); }
    bool half_edge_alive(int h) const { return origin_[h] >= 0; }
    bool vertex_alive(int v) const { return out_[v] >= 0; }
    int alive_vertex_count() const { return alive_vertices_; }

    const Vec3& point(int v) const { return points_[v]; }
    void move(int v, const Vec3& p) { points_[v] = p; }
    double length(int h) const { return (points_[target(h)] - points_[origin(h)]).norm(); }
    // Twice the area times the unit normal.
    Vec3 face_normal(int face) const;

    // Calls f(h) for every half-edge h that leaves v.
    template <class F> void for_each_out(int v, F&& f) const
    {
        int h = out_[v];
        do {
            f(h);
            h = twin_[previous(h)];
        } while (h != out_[v]);
    }
    int valence(int v) const;
    bool adjacent(int u, int v) const;

    // Splits the edge of h with a new vertex at `p`.
    void split(int h, const Vec3& p);
    // True if merging origin(h) into target(h) keeps the mesh a manifold.
    bool can_collapse(int h) const;
    // Merges origin(h) into target(h); needs can_collapse(h).
    void collapse(int h);
    // True if the flipped edge does not exist yet and both ends keep at least three neighbours.
    bool can_flip(int h) const;
    void flip(int h);

    // The mesh without removed elements; vertices are in the order of their first use by a face.
    Mesh mesh() const;

private:
    void link(int h, int g);
    void set_face(int face, int a, int b, int c);

    std::vector<Vec3> points_;
    std::vector<int> origin_, twin_; // per half-edge; origin -1: removed
    std::vector<int> out_;           // per vertex: some half-edge that leaves it; -1: removed
    int alive_vertices_ = 0;
};

} // namespace pliant::creature
