#include "bake/assemble.h"

#include "base/mesh/smoothing_groups.h"
#include "input/gltf/render_scene.h"
#include "input/gltf/scene_chunk.h"

#include <utility>

namespace pliant {

namespace {

// Of the triangles of each drawn vertex, in the first pose.
std::vector<Eigen::Vector3d> sides_of(const RenderMesh& drawn, const Positions& positions)
{
    const auto at = [&](std::uint32_t v) -> Eigen::Vector3d { return positions.row(drawn.embedding.corners[v][0]); };
    std::vector<Eigen::Vector3d> sides(drawn.embedding.count(), Eigen::Vector3d::Zero());
    for (const Triangle& t : drawn.triangles) {
        const Eigen::Vector3d normal = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
        for (const std::uint32_t v : t) sides[v] += normal;
    }
    return sides;
}

// Welded vertices share a normal unless the file's own normals say that there is an edge, or they are two sides.
std::vector<std::uint32_t> smoothing_of(const RenderMesh& drawn, const PoseSet& poses)
{
    const RenderScene* const scene = poses.scene.get();
    std::vector<std::uint32_t> welded;
    for (const Tetrahedron& corners : drawn.embedding.corners) welded.push_back(corners[0]);
    std::vector<Eigen::Vector3d> normals;
    const VertexAttribute* given = scene && scene->vertex_count == welded.size() ? scene->find("NORMAL") : nullptr;
    for (std::size_t v = 0; given && v < welded.size(); ++v)
        normals.push_back(Eigen::Map<const Eigen::Vector3f>(given->values.data() + 3 * v).cast<double>());
    return smoothing_groups(welded, normals, sides_of(drawn, poses.positions[0]));
}

// What the vertices are drawn with, if that is known of just these.
std::vector<std::uint8_t> scene_of(const PoseSet& poses, std::size_t vertex_count, const BakeOptions& options)
{
    const bool is_kept = options.keep_scene && poses.scene && poses.scene->vertex_count == vertex_count;
    return is_kept ? encode_scene_chunk(*poses.scene) : std::vector<std::uint8_t>();
}

} // namespace

Eigen::MatrixXd reachable_coordinates(const FittedModel& fitted)
{
    const Subspace& subspace = fitted.subspace;
    const TrainingSet& training = fitted.training;
    const Eigen::Index count = Eigen::Index(training.averages.size()), m = subspace.pose_coordinates.cols();
    Eigen::MatrixXd out(subspace.dimension(), count + m);
    for (Eigen::Index i = 0; i < count; ++i) out.col(i) = training.averages[std::size_t(i)];
    out.rightCols(m) = subspace.pose_coordinates;
    return out;
}

StoredMesh simulation_mesh(const PoseSet& poses, const NormalizedPoses& set, const BakeOptions& options)
{
    StoredMesh mesh;
    mesh.triangles = set.triangles;
    mesh.vertex_count = std::size_t(set.dof_count() / 3);
    if (!poses.render_mesh) mesh.polygons = poses.polygons; // else those name the files' vertices
    if (poses.is_solid()) {
        mesh.source_vertices = poses.source_vertices;
        mesh.boundary_vertex_count = poses.boundary_vertex_count;
    }
    if (!render_mesh_of(poses, options)) mesh.scene = scene_of(poses, mesh.vertex_count, options);
    return mesh;
}

std::shared_ptr<const RenderMesh> render_mesh_of(const PoseSet& poses, const BakeOptions& options)
{
    return options.render_mesh ? options.render_mesh : poses.render_mesh;
}

StoredMesh stored_render_mesh(const RenderMesh& drawn, const PoseSet& poses, const BakeOptions& options)
{
    StoredMesh mesh;
    mesh.triangles = drawn.triangles;
    mesh.polygons = drawn.polygons;
    mesh.embedding = drawn.embedding;
    mesh.vertex_count = drawn.embedding.count();
    if (!options.render_mesh) mesh.smoothing = smoothing_of(drawn, poses);
    mesh.scene = scene_of(poses, mesh.vertex_count, options);
    return mesh;
}

AssetModel assemble(const NormalizedPoses& set, const WeightDomain& domain, const FittedModel& fitted, StoredMesh mesh,
                    const PoseSet& poses, const Eigen::MatrixXd& reachable, const BakeOptions& options)
{
    const Embedding* embedding = mesh.embedding ? &*mesh.embedding : nullptr;
    const std::size_t boundary_count = mesh.source_vertices.empty() ? mesh.vertex_count : mesh.boundary_vertex_count;
    StoredShape shape
        = store_shape(set, fitted.subspace, embedding, reachable, options.basis_error() * set.diagonal, boundary_count);
    return {
        set, fitted.subspace, fitted.model, fitted.mean_shape(), std::move(mesh), std::move(shape), poses.names, domain
    };
}

} // namespace pliant
