// A character of a game: what tinygltf read, and the Pliant asset inside that shapes it.
#pragma once

#include <pliant.h>

#include <cstdint>
#include <string>
#include <tiny_gltf.h>
#include <vector>

namespace game {

struct Vertex {
    float position[3], normal[3], uv[2];
};

// A primitive of the file: some triangles and the material that draws them.
struct Part {
    std::vector<std::uint32_t> indices; // into vertices()
    float color[4] = { 0.8f, 0.8f, 0.8f, 1 };
    int image = -1; // of gltf().images; -1: only the colour
};

class ElasticModel {
public:
    // Loads a GLB that `pliant export --embed` wrote, and opens the asset in it. Throws std::runtime_error.
    explicit ElasticModel(const std::string& path);
    ElasticModel(const ElasticModel&) = delete;
    ElasticModel& operator=(const ElasticModel&) = delete;

    // Whether the weights add layers to a rest shape; else they blend poses.
    bool has_layers() const { return asset_.has_layers != 0; }
    std::uint32_t weight_count() const { return asset_.weight_count; }
    pliant_weight weight(std::uint32_t index) const; // its name, its range, the weight to start with

    // Shapes the character: one weight for each pose, not negative, not all zero; or one for each layer, any numbers. Throws
    // std::runtime_error for others.
    void blend(const std::vector<float>& weights);

    const std::vector<Vertex>& vertices() const { return vertices_; } // of the last blend
    const std::vector<Part>& parts() const { return parts_; }
    const tinygltf::Model& gltf() const { return gltf_; }

private:
    std::vector<float> initial_weights() const;
    void open_asset(const tinygltf::Mesh& mesh);
    void read_part(const tinygltf::Primitive& primitive);

    tinygltf::Model gltf_;
    std::vector<std::uint64_t> blob_, solver_memory_, normals_memory_; // aligned as the runtime wants it
    pliant_asset asset_ {};
    pliant_solver* solver_ = nullptr;
    pliant_normals normals_ {};
    std::vector<float> q_;
    std::vector<Vertex> vertices_;
    std::vector<Part> parts_;
    std::size_t corner_count_ = 0; // of all parts
};

} // namespace game
