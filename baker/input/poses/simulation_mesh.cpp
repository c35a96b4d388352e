#include "input/poses/simulation_mesh.h"

#include "base/mesh/surface.h"
#include "base/mesh/weld.h"
#include "base/mesh/weld_seams.h"
#include "input/gltf/render_scene.h"
#include "input/poses/check_surface.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

using Index = std::uint32_t;

// What rounding may move two copies apart, of the diagonal, for seams to be joined: 11 bits, of a part as large as the body
// and of its morph targets.
constexpr double seam_limit = 2e-3;

constexpr const char* left_out = "left out of the simulation mesh";
constexpr const char* drawn_hint = "it is still rendered; remove it from all poses to avoid this warning";

class Builder {
public:
    Builder(const std::vector<const MeshFile*>& meshes, const Triangulation& drawn, DiagnosticList& diagnostics)
        : meshes_(meshes)
        , first_(*meshes[0])
        , drawn_(drawn)
        , diagnostics_(diagnostics)
        , is_left_out_(drawn.triangles.size(), false)
    {
    }

    SimulationMesh build(double weld_tolerance);

private:
    void join_vertices(double tolerance);
    std::size_t join_seams(const std::vector<const Positions*>& poses, double tolerance);
    void leave_out_repeated();
    void leave_out_flat();
    void leave_out_duplicates();
    bool check_flat(const MeshFile& pose, const std::vector<FlatTriangle>& flat);
    Triangle welded(Index triangle) const;
    // One line for all: `what` says it of the first, `faces` are all.
    void warn(int number, const MeshFile& mesh, std::string what, std::vector<Index> faces);

    const std::vector<const MeshFile*>& meshes_;
    const MeshFile& first_;
    const Triangulation& drawn_;
    DiagnosticList& diagnostics_;
    std::vector<bool> is_left_out_;               // per drawn triangle
    std::vector<double> pose_areas_, flat_areas_; // doubled, of all triangles and of the flat ones, once they are needed
    SimulationMesh out_;
};

SimulationMesh Builder::build(double weld_tolerance)
{
    join_vertices(weld_tolerance);
    leave_out_repeated();
    leave_out_flat();
    leave_out_duplicates();
    for (Index t = 0; t < is_left_out_.size(); ++t) {
        if (is_left_out_[t]) continue;
        out_.triangulation.triangles.push_back(welded(t));
        out_.triangulation.faces.push_back(drawn_.faces[t]);
    }
    if (out_.triangulation.triangles.empty() && !diagnostics_.has_errors())
        diagnostics_.add(error_at(2221, first_.path, "no face has an area in all poses",
                                  "the simulation mesh would be empty: export the poses again"));
    return std::move(out_);
}

Triangle Builder::welded(Index triangle) const
{
    const Triangle& t = drawn_.triangles[triangle];
    return { out_.targets[t[0]], out_.targets[t[1]], out_.targets[t[2]] };
}

void Builder::warn(int number, const MeshFile& mesh, std::string what, std::vector<Index> faces)
{
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    if (faces.size() > 1) what += fmt::format(" ({} faces: {})", faces.size(), first_few(faces));
    Diagnostic diagnostic = { Diagnostic::Severity::warning, number, where_is_face(mesh, faces[0]),
                              fmt::format("{}: {}", what, left_out), drawn_hint };
    diagnostics_.add(about_faces(std::move(diagnostic), faces));
}

void Builder::join_vertices(double tolerance)
{
    std::vector<const Positions*> poses;
    for (const MeshFile* mesh : meshes_) poses.push_back(&mesh->positions);
    out_.targets = weld(poses, tolerance);
    const std::size_t seam_count = tolerance > 0 ? join_seams(poses, tolerance) : 0;
    std::vector<Index> joined;
    for (Index v = 0; v < out_.targets.size(); ++v)
        if (out_.is_welded(v)) joined.push_back(v);
    out_.repairs.welded_count = joined.size();
    if (joined.empty()) return;
    Diagnostic diagnostic = warning_at(
        2220, first_.path,
        fmt::format("{} of {} vertices coincide with others in all poses{} and are welded to them: {}", joined.size(),
                    out_.targets.size(),
                    seam_count > 0 ? fmt::format(" ({} within the rounding of compressed parts)", seam_count) : "",
                    first_few(joined)),
        "correct for seams; --weld 0 keeps them apart");
    diagnostics_.add(about_vertices(std::move(diagnostic), joined));
}

