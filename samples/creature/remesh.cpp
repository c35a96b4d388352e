#include "remesh.h"

#include "corner_mesh.h"

#include <algorithm>
#include <cmath>

namespace pliant::creature {
namespace {

// The share of its full step that a vertex moves in one relaxation: all vertices move at once, so full steps would
// overshoot.
constexpr double relaxation = 0.6;

class Remesher {
public:
    Remesher(const Mesh& mesh, const Shape& shape, const Sizing& sizing)
        : mesh_(mesh)
        , shape_(shape)
        , sizing_(sizing)
    {
        for (int v = 0; v < mesh_.vertex_count(); ++v) mesh_.move(v, project(shape_, mesh_.point(v)));
    }

    void round(double edge_length)
    {
        edge_length_ = edge_length;
        split_long_edges();
        collapse_short_edges(4.0 / 5.0);
        flip_edges();
        for (int i = 0; i < 3; ++i) relax();
    }

    // Removes the short edges that relaxation leaves in creases, without splitting again.
    void finish()
    {
        for (int i = 0; i < 3; ++i) {
            collapse_short_edges(3.0 / 5.0);
            flip_edges();
            relax();
        }
    }

    // The edge length that would give `vertex_count` vertices: in an even mesh each vertex covers sqrt(3)/2 of a squared
    // edge length, and areas are measured in units of the local sizing.
    double edge_length_for(int vertex_count) const
    {
        double area = 0.0;
        for (int h = 0; h < mesh_.half_edge_count(); h += 3) {
            if (!mesh_.half_edge_alive(h)) continue;
            const Vec3 centre
                = (mesh_.point(mesh_.origin(h)) + mesh_.point(mesh_.origin(h + 1)) + mesh_.point(mesh_.origin(h + 2))) / 3.0;
            const double size = sizing_(centre);
            area += 0.5 * mesh_.face_normal(h / 3).norm() / (size * size);
        }
        return std::sqrt(area / (0.5 * std::sqrt(3.0) * vertex_count));
    }

    int vertex_count() const { return mesh_.alive_vertex_count(); }
    Mesh result() const { return mesh_.mesh(); }

private:
    Vec3 middle(int h) const { return 0.5 * (mesh_.point(mesh_.origin(h)) + mesh_.point(mesh_.target(h))); }
    double relative_length(int h) const { return mesh_.length(h) / (edge_length_ * sizing_(middle(h))); }
    // Visits every edge once: its half-edge with the smaller number represents it.
    bool speaks(int h) const { return mesh_.half_edge_alive(h) && h < mesh_.twin(h); }

    void split_long_edges()
    {
        for (int h = 0; h < mesh_.half_edge_count(); ++h)
            if (speaks(h) && relative_length(h) > 4.0 / 3.0) mesh_.split(h, project(shape_, middle(h)));
    }

    void collapse_short_edges(double threshold)
    {
        for (int h = 0; h < mesh_.half_edge_count(); ++h)
            if (mesh_.half_edge_alive(h) && relative_length(h) < threshold && mesh_.can_collapse(h) && collapse_is_good(h))
                mesh_.collapse(h);
    }

    // The collapse creates no long edges, which would be split again, and turns no face by more than about 60 degrees.
    bool collapse_is_good(int h) const
    {
        const int a = mesh_.origin(h), b = mesh_.target(h);
        const Vec3& p = mesh_.point(b);
        bool good = true;
        mesh_.for_each_out(a, [&](int o) {
            const int u = mesh_.target(o), w = mesh_.target(CornerMesh::next(o));
            const Vec3 pu = mesh_.point(u), pw = mesh_.point(w);
            good &= (pu - p).norm() < 4.0 / 3.0 * edge_length_ * sizing_(0.5 * (pu + p));
            if (u == b || w == b) return;
            const Vec3 before = mesh_.face_normal(o / 3), after = (pu - p).cross(pw - p);
            good &= before.dot(after) > 0.5 * before.norm() * after.norm();
        });
        return good;
    }

    void flip_edges()
    {
        for (int h = 0; h < mesh_.half_edge_count(); ++h)
            if (speaks(h) && flip_gain(h) > 0 && mesh_.can_flip(h) && flip_is_good(h)) mesh_.flip(h);
    }

    // The decrease of the sum of squared deviations from valence 6.
    int flip_gain(int h) const
    {
        const int ends[4] = { mesh_.origin(h), mesh_.target(h), mesh_.origin(CornerMesh::previous(h)),
                              mesh_.origin(CornerMesh::previous(mesh_.twin(h))) };
        int gain = 0;
        for (int i = 0; i < 4; ++i) {
            const int before = mesh_.valence(ends[i]) - 6, after = before + (i < 2 ? -1 : 1);
            gain += before * before - after * after;
        }
        return gain;
    }

    // The two new faces have nearly the same orientation as the old ones.
    bool flip_is_good(int h) const
    {
        const int g = mesh_.twin(h);
        const Vec3 &a = mesh_.point(mesh_.origin(h)), &b = mesh_.point(mesh_.target(h));
        const Vec3 &c = mesh_.point(mesh_.origin(CornerMesh::previous(h))),
                   &d = mesh_.point(mesh_.origin(CornerMesh::previous(g)));
        const Vec3 old = (mesh_.face_normal(h / 3) + mesh_.face_normal(g / 3)).normalized();
        const Vec3 n0 = (a - c).cross(d - c), n1 = (b - d).cross(c - d);
        return n0.dot(old) > 0.7 * n0.norm() && n1.dot(old) > 0.7 * n1.norm();
    }

    // Every vertex moves to the centroid of its ring, faces weighted by area over sizing, and back onto the surface.
    void relax()
    {
        std::vector<Vec3> target(mesh_.vertex_count());
        for (int v = 0; v < mesh_.vertex_count(); ++v) {
            if (!mesh_.vertex_alive(v)) continue;
            Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
            double weight_sum = 0.0;
            mesh_.for_each_out(v, [&](int h) {
                const Vec3 face_normal = mesh_.face_normal(h / 3);
                const Vec3 centre
                    = (mesh_.point(v) + mesh_.point(mesh_.target(h)) + mesh_.point(mesh_.target(CornerMesh::next(h)))) / 3.0;
                const double size = sizing_(centre), weight = face_normal.norm() / (size * size);
                sum += weight * centre;
                weight_sum += weight;
                normal += face_normal;
            });
            normal.normalize();
            const Vec3 step = sum / weight_sum - mesh_.point(v);
            target[v] = mesh_.point(v) + relaxation * (step - step.dot(normal) * normal);
        }
        for (int v = 0; v < mesh_.vertex_count(); ++v)
            if (mesh_.vertex_alive(v)) mesh_.move(v, project(shape_, target[v]));
    }

    CornerMesh mesh_;
    const Shape& shape_;
    const Sizing& sizing_;
    double edge_length_ = 0.0;
};

} // namespace

Mesh remesh(const Mesh& mesh, const Shape& shape, const Sizing& sizing, int vertex_count, int rounds)
{
    Remesher remesher(mesh, shape, sizing);
    double correction = 1.0;
    for (int i = 0; i < rounds; ++i) {
        remesher.round(correction * remesher.edge_length_for(vertex_count));
        // The thresholds 4/5 and 4/3 do not balance exactly: correct by the count reached, except in the last rounds.
        if (i >= 2 && i + 3 < rounds) correction *= std::sqrt(double(remesher.vertex_count()) / vertex_count);
    }
    remesher.finish();
    return remesher.result();
}

} // namespace pliant::creature
