#include "polygonise.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pliant::creature {
namespace {

// The six tetrahedra around the main diagonal of a cube (Kuhn's triangulation): neighbouring cubes agree on their faces.
// Bit i of a corner number is its offset along axis i.
constexpr int tetrahedra[6][4]
    = { { 0, 1, 3, 7 }, { 0, 1, 5, 7 }, { 0, 2, 3, 7 }, { 0, 2, 6, 7 }, { 0, 4, 5, 7 }, { 0, 4, 6, 7 } };

class Marcher {
public:
    Marcher(const Shape& shape, const Vec3& box_min, const Vec3& box_max, double cell)
        : origin_(box_min)
        , cell_(cell)
    {
        for (int i = 0; i < 3; ++i) count_[i] = int(std::ceil((box_max[i] - box_min[i]) / cell)) + 1;
        values_.resize(std::size_t(count_[0]) * count_[1] * count_[2]);
        for (int z = 0; z < count_[2]; ++z)
            for (int y = 0; y < count_[1]; ++y)
                for (int x = 0; x < count_[0]; ++x) values_[index(x, y, z)] = shape.distance(position(x, y, z));
        edge_vertex_.assign(values_.size() * 8, -1);
    }

    Mesh march()
    {
        for (int z = 0; z + 1 < count_[2]; ++z)
            for (int y = 0; y + 1 < count_[1]; ++y)
                for (int x = 0; x + 1 < count_[0]; ++x) march_cell(x, y, z);
        return std::move(mesh_);
    }

private:
    std::size_t index(int x, int y, int z) const { return x + std::size_t(count_[0]) * (y + std::size_t(count_[1]) * z); }
    Vec3 position(int x, int y, int z) const { return origin_ + cell_ * Vec3(x, y, z); }
    bool on_border(int x, int y, int z) const
    {
        return x == 0 || y == 0 || z == 0 || x + 2 == count_[0] || y + 2 == count_[1] || z + 2 == count_[2];
    }

    void march_cell(int x, int y, int z)
    {
        int inside = 0;
        for (int c = 0; c < 8; ++c) inside |= (corner_value(x, y, z, c) < 0.0) << c;
        if (inside == 0 || inside == 255) return;
        if (on_border(x, y, z)) throw std::runtime_error("the surface reaches the border of the grid");
        for (const auto& tet : tetrahedra) march_tetrahedron(x, y, z, tet);
    }

    double corner_value(int x, int y, int z, int c) const
    {
        return values_[index(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2))];
    }
    Vec3 corner_position(int x, int y, int z, int c) const { return position(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2)); }

    void march_tetrahedron(int x, int y, int z, const int (&tet)[4])
    {
        int in[4], out[4], in_count = 0, out_count = 0;
        for (int c : tet) {
            if (corner_value(x, y, z, c) < 0.0)
                in[in_count++] = c;
            else
                out[out_count++] = c;
        }
        if (in_count == 0 || out_count == 0) return;
        const Vec3 outward = corner_position(x, y, z, out[0]) - corner_position(x, y, z, in[0]);
        const auto cut = [&](int a, int b) { return vertex_on_edge(x, y, z, std::min(a, b), std::max(a, b)); };
        if (in_count == 1) {
            add_face(cut(in[0], out[0]), cut(in[0], out[1]), cut(in[0], out[2]), outward);
        } else if (out_count == 1) {
            add_face(cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0]), outward);
        } else {
            const std::int32_t q[4] = { cut(in[0], out[0]), cut(in[0], out[1]), cut(in[1], out[1]), cut(in[1], out[0]) };
            add_face(q[0], q[1], q[2], outward);
            add_face(q[0], q[2], q[3], outward);
        }
    }

    // In Kuhn's triangulation the bits of an edge's first corner are a subset of the bits of its second corner, so the first
    // corner and the differing bits identify the edge.
    std::int32_t vertex_on_edge(int x, int y, int z, int a, int b)
    {
        std::int32_t& slot = edge_vertex_[index(x + (a & 1), y + (a >> 1 & 1), z + (a >> 2)) * 8 + (a ^ b)];
        if (slot < 0) {
            const double va = corner_value(x, y, z, a), vb = corner_value(x, y, z, b);
            // Kept away from the corners, so that no triangle is degenerate; the remesher projects vertices onto the
            // surface.
            const double t = std::clamp(va / (va - vb), 0.1, 0.9);
            slot = std::int32_t(mesh_.points.size());
            mesh_.points.push_back((1.0 - t) * corner_position(x, y, z, a) + t * corner_position(x, y, z, b));
        }
        return slot;
    }

    void add_face(std::int32_t a, std::int32_t b, std::int32_t c, const Vec3& outward)
    {
        const auto& p = mesh_.points;
        // The cut separates inner from outer corners, so this sign is never ambiguous.
        if ((p[b] - p[a]).cross(p[c] - p[a]).dot(outward) < 0.0) std::swap(b, c);
        mesh_.faces.push_back({ a, b, c });
    }

    Vec3 origin_;
    double cell_;
    int count_[3];
    std::vector<double> values_;
    std::vector<std::int32_t> edge_vertex_;
    Mesh mesh_;
};

} // namespace

Mesh polygonise(const Shape& shape, const Vec3& box_min, const Vec3& box_max, double cell)
{
    return Marcher(shape, box_min, box_max, cell).march();
}

} // namespace pliant::creature
