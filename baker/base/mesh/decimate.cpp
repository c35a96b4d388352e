#include "base/mesh/decimate.h"

#include "base/common/diagnostics.h"
#include "base/mesh/surface.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
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

HalfEdgeMesh to_half_edges(const NormalizedPoses& set)
{
    HalfEdgeMesh mesh;
    mesh.request_face_normals();
    for (Eigen::Index v = 0; v < set.dof_count() / 3; ++v) {
        const Eigen::Vector3d p = set.shapes[0].segment<3>(3 * v);
        const auto handle = mesh.add_vertex({ p.x(), p.y(), p.z() });
        mesh.data(handle).source = std::uint32_t(v);
    }
    for (std::size_t f = 0; f < set.triangles.size(); ++f) {
        const Triangle& t = set.triangles[f];
        const auto handle = mesh.add_face(mesh.vertex_handle(t[0]), mesh.vertex_handle(t[1]), mesh.vertex_handle(t[2]));
        if (!handle.is_valid())
            throw Failure(ExitCode::bad_input,
                          error_at(4503, "",
                                   "face " + std::to_string(f) + " cannot be joined to its neighbours for decimation",
                                   "use --energy cubature, which needs no half-edges"));
    }
    mesh.update_face_normals();
    return mesh;
}

} // namespace

CoarsePoses decimate(const NormalizedPoses& set, std::size_t vertex_count)
{
    HalfEdgeMesh mesh = to_half_edges(set);
    OpenMesh::Decimater::DecimaterT<HalfEdgeMesh> decimater(mesh);
    OpenMesh::Decimater::ModQuadricT<HalfEdgeMesh>::Handle quadric;
    OpenMesh::Decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle flipping; // a folded triangle would be a fold-over hinge
    decimater.add(quadric);
    decimater.module(quadric).unset_max_err(); // as many collapses as asked for, in the order of their error
    decimater.add(flipping);
    decimater.initialize();
    decimater.decimate_to(vertex_count);
    mesh.garbage_collection();

    CoarsePoses coarse;
    for (const auto v : mesh.vertices()) coarse.vertices.push_back(mesh.data(v).source);
    for (const auto f : mesh.faces()) {
        Triangle triangle {};
        std::size_t corner = 0;
        for (const auto v : mesh.fv_range(f)) triangle[corner++] = std::uint32_t(v.idx());
        coarse.set.triangles.push_back(triangle);
    }
    const Eigen::Index n = Eigen::Index(coarse.vertices.size());
    for (const Shape& shape : set.shapes) {
        Shape rows(3 * n);
        for (Eigen::Index v = 0; v < n; ++v) rows.segment<3>(3 * v) = point(shape, coarse.vertices[std::size_t(v)]);
        coarse.set.shapes.push_back(std::move(rows));
    }
    coarse.set.masses = Eigen::VectorXd::Zero(n);
    for (const Shape& shape : coarse.set.shapes)
        coarse.set.masses += lumped_masses(shape, coarse.set.triangles) / double(set.pose_count());
    coarse.set.centre = set.centre;
    coarse.set.length = set.length;
    coarse.set.diagonal = set.diagonal;
    return coarse;
}

} // namespace pliant
