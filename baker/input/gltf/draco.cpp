#include "input/gltf/draco.h"

#include "input/gltf/render_scene.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>
#include <exception>
#include <fmt/format.h>
#include <memory>

namespace pliant {
namespace {

constexpr const char* damaged = "the file is damaged: compress it again from the original";

std::uint32_t number_in(draco::DecoderBuffer& buffer, bool is_varint)
{
    std::uint32_t number = 0;
    const bool is_there = is_varint ? draco::DecodeVarint(&number, &buffer) : buffer.Decode(&number);
    return is_there ? number : 0;
}

// Draco makes its tables for as many faces, vertices and attributes as the stream says, before it decodes one of them. What
// is no stream is left to the decoder.
void take_declared(const GltfValue& extension, draco::DecoderBuffer buffer, GltfAllowance& allowance)
{
    draco::DracoHeader header;
    draco::GeometryMetadata metadata;
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return;
    const std::uint16_t version = DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor);
    buffer.set_bitstream_version(version);
    if ((header.flags & METADATA_FLAG_MASK) && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return;
    if (header.encoder_method != draco::MESH_EDGEBREAKER_ENCODING) return; // others have bytes for each face, or fail
    const bool is_varint = version >= DRACO_BITSTREAM_VERSION(2, 0);
    std::uint8_t traversal = 0, attribute_count = 0;
    buffer.Decode(&traversal);
    if (version < DRACO_BITSTREAM_VERSION(2, 2)) number_in(buffer, is_varint);
    const std::uint32_t vertex_count = number_in(buffer, is_varint), face_count = number_in(buffer, is_varint);
    buffer.Decode(&attribute_count);
    allowance.take(extension, std::max(vertex_count, face_count), std::uint64_t(attribute_count) + 3);
}

std::unique_ptr<draco::Mesh> decode(const GltfValue& extension, std::string_view bytes, GltfAllowance& allowance)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    take_declared(extension, buffer, allowance);
    const auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!type.ok() || type.value() != draco::TRIANGULAR_MESH)
        extension.fail(2318, "its Draco data do not hold a triangle mesh", damaged);
    draco::Decoder decoder;
    std::string reason;
    try {
        auto result = decoder.DecodeMeshFromBuffer(&buffer);
        if (result.ok()) return std::move(result).value();
        reason = result.status().error_msg_string();
    } catch (const std::exception& error) { // damaged counts ask for impossible vectors
        reason = error.what();
    }
    extension.fail(2318, fmt::format("its Draco data cannot be decoded: {}", reason), damaged);
}

GltfNumbers numbers_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute, bool is_normalised)
{
    const int components = attribute.num_components();
    GltfNumbers numbers(static_cast<Eigen::Index>(mesh.num_points()), components);
    // Whether integers are to be divided is glTF's to say, not Draco's.
    draco::GeometryAttribute raw = attribute;
    raw.set_normalized(false);
    for (draco::PointIndex i(0); i < mesh.num_points(); ++i)
        raw.ConvertValue<double>(attribute.mapped_index(i), static_cast<std::int8_t>(components),
                                 numbers.row(static_cast<Eigen::Index>(i.value())).data());
    if (!is_normalised) return numbers;
    switch (attribute.data_type()) {
    case draco::DT_INT8: return (numbers / 127).cwiseMax(-1);
    case draco::DT_UINT8: return numbers / 255;
    case draco::DT_INT16: return (numbers / 32767).cwiseMax(-1);
    case draco::DT_UINT16: return numbers / 65535;
    default: return numbers;
    }
}

// Draco checks its tables of values against its own counts, not for every kind of mapping: a value that is not there must
// not be read.
bool is_sound(const draco::Mesh& mesh, const draco::PointAttribute& attribute)
{
    if (attribute.num_components() < 1 || attribute.num_components() > 16) return false;
    for (draco::PointIndex i(0); i < mesh.num_points(); ++i)
        if (attribute.mapped_index(i).value() >= attribute.size()) return false;
    return true;
}

bool is_read_attribute(std::string_view name)
{
    const std::string_view set = name.substr(0, name.empty() ? 0 : name.size() - 1);
    const bool is_influence
        = (set == "JOINTS_" || set == "WEIGHTS_") && name.back() >= '0' && name.back() < '0' + influence_set_count;
    return name == "POSITION" || is_influence || is_drawn_attribute(name);
}

} // namespace

DracoMesh decode_draco(const GltfDocument& document, const GltfValue& extension, const GltfValue& attributes,
                       GltfAllowance& allowance)
{
    const std::size_t view = extension["bufferView"].index(document["bufferViews"].size(), "buffer views");
    const std::string_view bytes = document.view(view);
    allowance.take(extension, bytes.size()); // also of what is decoded and not read
    const std::unique_ptr<draco::Mesh> mesh = decode(extension, bytes, allowance);
    DracoMesh out;
    out.vertex_count = mesh->num_points();
    allowance.take(extension, mesh->num_faces(), 3);
    out.triangles.reserve(mesh->num_faces());
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f) {
        const draco::Mesh::Face& face = mesh->face(f);
        const Triangle triangle { face[0].value(), face[1].value(), face[2].value() };
        for (const std::uint32_t v : triangle)
            if (v >= out.vertex_count) extension.fail(2318, "its Draco data use vertices that they do not have", damaged);
        out.triangles.push_back(triangle);
    }
    const GltfValue ids = extension["attributes"];
    if (!ids.exists() || !ids.json().is_object()) ids.fail(2306, "an object expected");
    for (const auto& [name, id_json] : ids.json().items()) {
        if (!is_read_attribute(name)) continue;
        const GltfValue id = ids[name.c_str()];
        const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(static_cast<std::uint32_t>(
            id.index(std::size_t(1) << 31, "attributes"))); // unique ids have no count; what is not there is found out next
        if (!attribute || !is_sound(*mesh, *attribute))
            id.fail(2318, fmt::format("its Draco data do not hold the attribute {}", excerpt(name)), damaged);
        allowance.take(id, out.vertex_count, static_cast<std::uint64_t>(attribute->num_components()));
        const GltfValue accessor = attributes[name.c_str()];
        const bool is_normalised = accessor.exists() && accessor_shape(document, accessor).is_normalised;
        out.attributes.emplace(name, numbers_of(*mesh, *attribute, is_normalised));
    }
    return out;
}

} // namespace pliant
