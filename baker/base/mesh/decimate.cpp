#include "base/mesh/decimate.h"

#include "base/mesh/tets.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModAspectRatioT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

namespace pliant {

namespace {

struct MeshTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
    VertexTraits
    {
        std::uint32_t source = 0; // vertex of the full mesh
    };
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<MeshTraits>;

// The decimater looks round the whole of a vertex for each edge that it would collapse there.
constexpr std::uint32_t largest_valence = 1000;

// The face by which a vertex has too many, or none.
std::optional<std::size_t> face_too_many(const std::vector<Triangle>& triangles, std::size_t vertex_count)
{
    std::vector<std::uint32_t> valences(vertex_count);
    for (std::size_t f = 0; f < triangles.size(); ++f)
        for (const std::uint32_t v : triangles[f])
            if (++valences[v] > largest_valence) return f;
    return {};
}

// The face that has no place, or none.
std::optional<std::size_t> join_half_edges(const NormalizedPoses& set, HalfEdgeMesh& mesh)
{
    mesh.request_face_normals();
    for (Eigen::Index v = 0; v < set.dof_count() / 3; ++v) {
        const Eigen::Vector3d p = set.shapes[0].segment<3>(3 * v);
        const auto handle = mesh.add_vertex({ p.x(), p.y(), p.z() });
        mesh.data(handle).source = std::uint32_t(v);
    }
    for (std::size_t f = 0; f < set.triangles.size(); ++f) {
        const Triangle& t = set.triangles[f];
        if (!mesh.add_face(mesh.vertex_handle(t[0]), mesh.vertex_handle(t[1]), mesh.vertex_handle(t[2])).is_valid())
            return f;
    }
    mesh.update_face_normals();
    return {};
}

// Longest edge over height. In a plane every collapse has quadric error 0, even one that leaves triangles without area.
constexpr float largest_aspect = 10;

void collapse(HalfEdgeMesh& mesh, std::size_t vertex_count)
{
    OpenMesh::Decimater::DecimaterT<HalfEdgeMesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
    OpenMesh::Decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle flipping; // a folded triangle would be a fold-over hinge
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err(); // as many collapses as asked for, in the order of their error
    decimater.add(flipping);
    OpenMesh::Decimater::ModAspectRatioT<HalfEdgeMesh>::Handle aspect;
    decimater.add(aspect);
    decimater.module(aspect).set_aspect_ratio(largest_aspect);
    decimater.initialize();
    decimater.decimate_to(vertex_count);
    mesh.garbage_collection();
}

std::vector<Triangle> triangles_of(const HalfEdgeMesh& mesh)
{
    std::vector<Triangle> triangles;
    for (const auto f : mesh.faces()) {
        Triangle triangle {};
        std::size_t corner = 0;
        for (const auto v : mesh.fv_range(f)) triangle[corner++] = std::uint32_t(v.idx());
        triangles.push_back(triangle);
    }
    return triangles;
}

} // namespace

DecimatedPoses decimate(const NormalizedPoses& set, std::size_t vertex_count)
{
    DecimatedPoses out;
    HalfEdgeMesh mesh;
    if ((out.failed_face = face_too_many(set.triangles, std::size_t(set.dof_count() / 3)))) return out;
    static const bool is_quiet = (omerr().disable(), true); // the face is in our own message
    (void)is_quiet;
    if ((out.failed_face = join_half_edges(set, mesh))) return out;
    collapse(mesh, vertex_count);
    for (const auto v : mesh.vertices()) out.vertices.push_back(mesh.data(v).source);
    out.set.triangles = triangles_of(mesh);
    const Eigen::Index n = Eigen::Index(out.vertices.size());
    out.set.masses = Eigen::VectorXd::Zero(n);
    for (const Shape& shape : set.shapes) {
        Shape coarse(3 * n);
        for (Eigen::Index v = 0; v < n; ++v) coarse.segment<3>(3 * v) = point(shape, out.vertices[std::size_t(v)]);
        out.set.masses += cell_masses(out.set, coarse) / double(set.pose_count());
        out.set.shapes.push_back(std::move(coarse));
    }
    out.set.centre = set.centre;
    out.set.length = set.length;
    out.set.diagonal = set.diagonal;
    return out;
}

} // namespace pliant
