#include "blend/truth.h"

#include "blend/error.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <system_error>

namespace pliant::player {
namespace {

constexpr std::size_t header_limit = 4096; // the tool writes about 250 bytes
constexpr std::size_t vertex_bytes = 12;

[[noreturn]] void refuse_mesh(const std::string& path, const std::string& reason)
{
    throw Error(ErrorNumber::truth_mesh_refused, ExitCode::bad_input, path + ": " + reason,
                "make the meshes with: pliant average POSE... --grid N --list truth.csv -o truth_%04d.ply");
}

std::string read_file(const std::string& path)
{
    std::error_code error;
    if (std::filesystem::exists(path, error) && !std::filesystem::is_regular_file(path, error))
        refuse_mesh(path, "is a folder or a device, not a mesh");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) refuse_mesh(path, "cannot be opened");
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    return bytes.str();
}

struct Header {
    std::uint64_t vertex_count = 0, face_count = 0;
    std::size_t count_bytes = 1; // of the corner count before each face
    std::size_t length = 0;      // of the header
};

// The number in a line such as "element vertex 6890", which must begin with `start`.
std::uint64_t count_after(const std::string& path, const std::string& line, const std::string& start)
{
    const std::string digits = line.compare(0, start.size(), start) == 0 ? line.substr(start.size()) : "";
    if (digits.empty() || digits.size() > 10 || digits.find_first_not_of("0123456789") != std::string::npos)
        refuse_mesh(path, "its header has '" + line.substr(0, 60) + "' where '" + start + "' and a number belong");
    return std::stoull(digits);
}

Header parse_header(const std::string& path, const std::string& bytes)
{
    const std::size_t end = bytes.substr(0, header_limit).find("end_header\n");
    if (end == std::string::npos) refuse_mesh(path, "is not a PLY file of `pliant average`");
    std::istringstream lines(bytes.substr(0, end));
    std::string line;
    const auto next = [&] {
        line.clear();
        while (std::getline(lines, line) && line.compare(0, 8, "comment ") == 0) {}
    };
    const auto expect = [&](const std::string& wanted) {
        next();
        if (line != wanted) refuse_mesh(path, "its header has '" + line.substr(0, 60) + "' where '" + wanted + "' belongs");
    };
    Header header;
    header.length = end + std::strlen("end_header\n");
    expect("ply");
    expect("format binary_little_endian 1.0");
    next();
    header.vertex_count = count_after(path, line, "element vertex ");
    for (const char* axis : { "x", "y", "z" }) expect(std::string("property float ") + axis);
    next();
    header.face_count = count_after(path, line, "element face ");
    next();
    if (line == "property list uint int vertex_indices") {
        header.count_bytes = 4;
    } else if (line != "property list uchar int vertex_indices") {
        refuse_mesh(path, "its header has '" + line.substr(0, 60) + "' where the list vertex_indices belongs");
    }
    return header;
}

// The faces must fill the rest of the file exactly.
void check_faces(const std::string& path, const std::string& bytes, const Header& header, std::size_t at)
{
    for (std::uint64_t face = 0; face < header.face_count; ++face) {
        std::uint32_t corners = 0;
        if (bytes.size() - at < header.count_bytes) refuse_mesh(path, "is cut off in face " + std::to_string(face));
        std::memcpy(&corners, &bytes[at], header.count_bytes);
        at += header.count_bytes;
        if (corners < 3) refuse_mesh(path, "face " + std::to_string(face) + " has " + std::to_string(corners) + " corners");
        if ((bytes.size() - at) / 4 < corners) refuse_mesh(path, "is cut off in face " + std::to_string(face));
        at += 4 * static_cast<std::size_t>(corners);
    }
    if (at != bytes.size()) refuse_mesh(path, "has " + std::to_string(bytes.size() - at) + " bytes too many");
}

} // namespace

std::vector<glm::vec3> read_ply_positions(const std::string& path)
{
    const std::string bytes = read_file(path);
    const Header header = parse_header(path, bytes);
    if ((bytes.size() - header.length) / vertex_bytes < header.vertex_count) refuse_mesh(path, "is cut off in its vertices");
    std::vector<glm::vec3> positions(header.vertex_count);
    static_assert(sizeof(glm::vec3) == vertex_bytes, "vertices are copied as they lie in the file");
    if (!positions.empty()) std::memcpy(&positions[0].x, &bytes[header.length], positions.size() * vertex_bytes);
    for (std::size_t v = 0; v < positions.size(); ++v) {
        if (!std::isfinite(positions[v].x) || !std::isfinite(positions[v].y) || !std::isfinite(positions[v].z))
            refuse_mesh(path, "vertex " + std::to_string(v) + " is not finite");
    }
    check_faces(path, bytes, header, header.length + positions.size() * vertex_bytes);
    return positions;
}

Truth::Truth(const std::string& weights_file, const std::string& pattern, const AssetFile& asset)
    : weights_(weights_file, asset.view().weight_count, asset.has_layers())
{
    for (std::size_t i = 0; i < weights_.count(); ++i) {
        const std::string path = numbered_name("--truth", pattern, i);
        shapes_.push_back(read_ply_positions(path));
        if (shapes_.back().size() != asset.view().boundary_vertex_count) {
            throw Error(ErrorNumber::truth_of_another, ExitCode::bad_input,
                        path + ": " + std::to_string(shapes_.back().size()) + " vertices, the render mesh of " + asset.path()
                            + " has " + std::to_string(asset.view().boundary_vertex_count),
                        "average the same poses that the asset was baked from, without --all");
        }
    }
}

std::size_t Truth::nearest(const std::vector<double>& weights) const
{
    std::size_t best = 0;
    double best_distance = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < count(); ++i) {
        double distance = 0.0;
        for (std::size_t k = 0; k < weights.size(); ++k) distance += std::abs(weights[k] - weights_.row(i)[k]);
        if (distance >= best_distance) continue;
        best = i;
        best_distance = distance;
    }
    return best;
}

} // namespace pliant::player
