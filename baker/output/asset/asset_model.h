// What an asset is made of.
#pragma once

#include "base/mesh/render_mesh.h"
#include "output/asset/reachable.h"
#include "output/asset/stored_shape.h"
#include "reduced/surrogate/blend_model.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

// The mesh that an asset draws: that of the poses, or one embedded in it.
struct StoredMesh {
    std::vector<Triangle> triangles;
    Polygons polygons;                  // faces as given; empty: the triangles
    std::optional<Embedding> embedding; // of its vertices in the mesh of the poses; none: they are the same
    std::size_t vertex_count = 0;

    // Per vertex its number in the pose files, of a solid that draws its own boundary; empty: the same.
    std::vector<std::uint32_t> source_vertices;
    std::size_t boundary_vertex_count = 0; // with source_vertices: the leading vertices, which triangles use

    std::vector<std::uint32_t> smoothing; // per vertex its group, whose vertices share a normal; empty: each its own
    std::vector<std::uint8_t> scene;      // chunk GLTF; empty: none
};

// What an asset is made of. Set, subspace and model are borrowed.
struct AssetModel {
    const NormalizedPoses& set;
    const Subspace& subspace;
    const BlendModel& model;
    Shape surrogate_reference; // the shape of the surrogate energy's mesh at q = mean
    StoredMesh mesh;
    StoredShape shape; // of the mesh
    std::vector<std::string> pose_names;
    WeightDomain domain;
};

// Weights and the q that the runtime found for them, in stored coordinates.
struct Answer {
    Weights weights;
    Eigen::VectorXf q;
};

// What is known of an asset only after the runtime has opened it.
struct AssetRecord {
    std::vector<Answer> answers;             // at least one
    std::optional<MorphRanges> morph_ranges; // of q as weights of morph targets
    std::string certificate = "{}";          // JSON text
};

} // namespace pliant
