// read_poses_tool FOLDER POSE...: reads poses without asking whether they can be blended. Writes positions (f64, 3 a vertex)
// of pose k to FOLDER/k.positions, the corners of triangles (u32) of the first one to FOLDER/triangles, its normals (f32,
// where it has them) to FOLDER/normals; prints a line "pose NAME VERTICES TRIANGLES PARTS" each. For test_gltf_reading.py,
// which computes the same independently.
#include "input/gltf/render_scene.h"
#include "input/poses/pose_source.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

namespace {

template <class T> void write_array(const std::string& path, const T* data, std::size_t count)
{
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
}

} // namespace

int main(int argc, char** argv)
{
    const std::string folder = std::string(argc > 2 ? argv[1] : ".") + "/";
    try {
        pliant::DiagnosticList diagnostics;
        const pliant::PoseSources read = pliant::read_pose_sources(
            std::vector<std::string>(argv + std::min(argc, 2), argv + argc), pliant::Blend::layers, diagnostics);
        for (const pliant::Diagnostic& diagnostic : diagnostics.diagnostics())
            std::fprintf(stderr, "%s\n", pliant::to_text(diagnostic).c_str());
        for (std::size_t k = 0; k < read.meshes.size(); ++k) {
            const pliant::MeshFile& mesh = read.meshes[k];
            std::printf("pose %s %td %zu %zu\n", mesh.name.c_str(), mesh.positions.rows(), mesh.faces.count(),
                        mesh.scene ? mesh.scene->parts.size() : 0);
            write_array(folder + std::to_string(k) + ".positions", mesh.positions.data(),
                        static_cast<std::size_t>(mesh.positions.size()));
        }
        if (!read.meshes.empty()) {
            const pliant::MeshFile& first = read.meshes[0];
            write_array(folder + "triangles", first.faces.indices.data(), first.faces.indices.size());
            const pliant::VertexAttribute* normals = first.scene ? first.scene->find("NORMAL") : nullptr;
            if (normals) write_array(folder + "normals", normals->values.data(), normals->values.size());
        }
        return diagnostics.has_errors() ? 3 : 0;
    } catch (const pliant::Failure& failure) {
        std::fprintf(stderr, "%s\n", failure.what());
        return static_cast<int>(failure.code());
    }
}
