#include "input/poses/fixed_vertices.h"

#include "base/mesh/surface.h"
#include "input/io/source_file.h"
#include "input/poses/check_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>

namespace pliant {
namespace {

// Part of the first pose's diagonal by which fixed vertices may differ between poses.
constexpr double relative_tolerance = 1e-6;

// The largest distance of a fixed vertex from the line through two others, which are as far apart as they can be from the
// first.
double distance_from_line(const Positions& positions, const std::vector<std::uint32_t>& fixed)
{
    const Eigen::RowVector3d origin = positions.row(fixed[0]);
    Eigen::RowVector3d axis = Eigen::RowVector3d::Zero();
    for (const std::uint32_t vertex : fixed) {
        const Eigen::RowVector3d to = positions.row(vertex) - origin;
        if (to.squaredNorm() > axis.squaredNorm()) axis = to;
    }
    if (!(axis.norm() > 0)) return 0;
    axis.normalize();
    double result = 0;
    for (const std::uint32_t vertex : fixed) {
        const Eigen::RowVector3d to = positions.row(vertex) - origin;
        result = std::max(result, (to - to.dot(axis) * axis).norm());
    }
    return result;
}

} // namespace

std::vector<std::uint32_t> read_fixed_vertices(const std::string& path, std::size_t vertex_count,
                                               DiagnosticList& diagnostics)
{
    std::optional<std::string> bytes = read_bytes(path, diagnostics);
    if (!bytes) return {};
    if (bytes->compare(0, 3, "\xef\xbb\xbf") == 0) bytes->erase(0, 3);
    const SourceFile file { path, std::move(*bytes), &diagnostics };
    std::vector<std::uint32_t> fixed;
    LineReader lines(file.bytes);
    while (lines.next()) {
        std::string_view line = lines.line();
        const std::string_view word = next_word(line, '#');
        if (word.empty()) continue;
        const std::optional<std::int64_t> vertex = parse_integer(word);
        const std::string_view more = next_word(line, '#');
        if (!vertex || !more.empty()) {
            file.error(2602, file.at_line(lines.number()),
                       fmt::format("vertex number {} not understood", excerpt(lines.line())),
                       "write one vertex number per line, counted from 0; # starts a comment");
        } else if (*vertex < 0 || static_cast<std::uint64_t>(*vertex) >= vertex_count) {
            file.error(2603, file.at_line(lines.number()),
                       fmt::format("vertex {} is to be fixed, the poses have {} vertices", *vertex, vertex_count),
                       "count from 0, in the order of the pose files");
        } else {
            fixed.push_back(static_cast<std::uint32_t>(*vertex));
        }
    }
    std::sort(fixed.begin(), fixed.end());
    fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
    return fixed;
}

void check_fixed_vertices(const std::string& path, const std::vector<std::uint32_t>& fixed, std::size_t vertex_count,
                          const std::vector<MeshFile>& meshes, DiagnosticList& diagnostics)
{
    const Positions& first = meshes[0].positions;
    const double size = box_diagonal(first), rounding = coordinate_rounding(first);
    // Nearly on a line counts as on it: what holds the body there would be the last digits of the coordinates.
    if (fixed.size() < 3 || distance_from_line(first, fixed) <= relative_tolerance * size + 4 * rounding) {
        diagnostics.add(error_at(2604, path,
                                 fmt::format("{} vertices are fixed{}: the body could still turn", fixed.size(),
                                             fixed.size() < 3 ? "" : ", all on a line"),
                                 "fix three or more that do not lie on a line, or none"));
    } else if (fixed.size() == vertex_count) {
        diagnostics.add(error_at(2605, path, fmt::format("all {} vertices are fixed: nothing could move", fixed.size()),
                                 "name only those that hold the body"));
    }
    for (std::size_t k = 1; k < meshes.size(); ++k) {
        const Positions& pose = meshes[k].positions;
        const double allowed = relative_tolerance * size + 4 * std::max(rounding, coordinate_rounding(pose));
        for (const std::uint32_t vertex : fixed) {
            const double distance = (pose.row(vertex) - first.row(vertex)).norm();
            if (distance <= allowed) continue;
            diagnostics.add(
                error_at(3013, meshes[k].path,
                         fmt::format("vertex {} is fixed, but lies {:.3g} away from where {} has it (allowed {:.2g})",
                                     vertex, distance, meshes[0].path, allowed),
                         "fixed vertices must have the same place in all poses; poses with fixed vertices are not aligned"));
        }
    }
}

void pin_vertices(const std::vector<std::uint32_t>& fixed, std::vector<Positions>& poses)
{
    for (Positions& positions : poses) {
        for (const std::uint32_t vertex : fixed) positions.row(vertex) = poses[0].row(vertex);
    }
}

} // namespace pliant
