// What the baker works on: several poses of one mesh, a surface of faces or a solid of tetrahedra. Plain data, no behaviour.
#pragma once

#include "base/weights/domain.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pliant {

struct RenderScene;

// n x 3, one row per vertex, in the units of the file it came from.
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
using Triangle = std::array<std::uint32_t, 3>;

// Corners a b c d of positive volume: det[b - a, c - a, d - a] > 0.
using Tetrahedron = std::array<std::uint32_t, 4>;

// Moduli that a file gives to a part of a solid.
struct SolidMaterial {
    std::string name;
    double young = 1; // only ratios between parts matter
    double poisson = 0.4;
};

// Which tetrahedron has which material.
struct SolidRegions {
    std::vector<SolidMaterial> materials;
    std::vector<std::uint32_t> of_tet; // per tetrahedron, an index into materials; empty: the solid is uniform
};

// Faces as a file gave them: face f has corners indices[offsets[f]] .. indices[offsets[f + 1] - 1].
struct Polygons {
    std::vector<std::uint32_t> offsets = { 0 };
    std::vector<std::uint32_t> indices;

    std::size_t count() const { return offsets.size() - 1; }
    std::size_t size(std::size_t face) const { return offsets[face + 1] - offsets[face]; }
};

// One mesh file, read but not yet compared with others.
struct MeshFile {
    std::string path; // as the command line may name it: of a glTF file with what of it this is, behind a '#'
    std::string name; // of the pose, for people; empty: the file's
    Positions positions;
    Polygons faces;
    std::vector<std::uint32_t> face_lines; // line of each face in a text file, empty for binary ones; for messages

    // A solid has these instead of faces.
    std::vector<Tetrahedron> tets;
    std::vector<std::uint32_t> tet_lines; // as face_lines
    SolidRegions regions;

    std::shared_ptr<const RenderScene> scene; // of a glTF file: what its vertices and faces are drawn with
    double initial_weight = 0;                // of a morph target: what the file draws it with
    std::vector<double> position_steps;       // per part of the scene, of the grid that it was rounded to; 0: none
};

// How the surface that files draw differs from the one that the elastic energy lives on, and what is unusual about the
// latter.
struct SurfaceRepairs {
    std::size_t welded_count = 0;                                        // vertices that another one stands for
    std::size_t repeated_count = 0, flat_count = 0, duplicate_count = 0; // triangles left out
    std::size_t crowded_edge_count = 0, turned_edge_count = 0;           // edges of three faces; neighbours turned over
    std::size_t lone_vertex_count = 0, component_count = 1;              // vertices of no triangle; the others' parts

    bool is_irregular() const
    {
        return lone_vertex_count > 0 || component_count > 1 || crowded_edge_count > 0 || turned_edge_count > 0;
    }
    std::size_t left_out_count() const { return repeated_count + flat_count + duplicate_count; }
};

struct RenderMesh;

// Poses of one character: same faces or tetrahedra, other positions. Pose 0 is the rest pose of the subspace (tau).
// Vertices of a surface come in the order of the files, but of those that are one in all poses only the first. Those of a
// solid are numbered anew: the ones on its boundary first, in the order of the files, so that drawing needs a leading part
// only, then those inside.
struct PoseSet {
    std::vector<std::string> paths;
    std::vector<std::string> names;      // file names without folder and extension, or what glTF calls the pose; for people
    Blend blend = Blend::average;        // what the poses are to each other
    bool share_frame = false;            // they stand where one glTF file puts them, and are not aligned
    std::vector<double> initial_weights; // per pose; of layers what they start with
    std::vector<Positions> positions;    // per pose
    Polygons polygons; // as pose 0 gave them, by the files' numbers, for writing; of a solid: the triangles
    // The same, triangulated alike in all poses, a fan from the first corner, as far as they have an energy. Of a solid: its
    // boundary, counter-clockwise seen from outside
    std::vector<Triangle> triangles;

    std::vector<Tetrahedron> tets;              // empty: a surface
    SolidRegions regions;                       // of pose 0
    std::vector<std::uint32_t> source_vertices; // per vertex its number in the files; empty: the same
    std::size_t boundary_vertex_count = 0;      // of a solid: the leading vertices, which triangles use

    SurfaceRepairs repairs; // of a surface
    // The vertices and faces of the files, where those above are not the same: what is drawn and written. Else null.
    std::shared_ptr<const RenderMesh> render_mesh;

    std::vector<std::uint32_t> fixed_vertices; // ascending; they stay where they are in every blend

    std::shared_ptr<const RenderScene> scene; // of pose 0, whose vertices and faces these are; null: it has none

    bool is_solid() const { return !tets.empty(); }
    // A vertex as messages and files name it.
    std::uint32_t file_number(std::size_t vertex) const
    {
        return source_vertices.empty() ? static_cast<std::uint32_t>(vertex) : source_vertices[vertex];
    }
    std::size_t pose_count() const { return positions.size(); }
    std::size_t vertex_count() const { return positions.empty() ? 0 : static_cast<std::size_t>(positions[0].rows()); }
};

} // namespace pliant
