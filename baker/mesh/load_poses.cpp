#include "mesh/load_poses.h"

#include "io/read_mesh.h"
#include "mesh/check_surface.h"
#include "mesh/compare_poses.h"

#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

void check_pose_count(const std::vector<std::string>& paths)
{
    if (paths.size() < 2) {
        throw Failure(ExitCode::bad_input,
                      error_at(3001, paths.empty() ? "" : paths[0],
                               fmt::format("{} pose given, two or more are needed", paths.size()),
                               "name all poses of the character, the rest pose first"));
    }
    if (paths.size() > pose_count_limit) {
        throw Failure(ExitCode::bad_input,
                      error_at(3002, "", fmt::format("{} poses given, the limit is {}", paths.size(), pose_count_limit),
                               "choose the poses that differ most"));
    }
}

// The files that could be read, in order; the first is always pose 0 or nothing is.
struct ReadPoses {
    std::vector<MeshFile> meshes;
    bool has_first = false;
};

ReadPoses read_all(const std::vector<std::string>& paths, FindingList& findings)
{
    ReadPoses poses;
    for (const std::string& path : paths) {
        std::optional<MeshFile> mesh = read_mesh(path, findings);
        if (&path == &paths.front()) poses.has_first = mesh.has_value();
        if (mesh) poses.meshes.push_back(std::move(*mesh));
    }
    return poses;
}

// Every pose on its own and against pose 0, as far as the earlier findings leave a meaning to the later questions.
void check_all(const std::vector<MeshFile>& meshes, const Triangulation& triangulation, bool align, FindingList& findings)
{
    const MeshFile& first = meshes[0];
    check_connectivity(first, triangulation, findings);
    check_shape(first, triangulation, findings);
    bool is_comparable = true;
    for (std::size_t k = 1; k < meshes.size(); ++k) {
        if (!check_same_faces(first, meshes[k], findings)) {
            is_comparable = false;
            continue;
        }
        check_shape(meshes[k], triangulation, findings);
        check_correspondence(first, meshes[k], triangulation, findings);
    }
    if (is_comparable && meshes.size() > 1) check_distinct(meshes, triangulation, align, findings);
}

PoseSet to_pose_set(std::vector<MeshFile> meshes, Triangulation triangulation)
{
    PoseSet poses;
    for (MeshFile& mesh : meshes) {
        poses.names.push_back(std::filesystem::path(mesh.path).stem().string());
        poses.paths.push_back(std::move(mesh.path));
        poses.positions.push_back(std::move(mesh.positions));
    }
    poses.polygons = std::move(meshes[0].faces);
    poses.triangles = std::move(triangulation.triangles);
    return poses;
}

} // namespace

PoseSet load_poses(const std::vector<std::string>& paths, const LoadOptions& options, std::vector<Finding>* warnings)
{
    check_pose_count(paths);
    FindingList findings(options.lines_per_number);
    ReadPoses read = read_all(paths, findings);
    Triangulation triangulation;
    if (read.has_first) {
        triangulation = triangulate(read.meshes[0].faces);
        check_all(read.meshes, triangulation, options.align, findings);
    }
    if (findings.has_errors()) throw Failure(ExitCode::bad_input, findings.findings());
    if (warnings) {
        const std::vector<Finding> found = findings.findings();
        warnings->insert(warnings->end(), found.begin(), found.end());
    }
    return to_pose_set(std::move(read.meshes), std::move(triangulation));
}

} // namespace pliant