// The number of vertices joined where parts of compressed files meet.
std::size_t Builder::join_seams(const std::vector<const Positions*>& poses, double tolerance)
{
    if (!first_.scene || first_.scene->parts.size() < 2) return 0;
    const std::size_t part_count = first_.scene->parts.size();
    RoundedParts parts { {}, Eigen::MatrixXd(Eigen::Index(part_count), Eigen::Index(meshes_.size())) };
    bool is_rounded = false;
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
        const std::vector<double>& steps = meshes_[k]->position_steps;
        const double diagonal = box_diagonal(meshes_[k]->positions);
        if (!(diagonal > 0 && std::isfinite(diagonal)) || (!steps.empty() && steps.size() != part_count)) return 0;
        for (std::size_t p = 0; p < part_count; ++p) {
            // Half a step in each coordinate. What weld() joins lies within the tolerance.
            double& reach = parts.reaches(Eigen::Index(p), Eigen::Index(k));
            reach = steps.empty() ? 0 : 0.5 * std::sqrt(3.0) * steps[p];
            is_rounded = is_rounded || 2 * reach > tolerance * diagonal;
            reach = std::max(reach, 0.5 * tolerance * diagonal);
            if (!(2 * reach <= seam_limit * diagonal)) reach = 0; // no number, either
        }
    }
    if (!is_rounded) return 0;
    parts.of_vertex.resize(out_.targets.size());
    for (Index p = 0; p < part_count; ++p) {
        const ScenePart& part = first_.scene->parts[p];
        std::fill_n(parts.of_vertex.begin() + part.first_vertex, part.vertex_count, p);
    }
    return weld_seams(poses, drawn_.triangles, parts, out_.targets);
}

void Builder::leave_out_repeated()
{
    std::vector<Index> faces;
    std::string what;
    for (Index t = 0; t < drawn_.triangles.size(); ++t) {
        const Triangle corners = drawn_.triangles[t], v = welded(t);
        const std::size_t i = v[0] == v[1] ? 0 : v[1] == v[2] ? 1 : v[2] == v[0] ? 2 : 3;
        if (i == 3) continue;
        is_left_out_[t] = true;
        ++out_.repairs.repeated_count;
        faces.push_back(drawn_.faces[t]);
        const Index a = corners[i], b = corners[(i + 1) % 3];
        if (what.empty())
            what = a == b ? fmt::format("face {} uses vertex {} more than once", faces[0], a)
                          : fmt::format("face {} has its corners {} and {} in one place", faces[0], a, b);
    }
    if (!faces.empty()) warn(2201, first_, what, faces);
}

// A face counts for the first pose in which it is flat.
void Builder::leave_out_flat()
{
    std::vector<Triangle> triangles; // as they are simulated: welding may have moved a corner onto the line of the others
    for (Index t = 0; t < drawn_.triangles.size(); ++t) triangles.push_back(welded(t));
    for (const MeshFile* mesh : meshes_) {
        std::vector<FlatTriangle> flat = find_flat_triangles(*mesh, triangles);
        flat.erase(std::remove_if(flat.begin(), flat.end(), [&](const FlatTriangle& f) { return is_left_out_[f.triangle]; }),
                   flat.end());
        if (!check_flat(*mesh, flat)) return;
        std::vector<Index> faces;
        std::string what;
        for (const FlatTriangle& f : flat) {
            is_left_out_[f.triangle] = true;
            ++out_.repairs.flat_count;
            faces.push_back(drawn_.faces[f.triangle]);
            const Triangle& v = drawn_.triangles[f.triangle];
            if (what.empty())
                what = fmt::format("face {}: triangle {} {} {} has no area (height {:.3g} over an edge of {:.3g})", faces[0],
                                   v[0], v[1], v[2], f.height, f.edge);
        }
        if (!faces.empty()) warn(2202, *mesh, what, faces);
    }
}

