#include "output/export/draco_mesh.h"

#include "base/common/diagnostics.h"

#include <algorithm>
#include <cmath>
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>
#include <memory>

namespace pliant {

namespace {

// A grid step of 1e-6 of the longest side, a tenth of what an asset's own encoding may cost; seams and flat parts stay as
// they are.
constexpr int position_bits = 20;
constexpr int normal_bits = 12; // below 0.05 degrees

[[noreturn]] void fail(const std::string& what)
{
    throw Failure(ExitCode::failed, error_at(5206, "", "the mesh cannot be compressed: " + what, "leave --draco out"));
}

int add_attribute(draco::Mesh& mesh, draco::GeometryAttribute::Type type, const std::vector<float>& values)
{
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, 3, draco::DT_FLOAT32, false, 3 * sizeof(float), 0);
    const int id = mesh.AddAttribute(attribute, true, std::uint32_t(values.size() / 3));
    for (std::size_t v = 0; v < values.size() / 3; ++v)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(std::uint32_t(v)), &values[3 * v]);
    return id;
}

std::vector<float> decoded_positions(const std::string& bytes, const std::vector<std::uint32_t>& triangles,
                                     std::size_t count)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) fail(decoded.status().error_msg_string());
    const draco::Mesh& mesh = *decoded.value();
    const draco::PointAttribute* attribute = mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    if (!attribute || mesh.num_points() != count || mesh.num_faces() != triangles.size() / 3)
        fail("decoding gives another mesh");
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f)
        for (std::uint32_t c = 0; c < 3; ++c)
            if (mesh.face(draco::FaceIndex(f))[c].value() != triangles[3 * std::size_t(f) + c])
                fail("decoding changes the order of the faces");
    std::vector<float> positions(3 * count);
    for (std::uint32_t v = 0; v < count; ++v)
        attribute->GetMappedValue(draco::PointIndex(v), &positions[3 * std::size_t(v)]);
    return positions;
}

} // namespace

DracoMesh compress_mesh(const std::vector<float>& positions, const std::vector<float>& normals,
                        const std::vector<std::uint32_t>& triangles)
{
    draco::Mesh mesh;
    mesh.set_num_points(std::uint32_t(positions.size() / 3));
    mesh.SetNumFaces(triangles.size() / 3);
    for (std::uint32_t f = 0; f < mesh.num_faces(); ++f) {
        draco::Mesh::Face face;
        for (std::size_t c = 0; c < 3; ++c) face[c] = draco::PointIndex(triangles[3 * std::size_t(f) + c]);
        mesh.SetFace(draco::FaceIndex(f), face);
    }
    const int position = add_attribute(mesh, draco::GeometryAttribute::POSITION, positions);
    const int normal = add_attribute(mesh, draco::GeometryAttribute::NORMAL, normals);
    draco::Encoder encoder;
    encoder.SetEncodingMethod(draco::MESH_SEQUENTIAL_ENCODING);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, position_bits);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::NORMAL, normal_bits);
    draco::EncoderBuffer buffer;
    const draco::Status status = encoder.EncodeMeshToBuffer(mesh, &buffer);
    if (!status.ok()) fail(status.error_msg_string());
    DracoMesh result;
    result.bytes.assign(buffer.data(), buffer.size());
    result.position_id = mesh.attribute(position)->unique_id();
    result.normal_id = mesh.attribute(normal)->unique_id();
    result.positions = decoded_positions(result.bytes, triangles, positions.size() / 3);
    for (std::size_t i = 0; i < positions.size(); ++i)
        result.largest_error = std::max(result.largest_error, std::abs(double(positions[i]) - double(result.positions[i])));
    return result;
}

} // namespace pliant
