// What a glTF file draws: nodes, skins and meshes of its scene, and how they look at rest.
#pragma once

#include "input/gltf/primitive.h"

#include <Eigen/Geometry>
#include <memory>

namespace pliant {

// Where a node stands in its parent.
struct GltfTransform {
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

struct GltfNode {
    std::string name;
    std::ptrdiff_t parent = -1, mesh = -1, skin = -1;
    bool has_matrix = false; // then it is this, and no animation moves it
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
};

struct GltfSkin {
    std::vector<std::size_t> joints; // nodes
    std::vector<Eigen::Matrix4d> inverse_bind;
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;
    std::vector<std::string> target_names; // "target_1", ... where the file has none; no name twice
};

// A mesh at a node of the scene. Several may show the same mesh.
struct GltfInstance {
    std::size_t node = 0, mesh = 0;
    std::ptrdiff_t skin = -1;
};

// The state that animations change. weights[node][k]: of the k-th target of the node's mesh.
struct GltfState {
    std::vector<GltfTransform> transforms;
    std::vector<std::vector<double>> weights;
};

struct GltfScene {
    std::shared_ptr<const GltfDocument> document;
    std::vector<GltfNode> nodes;
    std::vector<std::size_t> parents_first; // all nodes, each behind its parent
    std::vector<GltfSkin> skins;
    std::vector<GltfMesh> meshes;          // those that are drawn are filled
    std::vector<GltfInstance> instances;   // in the order of their nodes' numbers
    GltfState rest;                        // as the file has it, weights too
    std::vector<std::string> target_names; // of all drawn meshes together, in order; meshes share targets of one name

    std::uint64_t vertex_count() const;
};

// Places of all nodes in the world.
std::vector<Eigen::Matrix4d> world_matrices(const GltfScene& scene, const GltfState& state);

// Reads the default scene (the first if none is named, all nodes if there is none). Throws Failure: what read_primitive
// throws, P2312 (no triangles), P2314 (nodes in a circle), P2324 (skins). Warnings: P2313 (points and lines left out), P2323
// (weights of joints).
GltfScene read_scene(std::shared_ptr<const GltfDocument> document, std::vector<Diagnostic>& warnings);

} // namespace pliant