double double_area(const Positions& positions, const Triangle& t)
{
    const Eigen::RowVector3d origin = positions.row(t[0]);
    return (positions.row(t[1]) - origin).cross(positions.row(t[2]) - origin).norm();
}

// What is flat in one pose may be a large part of the body in another. False, and said, if these triangles and those that
// have been left out as flat are too large a part of any pose.
bool Builder::check_flat(const MeshFile& pose, const std::vector<FlatTriangle>& flat)
{
    if (flat.empty()) return true;
    flat_areas_.resize(meshes_.size(), 0.0);
    double worst = 0;
    const MeshFile* where = &first_;
    for (std::size_t k = 0; k < meshes_.size(); ++k) {
        const Positions& positions = meshes_[k]->positions;
        if (k == pose_areas_.size()) {
            pose_areas_.push_back(0);
            for (const Triangle& t : drawn_.triangles) pose_areas_[k] += double_area(positions, t);
        }
        for (const FlatTriangle& f : flat) flat_areas_[k] += double_area(positions, drawn_.triangles[f.triangle]);
        const double part = pose_areas_[k] > 0 ? flat_areas_[k] / pose_areas_[k] : 0;
        if (part <= worst) continue;
        worst = part;
        where = meshes_[k];
    }
    if (worst <= flat_part_limit) return true;
    diagnostics_.add(error_at(
        2221, where_is_face(pose, drawn_.faces[flat[0].triangle]),
        fmt::format("face {} and others have no area: {} triangles, {:.1f} % of the surface of {}, {:.0f} % allowed",
                    drawn_.faces[flat[0].triangle], out_.repairs.flat_count + flat.size(), 100 * worst, where->path,
                    100 * flat_part_limit),
        "the simulation mesh cannot contain these parts: export this pose again, or leave it out"));
    return false;
}

void Builder::leave_out_duplicates()
{
    const auto sorted = [&](Index t) {
        Triangle v = welded(t);
        std::sort(v.begin(), v.end());
        return v;
    };
    std::vector<std::pair<Triangle, Index>> order;
    for (Index t = 0; t < is_left_out_.size(); ++t)
        if (!is_left_out_[t]) order.emplace_back(sorted(t), t);
    std::sort(order.begin(), order.end());
    std::vector<std::pair<Index, Index>> twins; // a triangle and the one that it repeats
    for (std::size_t i = 1, original = 0; i < order.size(); ++i) {
        if (order[i].first == order[original].first)
            twins.emplace_back(order[i].second, order[original].second);
        else
            original = i;
    }
    if (twins.empty()) return;
    std::sort(twins.begin(), twins.end());
    std::vector<Index> faces;
    for (const auto& [triangle, original] : twins) {
        is_left_out_[triangle] = true;
        faces.push_back(drawn_.faces[triangle]);
    }
    out_.repairs.duplicate_count = twins.size();
    warn(2205, first_, fmt::format("face {} has the same vertices as face {}", faces[0], drawn_.faces[twins[0].second]),
         faces);
}

} // namespace

std::vector<Index> SimulationMesh::joined(std::vector<Index> vertices) const
{
    for (Index& vertex : vertices) vertex = targets[vertex];
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

std::string first_few(const std::vector<Index>& numbers)
{
    constexpr std::size_t few = 5;
    std::string list;
    for (std::size_t i = 0; i < numbers.size() && i < few; ++i) list += fmt::format("{}{}", i == 0 ? "" : ", ", numbers[i]);
    return numbers.size() > few ? list + ", ..." : list;
}

SimulationMesh make_simulation_mesh(const std::vector<const MeshFile*>& meshes, const Triangulation& drawn,
                                    double weld_tolerance, DiagnosticList& diagnostics)
{
    return Builder(meshes, drawn, diagnostics).build(weld_tolerance);
}

} // namespace pliant
