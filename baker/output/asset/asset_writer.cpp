#include "output/asset/asset_writer.h"

#include "base/mesh/smoothing_groups.h"
#include "output/asset/bytes.h"
#include "output/asset/element_batches.h"
#include "pliant_format.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <zlib.h>

namespace pliant {

namespace {

constexpr std::size_t pad16(std::size_t count) { return (count + 15) / 16 * 16; }

template <class Vector> void put_padded(Bytes& out, const Vector& values)
{
    for (Eigen::Index i = 0; i < values.size(); ++i) out.put_float(values[i]);
    for (std::size_t i = std::size_t(values.size()); i < pad16(std::size_t(values.size())); ++i) out.put_float(0);
}

pliant_format_count count_record(std::size_t count)
{
    pliant_format_count record {};
    record.count = std::uint32_t(count);
    return record;
}

Bytes encode_solver(const AssetModel& asset)
{
    Bytes out;
    pliant_format_solver head {};
    head.energy_scale = float(asset.model.energy_scale);
    out.put(head);
    const Frame& frame = asset.shape.frame;
    const Eigen::MatrixXd whitening = frame.axes.transpose() * asset.model.whitening;
    put_padded(out, frame.stored(asset.model.mean));
    for (Eigen::Index j = 0; j < whitening.cols(); ++j) put_padded(out, whitening.col(j));
    for (Eigen::Index k = 0; k < asset.subspace.pose_coordinates.cols(); ++k)
        put_padded(out, frame.stored(asset.subspace.pose_coordinates.col(k)));
    return out;
}

// What layers change in the numbers of a batch.
void put_changes(Bytes& out, pliant_format_batch& record, const ElementBatch& batch)
{
    const std::vector<LayerChange> changes = changes_of(batch);
    record.changes_offset = out.data.size();
    record.change_count = std::uint32_t(changes.size());
    for (const LayerChange& change : changes) out.put(pliant_format_change { change.layer, change.group });
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    for (const LayerChange& change : changes)
        for (Eigen::Index c = 0; c < batch[0].element.pose_numbers.cols(); ++c)
            for (std::size_t i = 0; i < PLIANT_FORMAT_LANES; ++i) {
                const std::size_t lane = PLIANT_FORMAT_LANES * change.group + i;
                out.put_float(lane < batch.size() ? batch[lane].element.pose_numbers(1 + Eigen::Index(change.layer), c)
                                                  : 0.0);
            }
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
}

// Arrays of one batch, lane by lane; lanes past the last element repeat it without stiffness.
void put_batch(Bytes& out, pliant_format_batch& record, const ElementBatch& batch, Blend blend)
{
    const std::size_t lanes = pad16(batch.size());
    BakedElement padding = batch.back();
    padding.element.scale(0);
    padding.element.pose_numbers.array() += 0.0; // no negative zeros
    const auto lane = [&](std::size_t i) -> const BakedElement& { return i < batch.size() ? batch[i] : padding; };
    record.rows_offset = out.data.size();
    for (Eigen::Index j = 0; j < batch[0].rows.cols(); ++j)
        for (Eigen::Index r = 0; r < batch[0].rows.rows(); ++r)
            for (std::size_t i = 0; i < lanes; ++i) out.put_float(lane(i).rows(r, j));
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    record.fixed_offset = out.data.size();
    for (std::size_t f = 0; f < batch[0].element.fixed.size(); ++f)
        for (std::size_t i = 0; i < lanes; ++i) out.put_float(lane(i).element.fixed[f]);
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    record.pose_offset = out.data.size();
    const Eigen::MatrixXd& numbers = batch[0].element.pose_numbers;
    for (Eigen::Index k = 0; k < (blend == Blend::layers ? 1 : numbers.rows()); ++k)
        for (Eigen::Index c = 0; c < numbers.cols(); ++c)
            for (std::size_t i = 0; i < lanes; ++i) out.put_float(lane(i).element.pose_numbers(k, c));
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    if (blend == Blend::layers) put_changes(out, record, batch);
}

Bytes encode_elements(const AssetModel& asset)
{
    std::vector<BakedElement> elements;
    for (std::size_t i = 0; i < asset.model.surrogate->element_count(); ++i) elements.push_back(bake_element(asset, i));
    for (BakedElement& held : bake_gauge(asset)) elements.push_back(std::move(held));
    const Blend blend = asset.domain.blend();
    const std::vector<ElementBatch> batches = group_elements(std::move(elements), blend);
    Bytes out;
    out.put(count_record(batches.size()));
    std::vector<pliant_format_batch> records;
    for (const ElementBatch& batch : batches) {
        pliant_format_batch record {};
        record.kind = batch[0].element.kind;
        record.valence = batch[0].element.valence;
        record.is_closed = batch[0].element.is_closed;
        record.element_count = std::uint32_t(batch.size());
        records.push_back(record);
        out.put(record);
    }
    for (std::size_t i = 0; i < batches.size(); ++i) put_batch(out, records[i], batches[i], blend);
    if (!records.empty())
        std::memcpy(out.data.data() + sizeof(pliant_format_count), records.data(), records.size() * sizeof(records[0]));
    return out;
}

// Of layers (1, v).
void put_weights(Bytes& out, const Weights& w, bool has_layers)
{
    if (has_layers) out.put_float(1);
    for (Eigen::Index k = 0; k < w.size(); ++k) out.put_float(w[k]);
}

Bytes encode_layers(const std::vector<WeightRange>& ranges)
{
    Bytes out;
    out.put(count_record(ranges.size()));
    for (const WeightRange& range : ranges)
        out.put(pliant_format_layer { float(range.low), float(range.high), float(range.initial), 0 });
    return out;
}

// The polynomial of z, one table per pose.
Bytes encode_quartic(const BlendModel& model)
{
    const Quartic quartic = model.surrogate->quartic()->transformed(model.mean, model.whitening);
    Bytes out;
    for (std::size_t k = 0; k < quartic.pose_count(); ++k) {
        const Eigen::VectorXd table = quartic.coefficients(k);
        if (k == 0) out.put(count_record(std::size_t(table.size())));
        put_padded(out, table);
    }
    return out;
}

void put_coefficients(Bytes& out, const RadialFunction& function)
{
    for (Eigen::Index i = 0; i < function.coefficients.rows(); ++i) put_padded(out, function.coefficients.row(i));
}

Bytes encode_predictor(const BlendModel& model)
{
    Bytes out;
    out.put(count_record(model.predictor.centres.size()));
    for (const Weights& centre : model.predictor.centres) put_weights(out, centre, model.predictor.has_constant);
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    put_coefficients(out, model.predictor);
    return out;
}

// LOAD has no centres of its own: the runtime computes their powers once for both.
Bytes encode_load(const BlendModel& model)
{
    const RadialFunction &load = *model.load, &predictor = model.predictor;
    if (load.centres.empty() || load.centres != predictor.centres
        || load.coefficients.rows() != predictor.coefficients.rows()
        || load.coefficients.cols() != predictor.coefficients.cols())
        throw std::invalid_argument("the dead load of an asset must have the centres of its predictor");
    Bytes out;
    out.put(count_record(load.centres.size()));
    put_coefficients(out, load);
    return out;
}

// Tiles of 16 vertices: `columns` (3n x c) in input units, column after column inside a tile.
Bytes encode_tiles(const Eigen::Ref<const Eigen::MatrixXd>& columns, double length)
{
    Bytes out;
    const Eigen::Index tile = PLIANT_FORMAT_TILE_FLOATS, tiles = (columns.rows() + tile - 1) / tile;
    out.data.reserve(std::size_t(tiles * tile * columns.cols()) * sizeof(float));
    for (Eigen::Index t = 0; t < tiles; ++t)
        for (Eigen::Index j = 0; j < columns.cols(); ++j)
            for (Eigen::Index i = t * tile; i < (t + 1) * tile; ++i)
                out.put_float(i < columns.rows() ? length * columns(i, j) : 0.0);
    return out;
}

Bytes encode_triangles(const std::vector<Triangle>& triangles)
{
    Bytes out;
    for (const Triangle& t : triangles)
        for (std::uint32_t v : t) out.put(v);
    return out;
}

Bytes encode_morph_ranges(const MorphRanges& ranges)
{
    Bytes out;
    put_padded(out, ranges.low);
    put_padded(out, ranges.high);
    return out;
}

Bytes encode_vertices(const StoredMesh& mesh)
{
    Bytes out;
    out.put(count_record(mesh.boundary_vertex_count));
    for (std::uint32_t v : mesh.source_vertices) out.put(v);
    return out;
}

Bytes encode_smoothing(const std::vector<std::uint32_t>& groups, std::size_t vertex_count)
{
    Bytes out;
    if (groups.size() != vertex_count) throw std::invalid_argument("smoothing groups are not those of the drawn vertices");
    for (std::uint32_t group : groups) {
        if (group >= vertex_count) throw std::invalid_argument("a smoothing group has no vertex");
        out.put(group);
    }
    return out;
}

Bytes encode_polygons(const Polygons& polygons)
{
    Bytes out;
    out.put(std::uint32_t(polygons.count()));
    out.put(std::uint32_t(polygons.indices.size()));
    for (std::size_t f = 0; f < polygons.count(); ++f) out.put(std::uint32_t(polygons.size(f)));
    for (std::uint32_t v : polygons.indices) out.put(v);
    return out;
}

bool is_all_triangles(const Polygons& polygons)
{
    for (std::size_t f = 0; f < polygons.count(); ++f)
        if (polygons.size(f) != 3) return false;
    return true;
}

Bytes encode_text(const std::string& text)
{
    Bytes out;
    out.data.assign(text.begin(), text.end());
    return out;
}

Bytes encode_names(const std::vector<std::string>& names)
{
    Bytes out;
    for (const std::string& name : names) {
        out.data.insert(out.data.end(), name.begin(), name.end());
        out.data.push_back(0);
    }
    return out;
}

Bytes encode_answers(const std::vector<Answer>& answers, bool has_layers)
{
    Bytes out;
    out.put(count_record(answers.size()));
    for (const auto& [weights, q] : answers) {
        put_weights(out, weights, has_layers);
        for (Eigen::Index j = 0; j < q.size(); ++j) out.put(q[j]);
    }
    return out;
}

struct Chunk {
    std::uint32_t tag;
    std::uint32_t flags;
    Bytes bytes;
};

std::uint32_t crc_of(const std::uint8_t* data, std::size_t size) { return std::uint32_t(crc32_z(0, data, size)); }

Bytes encode_basis(const AssetModel& asset)
{
    const Eigen::MatrixXd& basis = asset.subspace.basis;
    const std::optional<Embedding>& embedding = asset.mesh.embedding;
    return encode_tiles(embedding ? apply(*embedding, basis) : basis, asset.set.length);
}

constexpr std::uint32_t required = PLIANT_CHUNK_FLAG_REQUIRED;

void add_model_chunks(const AssetModel& asset, std::vector<Chunk>& chunks)
{
    const BlendModel& model = asset.model;
    chunks.push_back({ PLIANT_CHUNK_SOLVER, required, encode_solver(asset) });
    if (model.surrogate->quartic())
        chunks.push_back({ PLIANT_CHUNK_QUARTIC, required, encode_quartic(model) });
    else
        chunks.push_back({ PLIANT_CHUNK_ELEMENTS, required, encode_elements(asset) });
    if (asset.domain.is_box()) chunks.push_back({ PLIANT_CHUNK_LAYERS, required, encode_layers(asset.domain.ranges()) });
    if (!model.predictor.centres.empty()) chunks.push_back({ PLIANT_CHUNK_PREDICTOR, 0, encode_predictor(model) });
    if (model.load) chunks.push_back({ PLIANT_CHUNK_LOAD, required, encode_load(model) });
}

void add_mesh_chunks(const AssetModel& asset, std::vector<Chunk>& chunks)
{
    const StoredMesh& mesh = asset.mesh;
    if (asset.shape.basis.empty())
        chunks.push_back({ PLIANT_CHUNK_REST, required, encode_tiles(asset.shape.rest, asset.set.length) });
    chunks.push_back({ PLIANT_CHUNK_TRIANGLES, required, encode_triangles(mesh.triangles) });
    if (!mesh.source_vertices.empty()) chunks.push_back({ PLIANT_CHUNK_VERTICES, 0, encode_vertices(mesh) });
    if (!mesh.smoothing.empty() && !is_trivial(mesh.smoothing))
        chunks.push_back({ PLIANT_CHUNK_SMOOTHING, 0, encode_smoothing(mesh.smoothing, mesh.vertex_count) });
    if (!is_all_triangles(mesh.polygons)) chunks.push_back({ PLIANT_CHUNK_POLYGONS, 0, encode_polygons(mesh.polygons) });
}

// In the order of the file.
std::vector<Chunk> encode_chunks(const AssetModel& asset, const AssetRecord& record)
{
    std::vector<Chunk> chunks;
    add_model_chunks(asset, chunks);
    if (record.morph_ranges) chunks.push_back({ PLIANT_CHUNK_MORPH_RANGES, 0, encode_morph_ranges(*record.morph_ranges) });
    add_mesh_chunks(asset, chunks);
    chunks.push_back({ PLIANT_CHUNK_NAMES, required, encode_names(asset.pose_names) });
    chunks.push_back({ PLIANT_CHUNK_ANSWERS, required, encode_answers(record.answers, asset.domain.is_box()) });
    chunks.push_back({ PLIANT_CHUNK_CERTIFICATE, required, encode_text(record.certificate) });
    if (!asset.mesh.scene.empty()) chunks.push_back({ PLIANT_CHUNK_SCENE, 0, Bytes { asset.mesh.scene } });
    chunks.push_back({ PLIANT_CHUNK_BOUNDS, 0, Bytes { asset.shape.bounds } });
    if (asset.shape.basis.empty())
        chunks.push_back({ PLIANT_CHUNK_BASIS, required, encode_basis(asset) });
    else
        chunks.push_back({ PLIANT_CHUNK_FACTORED, required, Bytes { asset.shape.basis } });
    return chunks;
}

// The oldest that has what is in the file.
std::uint16_t minor_version(const AssetModel& asset)
{
    if (asset.domain.is_box()) return PLIANT_FORMAT_MINOR_LAYERS;
    return asset.shape.basis.empty() ? PLIANT_FORMAT_MINOR_PARTS : PLIANT_FORMAT_MINOR_FACTORED;
}

pliant_format_header header_of(const AssetModel& asset, std::size_t chunk_count)
{
    const Eigen::Vector3d& centre = asset.set.centre;
    return { PLIANT_FORMAT_IDENTIFIER,
             PLIANT_FORMAT_MAJOR,
             minor_version(asset),
             0,
             std::uint32_t(chunk_count),
             0,
             std::uint32_t(asset.mesh.vertex_count),
             std::uint32_t(asset.mesh.triangles.size()),
             std::uint32_t(asset.subspace.dimension()),
             std::uint32_t(asset.set.pose_count()),
             { float(centre[0]), float(centre[1]), float(centre[2]) },
             0 };
}

} // namespace

std::vector<std::uint8_t> encode_asset(const AssetModel& asset, const AssetRecord& record)
{
    const std::vector<Chunk> chunks = encode_chunks(asset, record);
    pliant_format_header header = header_of(asset, chunks.size());
    Bytes out;
    out.data.resize(sizeof(header) + chunks.size() * sizeof(pliant_format_chunk), 0);
    std::vector<pliant_format_chunk> table;
    for (const Chunk& chunk : chunks) {
        out.align(chunk.tag == PLIANT_CHUNK_BASIS ? PLIANT_FORMAT_BASIS_ALIGNMENT : PLIANT_FORMAT_CHUNK_ALIGNMENT);
        const auto& bytes = chunk.bytes.data;
        table.push_back({ chunk.tag, chunk.flags, out.data.size(), bytes.size(), crc_of(bytes.data(), bytes.size()), 0 });
        out.data.insert(out.data.end(), bytes.begin(), bytes.end());
    }
    header.file_size = out.data.size();
    const auto place_head = [&] {
        std::memcpy(out.data.data(), &header, sizeof(header));
        std::memcpy(out.data.data() + sizeof(header), table.data(), table.size() * sizeof(table[0]));
    };
    place_head();
    header.header_crc32 = crc_of(out.data.data(), sizeof(header) + table.size() * sizeof(table[0]));
    place_head();
    return std::move(out.data);
}

} // namespace pliant
