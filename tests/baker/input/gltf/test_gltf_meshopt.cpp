// Buffer views compressed by EXT_meshopt_compression: every mode and filter gives what meshoptimizer's encoders were given.
#include <doctest/doctest.h>

#include "glb_samples.h"
#include "input/gltf/accessor.h"

#include <cmath>
#include <meshoptimizer.h>

using namespace pliant;

namespace {

using Bytes = std::vector<unsigned char>;

Bytes packed_rows(const void* rows, std::size_t count, std::size_t stride)
{
    Bytes out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), rows, count, stride));
    return out;
}

Bytes packed_sequence(const std::vector<unsigned>& indices)
{
    Bytes out(meshopt_encodeIndexSequenceBound(indices.size(), 100));
    out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
    return out;
}

// A file whose accessor 0 lies in a compressed view of buffer 1, which has no bytes.
std::string file_of(const Bytes& packed, std::size_t count, std::size_t stride, const char* mode, const char* filter,
                    const pliant_test::Json& accessor)
{
    pliant_test::GlbBuilder glb;
    glb.bytes.assign(packed.begin(), packed.end());
    pliant_test::Json view = pliant_test::Json::object(), extension = pliant_test::Json::object();
    extension["buffer"] = 0;
    extension["byteLength"] = packed.size();
    extension["byteStride"] = stride;
    extension["count"] = count;
    extension["mode"] = mode;
    extension["filter"] = filter;
    view["buffer"] = 1;
    view["byteLength"] = count * stride;
    view["extensions"]["EXT_meshopt_compression"] = extension;
    glb.json["bufferViews"].push_back(view);
    glb.json["accessors"].push_back(accessor);
    glb.json["accessors"][0]["bufferView"] = 0;
    glb.json["accessors"][0]["count"] = count;
    glb.more_buffers.push_back({ { "byteLength", count * stride } });
    glb.json["extensionsRequired"].push_back("EXT_meshopt_compression");
    return glb.glb();
}

GltfNumbers numbers_in(const std::string& file, int width)
{
    const GltfDocument document("a.glb", file);
    const GltfJson zero = 0;
    return read_numbers(document, GltfValue(document.path(), zero), { width });
}

// Unit vectors with a fourth number 1.
std::vector<float> directions(std::size_t count)
{
    std::vector<float> out;
    for (std::size_t i = 0; i < count; ++i) {
        const double a = 0.37 * double(i), b = 1 + 0.9 * std::sin(double(i));
        for (const double x : { std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b), 1.0 })
            out.push_back(float(x));
    }
    return out;
}

constexpr std::size_t count = 43; // no multiple of what a processor decodes at a time

} // namespace

TEST_CASE("octahedral, quaternion and exponential filters, and a list of indices")
{
    const std::vector<float> units = directions(count);
    Bytes octahedral(4 * count), quaternions(8 * count), exponential(16 * count);
    meshopt_encodeFilterOct(octahedral.data(), count, 4, 8, units.data());
    std::vector<float> turns = units; // as quaternions: of length 1
    for (float& x : turns) x *= float(std::sqrt(0.5));
    meshopt_encodeFilterQuat(quaternions.data(), count, 8, 14, turns.data());
    meshopt_encodeFilterExp(exponential.data(), count, 16, 20, units.data());
    const auto error = [&](const Bytes& bytes, std::size_t stride, const char* filter, int component, bool is_normalised,
                           const std::vector<float>& wanted) {
        const pliant_test::Json accessor
            = { { "componentType", component }, { "type", "VEC4" }, { "normalized", is_normalised } };
        const std::string file
            = file_of(packed_rows(bytes.data(), count, stride), count, stride, "ATTRIBUTES", filter, accessor);
        const GltfNumbers numbers = numbers_in(file, 4);
        double same = 0, other = 0; // a quaternion's negative is the same rotation
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            const double found = numbers(Eigen::Index(i / 4), Eigen::Index(i % 4));
            same = std::max(same, std::abs(found - double(wanted[i])));
            other = std::max(other, std::abs(std::abs(found) - std::abs(double(wanted[i]))));
        }
        return component == 5122 ? other : same;
    };
    CHECK(error(octahedral, 4, "OCTAHEDRAL", 5120, true, units) < 0.03);
    CHECK(error(quaternions, 8, "QUATERNION", 5122, true, turns) < 1e-3);
    CHECK(error(exponential, 16, "EXPONENTIAL", 5126, false, units) < 1e-5);

    const std::vector<unsigned> indices = { 0, 7, 3, 99, 98, 2, 2 };
    const std::string file = file_of(packed_sequence(indices), indices.size(), 2, "INDICES", "NONE",
                                     { { "componentType", 5123 }, { "type", "SCALAR" } });
    const GltfNumbers found = numbers_in(file, 1);
    for (std::size_t i = 0; i < indices.size(); ++i) CHECK(found(Eigen::Index(i), 0) == indices[i]);
}

TEST_CASE("the step of floats with exponents is in the file, whatever they round to")
{
    std::vector<std::uint32_t> words;
    const auto put = [&](int exponent, int whole) {
        words.push_back(std::uint32_t(exponent) << 24 | (std::uint32_t(whole) & 0xffffff));
    };
    for (int i = 0; i < 8; ++i) { // whole numbers, and a zero that has any exponent
        put(-10, 1024 * i);
        put(-12, -4096 * i);
        put(100, 0);
        put(-11, 2048);
    }
    const auto step = [&](const char* filter, unsigned component_type) {
        const GltfDocument document("a.glb",
                                    file_of(packed_rows(words.data(), 8, 16), 8, 16, "ATTRIBUTES", filter,
                                            { { "componentType", component_type }, { "type", "VEC4" } }));
        const GltfJson zero = 0;
        return step_of(document, GltfValue(document.path(), zero));
    };
    CHECK(step("EXPONENTIAL", gltf_float32) == std::exp2(-10));
    CHECK(step("NONE", gltf_float32) == 0);
    CHECK(step("NONE", gltf_uint16) == 1);
}

TEST_CASE("what is unpacked does not count as bytes of the file")
{
    const std::vector<float> zeros(4 * 4096);
    const Bytes packed = packed_rows(zeros.data(), 4096, 16);
    const std::string file
        = file_of(packed, 4096, 16, "ATTRIBUTES", "NONE", { { "componentType", 5126 }, { "type", "VEC4" } });
    CHECK(packed.size() < 2000);
    CHECK(GltfDocument("a.glb", file).byte_count() == file.size());
}

TEST_CASE("P2331: one array named by many views does not make the reader take more than the bytes of a file can hold")
{
    const std::vector<float> zeros(4 * 16384);
    std::string file = file_of(packed_rows(zeros.data(), 16384, 16), 16384, 16, "ATTRIBUTES", "NONE",
                               { { "componentType", 5126 }, { "type", "VEC4" } });
    CHECK(numbers_in(file, 4).isZero(0));
    const std::size_t json_size = file.find("BIN") - 24;
    pliant_test::Json json = pliant_test::Json::parse(file.substr(20, json_size));
    pliant_test::GlbBuilder many;
    many.bytes = file.substr(28 + json_size);
    many.json = json;
    many.more_buffers.push_back(json["buffers"][1]);
    for (int i = 0; i < 200; ++i) many.json["bufferViews"].push_back(json["bufferViews"][0]);
    const GltfDocument document("a.glb", many.glb());
    try {
        for (std::size_t i = 0; i <= 200; ++i) document.view(i); // each is unpacked at its first use
        FAIL("accepted");
    } catch (const Failure& failure) {
        CHECK(failure.diagnostics()[0].number == 2331);
    }
}
