#include "ply.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <random>
#include <stdexcept>

namespace pliant::creature {
namespace {

void put_u32(std::string& bytes, std::uint32_t value)
{
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(char(value >> shift & 0xff));
}

void put_f32(std::string& bytes, float value)
{
    std::uint32_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    put_u32(bytes, bits);
}

std::string encode(const std::vector<Vec3>& points, const std::vector<Face>& faces)
{
    std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment Pliant example creature\nelement vertex "
        + std::to_string(points.size()) + "\nproperty float x\nproperty float y\nproperty float z\nelement face "
        + std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Vec3& p : points)
        for (int i = 0; i < 3; ++i) put_f32(bytes, float(p[i]));
    for (const Face& f : faces) {
        bytes.push_back(3);
        for (std::int32_t v : f) put_u32(bytes, std::uint32_t(v));
    }
    return bytes;
}

[[noreturn]] void fail(const std::string& path, const char* action, int error)
{
    throw std::runtime_error(path + ": cannot " + action + ": " + std::strerror(error));
}

void write_file(const std::string& path, const std::string& bytes)
{
    std::FILE* file = std::fopen(path.c_str(), "wbx"); // never a file that is there
    if (!file) fail(path, "create", errno);
    // A full disk may show only when buffers are flushed or the file is closed.
    bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() && std::fflush(file) == 0;
    int error = errno;
    if (std::fclose(file) != 0 && written) {
        written = false;
        error = errno;
    }
    if (written) return;
    std::remove(path.c_str());
    fail(path, "write", error);
}

// Removes the remaining temporary files when it goes out of scope.
struct Temporaries {
    std::vector<std::string> paths;
    ~Temporaries()
    {
        for (const std::string& path : paths) std::remove(path.c_str());
    }
};

} // namespace

void write_ply_set(const std::vector<PlyFile>& files, const std::vector<Face>& faces)
{
    for (const PlyFile& file : files)
        if (std::filesystem::is_directory(file.path)) fail(file.path, "replace", EISDIR);
    Temporaries written;
    const std::string ending = '.' + std::to_string(std::random_device()()) + ".tmp"; // a name that nobody else has
    for (const PlyFile& file : files) {
        const std::string temporary = file.path + ending;
        write_file(temporary, encode(file.points, faces));
        written.paths.push_back(temporary);
    }
    for (const PlyFile& file : files) {
        if (std::rename(written.paths.front().c_str(), file.path.c_str()) != 0) fail(file.path, "replace", errno);
        written.paths.erase(written.paths.begin());
    }
}

} // namespace pliant::creature
