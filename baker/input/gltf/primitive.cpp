#include "input/gltf/primitive.h"

#include "input/gltf/draco.h"
#include "input/gltf/render_scene.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace pliant {
namespace {

enum Mode : std::uint64_t { points = 0, triangles = 4, strip = 5, fan = 6 };

// Corners as triangles; what is left over at the end of a list is dropped, as GPUs do.
std::vector<Triangle> assemble(const std::vector<std::uint32_t>& corners, std::uint64_t mode)
{
    std::vector<Triangle> out;
    if (mode == triangles) {
        out.reserve(corners.size() / 3);
        for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
            out.push_back({ corners[i], corners[i + 1], corners[i + 2] });
        return out;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        // glTF 2.0, section 3.7.2.1: every second triangle of a strip runs the other way; strips repeat corners to jump.
        const Triangle t = mode == fan ? Triangle { corners[i + 1], corners[i + 2], corners[0] }
                                       : Triangle { corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2] };
        if (t[0] != t[1] && t[1] != t[2] && t[0] != t[2]) out.push_back(t);
    }
    return out;
}

void read_plain(const GltfDocument& document, const GltfValue& primitive, GltfAllowance& allowance, GltfPrimitive& out)
{
    const GltfValue position = primitive["attributes"]["POSITION"];
    const AccessorShape shape = accessor_shape(document, position);
    const GltfValue index_value = primitive["indices"];
    const std::uint64_t corner_count = index_value.exists() ? accessor_shape(document, index_value).count : shape.count;
    const std::uint64_t mode = primitive["mode"].whole_or(triangles);
    allowance.take_all_of(position);
    allowance.take(index_value.exists() ? index_value : position, corner_count, mode == triangles ? 1 : 3);
    out.positions = read_numbers(document, position, { 3 });
    out.position_step = step_of(document, position);
    if (shape.is_normalised && shape.component_type == gltf_int16) out.short_bits = 15;
    if (shape.is_normalised && shape.component_type == gltf_uint16) out.short_bits = 16;
    std::vector<std::uint32_t> corners;
    if (index_value.exists()) {
        corners = read_indices(document, index_value, 1);
    } else {
        corners.resize(static_cast<std::size_t>(shape.count));
        std::iota(corners.begin(), corners.end(), 0u);
    }
    for (std::size_t i = 0; i < corners.size(); ++i)
        if (corners[i] >= shape.count)
            index_value.fail(2315, fmt::format("corner {} is vertex {}, there are {}", i, corners[i], shape.count));
    out.triangles = assemble(corners, mode);
}

// The attributes of a primitive, from its Draco data if they are there.
struct AttributeReader {
    const GltfDocument& document;
    const GltfValue& attributes;
    const DracoMesh& draco;
    std::uint64_t vertex_count;
    GltfAllowance& allowance;

    GltfNumbers read(const std::string& name, std::initializer_list<int> components) const
    {
        const auto decoded = draco.attributes.find(name);
        const GltfValue attribute = attributes[name];
        if (decoded == draco.attributes.end()) {
            allowance.take_all_of(attribute);
            return read_numbers(document, attribute, components, vertex_count);
        }
        const GltfNumbers& numbers = decoded->second;
        if (std::find(components.begin(), components.end(), static_cast<int>(numbers.cols())) == components.end())
            attribute.fail(2311, fmt::format("has elements of {} numbers, which does not fit here", numbers.cols()));
        return numbers;
    }

    GltfNumbers read_drawn(const std::string& name) const
    {
        if (name == "NORMAL") return read(name, { 3 });
        return name[0] == 'T' ? read(name, { 2 }) : read(name, { 3, 4 });
    }
};

// Whatever is not a number of a joint (negative, or of a normalized accessor) becomes one that no skin has.
std::uint32_t joint_of(double number)
{
    const bool is_joint = number >= 0 && number <= 65535 && number == std::floor(number);
    return is_joint ? static_cast<std::uint32_t>(number) : UINT32_MAX;
}

