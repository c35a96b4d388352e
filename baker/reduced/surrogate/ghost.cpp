#include "reduced/surrogate/ghost.h"

#include "base/common/diagnostics.h"

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

Ghost make_ghost(const NormalizedPoses& set, const Subspace& subspace, std::size_t vertex_count)
{
    require_manifold(set.triangles, std::size_t(set.dof_count() / 3), set.source_vertices, "--energy ghost",
                     "repair it the same way in all poses, or use --energy cubature, which does not need one");
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

    Ghost ghost;
    for (const auto v : mesh.vertices()) ghost.vertices.push_back(mesh.data(v).source);
    for (const auto f : mesh.faces()) {
        Triangle triangle {};
        std::size_t corner = 0;
        for (const auto v : mesh.fv_range(f)) triangle[corner++] = std::uint32_t(v.idx());
        ghost.set.triangles.push_back(triangle);
    }
    const Eigen::Index n = Eigen::Index(ghost.vertices.size());
    ghost.basis.resize(3 * n, subspace.dimension());
    for (const Shape& shape : set.shapes) {
        Shape coarse(3 * n);
        for (Eigen::Index v = 0; v < n; ++v) coarse.segment<3>(3 * v) = point(shape, ghost.vertices[std::size_t(v)]);
        ghost.set.shapes.push_back(std::move(coarse));
    }
    for (Eigen::Index v = 0; v < n; ++v)
        ghost.basis.middleRows<3>(3 * v) = subspace.basis.middleRows<3>(3 * Eigen::Index(ghost.vertices[std::size_t(v)]));
    ghost.set.masses = Eigen::VectorXd::Zero(n);
    for (const Shape& shape : ghost.set.shapes)
        ghost.set.masses += lumped_masses(shape, ghost.set.triangles) / double(set.pose_count());
    ghost.set.centre = set.centre;
    ghost.set.length = set.length;
    ghost.set.diagonal = set.diagonal;
    return ghost;
}

} // namespace pliant
