// Damaged files: random mutations of good ones, in child processes. Whatever the bytes, reading ends within five seconds, in
// a mesh whose indices are in range or in numbered diagnostics, and never in a crash, another exception, or a failed
// allocation.
#include <doctest/doctest.h>

#include "input/io/encode_ply.h"
#include "input/io/read_mesh.h"
#include "input/poses/load_poses.h"
#include "mutation_loop.h"
#include "solid_samples.h"

#include <array>
#include <cmath>
#include <cstring>
#include <random>

using namespace pliant;

namespace {

constexpr unsigned mutation_count = 3000;

std::string sample_obj()
{
    std::string text = "# sample\no thing\n";
    char line[128];
    for (int i = 0; i < 40; ++i) {
        std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", std::cos(0.3 * i), std::sin(0.3 * i), 0.05 * i);
        text += line;
    }
    for (int i = 1; i < 38; ++i)
        text += "f " + std::to_string(i) + "/1 " + std::to_string(i + 1) + "//2 -" + std::to_string(i) + "\n";
    return text + "f 1 2 3 4 5\\\n 6\n";
}

std::string sample_off()
{
    std::string text = "OFF\n# sample\n40 38 0\n";
    for (int i = 0; i < 40; ++i) text += std::to_string(0.25 * i) + " " + std::to_string(i % 7) + " 1e-3\n";
    for (int i = 0; i < 38; ++i)
        text += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " 255 0 0\n";
    return text;
}

std::string sample_ply(const char* format)
{
    Positions positions(40, 3);
    Polygons polygons;
    for (int i = 0; i < 40; ++i) positions.row(i) << 0.25 * i, i % 7, 0.5;
    for (std::uint32_t i = 0; i < 38; ++i) {
        polygons.indices.insert(polygons.indices.end(), { i, i + 1, i + 2 });
        polygons.offsets.push_back(3 * i + 3);
    }
    std::string bytes = encode_ply(positions, polygons);
    if (std::string(format) == "binary") return bytes;
    std::string text = bytes.substr(0, bytes.find("end_header\n") + 11);
    text.replace(text.find("binary_little_endian"), 20, "ascii");
    for (int i = 0; i < 40; ++i) text += std::to_string(0.25 * i) + " " + std::to_string(i % 7) + " 0.5\n";
    for (int i = 0; i < 38; ++i)
        text += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
    return text;
}

std::string mutate(std::string bytes, std::mt19937& random)
{
    const auto any = [&](std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random); };
    const std::size_t header = std::min<std::size_t>(bytes.size(), 300);
    switch (any(6)) {
    case 0: bytes.resize(any(bytes.size())); break;
    case 1: // random bytes anywhere
        for (std::size_t i = 0, count = 1 + any(8); i < count; ++i) bytes[any(bytes.size())] = static_cast<char>(any(256));
        break;
    case 2: // random bytes in the header
        for (std::size_t i = 0, count = 1 + any(4); i < count; ++i) bytes[any(header)] = static_cast<char>(any(256));
        break;
    case 3: { // extremes of 32-bit fields
        constexpr std::array<std::uint32_t, 6> extremes { 0, 0xffffffff, 0x7fffffff, 0x80000000, 0x7f800000, 0x7fc00000 };
        const std::uint32_t value = extremes[any(extremes.size())];
        std::memcpy(&bytes[any(bytes.size() - 4)], &value, 4);
        break;
    }
    case 4: { // extremes of numbers in text
        constexpr std::array<const char*, 9> extremes { "4294967295", "-1",       "99999999999999999999",
                                                        "1e999",      "nan",      "2147483648",
                                                        "0",          "67108865", "-9223372036854775808" };
        const std::size_t digit = bytes.find_first_of("0123456789", any(bytes.size()));
        if (digit != std::string::npos) bytes.replace(digit, 1, extremes[any(extremes.size())]);
        break;
    }
    default: { // a piece twice, or a piece lost
        const std::size_t from = any(bytes.size()), size = any(std::min<std::size_t>(bytes.size() - from, 64) + 1);
        if (any(2) == 0)
            bytes.insert(any(bytes.size()), bytes.substr(from, size));
        else
            bytes.erase(from, size);
    }
    }
    return bytes;
}

// True if reading did what it promises.
bool read_is_sane(const std::string& path)
{
    DiagnosticList diagnostics;
    try {
        const std::optional<MeshFile> mesh = read_mesh(path, diagnostics);
        if (!mesh) return diagnostics.has_errors();
        bool is_sane = mesh->positions.allFinite() && mesh->faces.offsets.back() == mesh->faces.indices.size();
        for (const std::uint32_t index : mesh->faces.indices)
            is_sane &= index < static_cast<std::uint64_t>(mesh->positions.rows());
        for (const Tetrahedron& tet : mesh->tets) {
            for (const std::uint32_t index : tet) is_sane &= index < static_cast<std::uint64_t>(mesh->positions.rows());
        }
        if (!is_sane) return false;
        load_poses({ path, path }); // always the same pose twice: must throw, and a Failure
        return false;
    } catch (const Failure& failure) {
        return failure.code() == ExitCode::bad_input;
    } catch (...) {
        return false;
    }
}

// Returns the first mutation that went wrong, or -1. Each batch runs in a child of its own.
int first_failure(const std::string& extension, const std::string& sample)
{
    const pliant_test::TemporaryFolder folder;
    const std::string path = folder / ("mutant" + extension);
    return pliant_test::first_failure(path, sample, mutation_count, mutate, [&] { return read_is_sane(path); });
}

} // namespace

TEST_CASE("OBJ") { CHECK(first_failure(".obj", sample_obj()) == -1); }
TEST_CASE("OFF") { CHECK(first_failure(".off", sample_off()) == -1); }
TEST_CASE("PLY, text") { CHECK(first_failure(".ply", sample_ply("ascii")) == -1); }
TEST_CASE("PLY, binary") { CHECK(first_failure(".ply", sample_ply("binary")) == -1); }
TEST_CASE("solids, every layout of every format")
{
    for (const pliant_test::Sample& sample : pliant_test::solid_samples()) {
        CAPTURE(sample.name);
        CHECK(first_failure(sample.file.substr(1), sample.bytes) == -1);
    }
}
