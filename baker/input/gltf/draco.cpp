#include "input/gltf/draco.h"

#include "base/common/trial.h"
#include "input/gltf/render_scene.h"
#include "input/io/source_file.h"

#include <algorithm>
#include <cmath>
#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <exception>
#include <fmt/format.h>
#include <functional>
#include <memory>
#include <set>

namespace pliant {
namespace {

constexpr const char* damaged = "the file is damaged: compress it again from the original";

std::uint32_t number_in(draco::DecoderBuffer& buffer, bool is_varint)
{
    std::uint32_t number = 0;
    const bool is_there = is_varint ? draco::DecodeVarint(&number, &buffer) : buffer.Decode(&number);
    return is_there ? number : 0;
}

// Behind the header.
struct Declared {
    std::uint32_t vertex_count = 0, face_count = 0; // of a sequential stream 0: it has three bytes for each face
    std::uint8_t seam_count = 0;                    // attributes with seams
    std::uint64_t table_count = 1;                  // of the symbols of the triangles
};

Declared declared_in(const draco::DracoHeader& header, draco::DecoderBuffer buffer)
{
    const std::uint16_t version = DRACO_BITSTREAM_VERSION(header.version_major, header.version_minor);
    buffer.set_bitstream_version(version);
    const bool is_varint = version >= DRACO_BITSTREAM_VERSION(2, 0);
    std::uint8_t traversal = 0;
    Declared declared;
    buffer.Decode(&traversal);
    if (version < DRACO_BITSTREAM_VERSION(2, 2)) number_in(buffer, is_varint);
    declared.vertex_count = number_in(buffer, is_varint);
    declared.face_count = number_in(buffer, is_varint);
    buffer.Decode(&declared.seam_count);
    declared.table_count = traversal == draco::MESH_EDGEBREAKER_VALENCE_ENCODING ? 6 : 0;
    return declared;
}

// Charges all attributes before it decodes them: together they can be much larger than the stream.
template <class Base> class AllowedDecoder final : public Base {
public:
    AllowedDecoder(const GltfValue& extension, GltfAllowance& allowance, std::exception_ptr& refusal)
        : extension_(extension)
        , allowance_(allowance)
        , refusal_(refusal)
    {
    }

private:
    bool DecodeAllAttributes() override
    {
        constexpr std::uint64_t numbers_of_attribute = 8000; // of a few bytes: the time for a table of a million entries
        std::uint64_t width = 0;
        for (int a = 0; a < this->mesh()->num_attributes(); ++a)
            width += static_cast<std::uint64_t>(this->mesh()->attribute(a)->num_components());
        try {
            allowance_.take(extension_, this->mesh()->num_points(), std::max<std::uint64_t>(width, 1));
            allowance_.take(extension_, static_cast<std::uint64_t>(this->mesh()->num_attributes()), numbers_of_attribute);
        } catch (...) {
            refusal_ = std::current_exception(); // for Draco's own frames
            return false;
        }
        return Base::DecodeAllAttributes();
    }

    const GltfValue& extension_;
    GltfAllowance& allowance_;
    std::exception_ptr& refusal_;
};

// Of a stream, before it is decoded.
void charge(const GltfValue& extension, std::size_t size, bool has_own_bytes, const Declared& declared,
            GltfAllowance& allowance)
{
    // Draco makes its tables for as many as an edgebreaker stream says, before it decodes one of them.
    allowance.take(extension, std::max(declared.vertex_count, declared.face_count), std::uint64_t(declared.seam_count) + 3);
    // A few bytes ask for a table of a million entries. Good streams that have tables are not shorter.
    constexpr std::uint64_t bytes_of_table = 600, numbers_of_byte = 8;
    const std::uint64_t least = bytes_of_table * declared.table_count;
    if (size < least) allowance.take(extension, least - size, numbers_of_byte);
    // Streams that share their bytes, as views may, pay again for them.
    if (!has_own_bytes) allowance.take(extension, std::max<std::uint64_t>(size, least) + least, numbers_of_byte);
}

// A mesh, or why there is none.
struct Decoded {
    std::unique_ptr<draco::Mesh> mesh;
    std::vector<double> steps; // per attribute, of the grid that it was rounded to; 0: none
    std::string reason;
};

double step_of(const draco::PointAttribute* portable)
{
    draco::AttributeQuantizationTransform rounding;
    if (!portable || !rounding.InitFromAttribute(*portable)) return 0;
    const double step = double(rounding.range()) / (std::exp2(rounding.quantization_bits()) - 1);
    return std::isfinite(step) && step > 0 ? step : 0;
}

template <class Decoder> Decoded decode_by(const GltfValue& extension, draco::DecoderBuffer buffer, GltfAllowance& allowance)
{
    std::exception_ptr refusal;
    AllowedDecoder<Decoder> decoder(extension, allowance, refusal);
    Decoded out { std::make_unique<draco::Mesh>(), {}, {} };
    try {
        const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, out.mesh.get());
        if (status.ok()) {
            for (int a = 0; a < out.mesh->num_attributes(); ++a)
                out.steps.push_back(step_of(decoder.GetPortableAttribute(a)));
            return out;
        }
        out.reason = status.error_msg_string();
    } catch (const std::exception& error) { // damaged counts ask for impossible vectors
        out.reason = error.what();
    }
    if (refusal) std::rethrow_exception(refusal);
    out.mesh = nullptr;
    return out;
}

// Crafted streams take Draco time that grows with the square of their size, and memory of 750 times it. Of small ones that
// is little; others are tried in a child process first, with many times of what a good stream needs.
void require_bounded(const GltfValue& extension, std::size_t size, std::uint32_t face_count,
                     const std::function<void()>& decode)
{
    constexpr std::size_t small_size = 1 << 16;
    constexpr std::uint32_t small_face_count = 4096;
    if (size <= small_size && face_count <= small_face_count) return;
    const double faces = std::min(double(face_count), 8.0 * double(size)); // each has a bit at least
    const double seconds = 0.2 + 1e-5 * faces + 1e-6 * double(size), bytes = 1e8 + 500.0 * faces + 20.0 * double(size);
    if (is_bounded(seconds, bytes, decode)) return;
    extension.fail(
        2318,
        fmt::format("its Draco data cannot be decoded: {} bytes for {} faces take more than {:.1f} s or {:.0f} MB", size,
                    face_count, seconds, bytes / 1e6),
        damaged);
}

Decoded decode(const GltfValue& extension, std::string_view bytes, bool has_own_bytes, GltfAllowance& allowance)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::DracoHeader header;
    draco::DecoderBuffer behind_header = buffer;
    if (!draco::PointCloudDecoder::DecodeHeader(&behind_header, &header).ok()
        || header.encoder_type != draco::TRIANGULAR_MESH)
        extension.fail(2318, "its Draco data do not hold a triangle mesh", damaged);
    if (header.flags & METADATA_FLAG_MASK)
        extension.fail(2318, "its Draco data hold metadata, which glTF has no use for", "compress it again without them");
    const bool is_edgebreaker = header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING;
    if (!is_edgebreaker && header.encoder_method != draco::MESH_SEQUENTIAL_ENCODING)
        extension.fail(2318, "its Draco data are of an unknown method", damaged);
    const Declared declared = is_edgebreaker ? declared_in(header, behind_header) : Declared();
    charge(extension, bytes.size(), has_own_bytes, declared, allowance);
    const auto decoded_mesh = [&] {
        return is_edgebreaker ? decode_by<draco::MeshEdgebreakerDecoder>(extension, buffer, allowance)
                              : decode_by<draco::MeshSequentialDecoder>(extension, buffer, allowance);
    };
    require_bounded(extension, bytes.size(), declared.face_count, decoded_mesh);
    Decoded decoded = decoded_mesh();
    if (!decoded.mesh) extension.fail(2318, fmt::format("its Draco data cannot be decoded: {}", decoded.reason), damaged);
    return decoded;
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
    if (attribute.num_components() < 1 || attribute.num_components() > 4) return false;
    if (attribute.data_type() == draco::DT_BOOL) return false; // its bytes need not be one; glTF has no such type
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
    const Decoded decoded = decode(extension, bytes, allowance.has_own(bytes.size()), allowance);
    const draco::Mesh* const mesh = decoded.mesh.get();
    DracoMesh out;
    out.vertex_count = mesh->num_points();
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
    std::set<std::uint32_t> unpacked;
    for (const auto& [name, id_json] : ids.json().items()) {
        if (!is_read_attribute(name)) continue;
        const GltfValue id = ids[name];
        // Unique ids have no count; what is not there is found out next.
        const std::uint32_t unique_id = static_cast<std::uint32_t>(id.index(std::size_t(1) << 31, "attributes"));
        const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(unique_id);
        if (!attribute || !is_sound(*mesh, *attribute))
            id.fail(2318, fmt::format("its Draco data do not hold the attribute {}", excerpt(name)), damaged);
        if (!unpacked.insert(unique_id).second) // the first use was charged when it was decoded
            allowance.take(id, mesh->num_points(), std::uint64_t(attribute->num_components()));
        const GltfValue accessor = attributes[name];
        const bool is_normalised = accessor.exists() && accessor_shape(document, accessor).is_normalised;
        out.attributes.emplace(name, numbers_of(*mesh, *attribute, is_normalised));
        out.steps[name] = decoded.steps[static_cast<std::size_t>(mesh->GetAttributeIdByUniqueId(unique_id))];
    }
    return out;
}

} // namespace pliant