void read_influences(const AttributeReader& reader, GltfPrimitive& out)
{
    std::vector<GltfNumbers> joints, weights;
    for (int k = 0; k < influence_set_count && reader.attributes[fmt::format("JOINTS_{}", k).c_str()].exists(); ++k) {
        joints.push_back(reader.read(fmt::format("JOINTS_{}", k), { 4 }));
        weights.push_back(reader.read(fmt::format("WEIGHTS_{}", k), { 4 }));
    }
    const Eigen::Index columns = 4 * static_cast<Eigen::Index>(joints.size());
    out.weights.resize(out.positions.rows(), columns);
    out.joints.reserve(static_cast<std::size_t>(out.weights.size()));
    for (std::size_t k = 0; k < weights.size(); ++k)
        out.weights.middleCols(4 * static_cast<Eigen::Index>(k), 4) = weights[k];
    for (Eigen::Index v = 0; v < out.positions.rows(); ++v)
        for (const GltfNumbers& set : joints)
            for (int c = 0; c < 4; ++c) out.joints.push_back(joint_of(set(v, c)));
}

// The corners of a box behind the vertices, and their triangle. Where another program has moved vertices, a face has one of
// the last two, and nothing is left out.
void leave_out_box(const GltfValue& primitive, GltfPrimitive& out)
{
    const GltfValue extras = primitive["extras"];
    if (!extras.exists() || !extras.json().is_object()) return;
    const GltfValue ours = extras["pliant"];
    if (!ours.exists() || !ours.json().is_object()) return;
    const std::uint64_t own_count = ours["vertex_count"].whole_or(out.vertex_count());
    if (own_count + 2 != out.vertex_count()) return;
    const auto count = static_cast<Eigen::Index>(own_count);
    const auto is_own = [&](const Triangle& t) { return std::max({ t[0], t[1], t[2] }) < count; };
    const auto box = std::partition(out.triangles.begin(), out.triangles.end(), is_own);
    if (std::any_of(box, out.triangles.end(), [&](const Triangle& t) { return std::min({ t[0], t[1], t[2] }) < count; }))
        return;
    out.triangles.erase(box, out.triangles.end());
    out.positions.conservativeResize(count, Eigen::NoChange);
    out.weights.conservativeResize(count, Eigen::NoChange);
    out.joints.resize(static_cast<std::size_t>(out.weights.size()));
    for (auto& attribute : out.attributes) attribute.second.conservativeResize(count, Eigen::NoChange);
}

} // namespace

bool has_triangles(const GltfValue& primitive)
{
    const std::uint64_t mode = primitive["mode"].whole_or(triangles);
    if (mode > fan) primitive["mode"].fail(2306, fmt::format("there is no mode {}", mode));
    return mode >= triangles;
}

std::uint64_t GltfPrimitive::number_count() const
{
    std::uint64_t width = 3;
    for (const auto& attribute : attributes) width += static_cast<std::uint64_t>(attribute.second.cols());
    return width * vertex_count() + 3 * triangles.size();
}

GltfPrimitive read_primitive(const GltfDocument& document, const GltfValue& primitive, GltfAllowance& allowance)
{
    GltfPrimitive out(primitive["targets"]);
    const GltfValue attributes = primitive["attributes"];
    if (!attributes.exists() || !attributes.json().is_object()) attributes.fail(2306, "an object expected");
    out.material = primitive["material"].index_or_none(document["materials"].size(), "materials");
    const GltfValue extension = primitive["extensions"]["KHR_draco_mesh_compression"];
    DracoMesh draco;
    if (extension.exists()) {
        draco = decode_draco(document, extension, attributes, allowance);
        out.triangles = std::move(draco.triangles);
        const auto positions = draco.attributes.find("POSITION");
        if (positions == draco.attributes.end() || positions->second.cols() != 3)
            extension.fail(2318, "its Draco data have no positions", "compress it again from the original");
        out.positions = std::move(positions->second);
        out.position_step = draco.steps["POSITION"];
        for (const auto& [name, step] : draco.steps)
            if (name.rfind("WEIGHTS_", 0) == 0) out.weight_step = std::max(out.weight_step, step);
        draco.attributes.erase(positions);
    } else {
        read_plain(document, primitive, allowance, out);
    }
    const AttributeReader reader { document, attributes, draco, out.vertex_count(), allowance };
    for (const auto& item : attributes.json().items())
        if (is_drawn_attribute(item.key())) out.attributes.emplace(item.key(), reader.read_drawn(item.key()));
    read_influences(reader, out);
    out.stored_count = out.vertex_count();
    leave_out_box(primitive, out);
    constexpr std::uint64_t numbers_of_target = 96; // its name, and a look for what it moves
    if (out.targets.size() != 0) allowance.take(out.targets, out.targets.size(), numbers_of_target);
    return out;
}

} // namespace pliant
