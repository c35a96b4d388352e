// Damaged glTF files: random mutations of good ones, in child processes. Whatever the bytes, reading ends within five
// seconds, in meshes whose indices are in range or in numbered diagnostics, and never in a crash, another exception, or much
// memory.
#include <doctest/doctest.h>

#include "../io/mutation_loop.h"
#include "glb_samples.h"
#include "input/poses/pose_source.h"
#include "output/export/glb.h"

#include <array>
#include <cstring>
#include <random>

using namespace pliant;

namespace {

constexpr unsigned mutation_count = 1000; // each; tests/fuzz/campaign.sh tries many more

std::string mutate(std::string bytes, std::mt19937& random)
{
    const auto any = [&](std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random); };
    switch (any(5)) {
    case 0: bytes.resize(any(bytes.size())); break;
    case 1: // random bytes anywhere
        for (std::size_t i = 0, count = 1 + any(8); i < count; ++i) bytes[any(bytes.size())] = static_cast<char>(any(256));
        break;
    case 2: { // extremes of 32-bit fields
        constexpr std::array<std::uint32_t, 6> extremes { 0, 0xffffffff, 0x7fffffff, 0x80000000, 0x7f800000, 0x7fc00000 };
        const std::uint32_t value = extremes[any(extremes.size())];
        std::memcpy(&bytes[any(bytes.size() - 4)], &value, 4);
        break;
    }
    case 3: { // another number in the JSON, of the same length
        std::size_t digit = bytes.find_first_of("0123456789", 20 + any(bytes.size() - 20));
        for (std::size_t i = 0, count = 1 + any(3); i < count && digit != std::string::npos; ++i) {
            bytes[digit] = static_cast<char>('0' + any(10));
            digit = bytes.find_first_of("0123456789", 20 + any(bytes.size() - 20));
        }
        break;
    }
    default: { // bytes of the binary part
        const std::size_t binary = bytes.find("BIN");
        for (std::size_t i = 0, count = 1 + any(6); i < count; ++i)
            bytes[binary + any(bytes.size() - binary)] = static_cast<char>(any(256));
    }
    }
    return bytes;
}

bool is_sane(const MeshFile& mesh)
{
    bool sane = mesh.positions.allFinite() && mesh.faces.offsets.back() == mesh.faces.indices.size();
    for (const std::uint32_t index : mesh.faces.indices) sane &= index < static_cast<std::uint64_t>(mesh.positions.rows());
    return sane;
}

// True if reading did what it promises.
bool read_is_sane(const std::vector<std::string>& arguments)
{
    DiagnosticList diagnostics;
    try {
        const PoseSources poses = read_pose_sources(arguments, Blend::layers, diagnostics);
        for (const MeshFile& mesh : poses.meshes)
            if (!is_sane(mesh)) return false;
        return diagnostics.has_errors() || poses.meshes.size() == poses.count;
    } catch (const Failure& failure) { // a target or an animation may have got another name
        return failure.code() == ExitCode::usage || failure.code() == ExitCode::bad_input;
    } catch (...) {
        return false;
    }
}

// Returns the first mutation that went wrong, or -1. Each batch runs in a child of its own.
int first_failure(const std::string& sample, const std::vector<std::string>& choices)
{
    const pliant_test::TemporaryFolder folder;
    const std::string path = folder / "mutant.glb";
    std::vector<std::string> arguments;
    for (const std::string& choice : choices) arguments.push_back(path + choice);
    return pliant_test::first_failure(path, sample, mutation_count, mutate, [&] { return read_is_sane(arguments); });
}

// The grid in compressed integers, with a morph target, as `pliant export` writes it.
std::string meshopt_glb()
{
    Glb glb({}, true);
    std::vector<std::int16_t> places, moved;
    for (const float x : pliant_test::grid_positions()) {
        places.push_back(static_cast<std::int16_t>(1000 * x));
        moved.push_back(static_cast<std::int16_t>(20 * x));
    }
    Glb::Json primitive;
    primitive["attributes"]["POSITION"] = glb.add_integers(places, 3, gltf_int16, false, true);
    primitive["indices"] = glb.add_indices(pliant_test::grid_corners(), places.size() / 3);
    primitive["targets"].push_back({ { "POSITION", glb.add_integers(moved, 3, gltf_int8, false, true) } });
    glb.json()["meshes"].push_back({ { "primitives", Glb::Json::array({ primitive }) } });
    glb.json()["nodes"].push_back({ { "mesh", 0 }, { "scale", { 0.001, 0.001, 0.001 } } });
    return glb.bytes();
}

} // namespace

TEST_CASE("skin, morph target, animation, texture, sparse accessor")
{
    const std::vector<std::string> choices = { "", "#animation=0@0,0.4,1" };
    const std::string sample = pliant_test::moving_glb();
    {
        const pliant_test::TemporaryFolder folder;
        pliant_test::write_bytes(folder / "a.glb", sample);
        DiagnosticList diagnostics;
        REQUIRE(read_pose_sources({ folder / "a.glb", folder / "a.glb#animation=Run@0,0.4,1" }, Blend::layers, diagnostics)
                    .meshes.size()
                == 5);
        REQUIRE(!diagnostics.has_errors());
    }
    CHECK(first_failure(sample, choices) == -1);
}

TEST_CASE("data of meshoptimizer") { CHECK(first_failure(meshopt_glb(), { "" }) == -1); }

TEST_CASE("Draco data")
{
    const std::size_t n = pliant_test::grid_positions().size() / 3;
    for (const int method : { draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING }) {
        CAPTURE(method);
        CHECK(first_failure(pliant_test::draco_glb(pliant_test::encode_draco(method), n, n), { "" }) == -1);
    }
}
