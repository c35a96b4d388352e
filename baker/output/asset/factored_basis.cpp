#include "output/asset/factored_basis.h"

#include "base/common/parallel.h"
#include "output/asset/bytes.h"
#include "output/asset/tile_product.h"
#include "output/asset/vertex_tiles.h"

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

constexpr Eigen::Index part_vertices = PLIANT_FORMAT_TILE_VERTICES, part_rows = PLIANT_FORMAT_TILE_FLOATS;

// Ranges that start at multiples of a block cost nothing extra, so blocks are small. Larger ones have denser tiles: of
// 16,384 the creature's basis is 2 % smaller, and meshes whose triangles share no vertices need them.
constexpr std::uint32_t fewest_block_vertices = 4096, most_block_vertices = 65536;
constexpr double most_pieces = 1.1; // of a tile, in the mean; with more, blocks are doubled

struct FittedTile {
    VertexTile vertices;
    bool is_still = false;
    std::optional<TileProduct> product;
    std::vector<pliant_format_field> fields; // of the product's left factor, which is relative to their bases
};

// Vertices of a tile that lie in one block, at most 64: a tile of the chunk. Those of one tile have the same factors, so
// that equal vertices are equal in all of them.
struct Piece {
    std::size_t tile;
    std::size_t first, count;  // in the tile
    std::uint32_t block, kind; // the order in which the chunk has them
};

struct Partition {
    std::uint32_t block_vertices;
    std::vector<FittedTile> tiles;
    std::vector<Piece> pieces;
};

// The bases of a column in units of 2^shift, rounded down, and the bits of its largest number above them.
std::uint16_t place_bases(Eigen::Ref<const Eigen::Matrix<std::int32_t, Eigen::Dynamic, 1>> column, std::uint32_t shift,
                          std::int32_t (&bases)[3])
{
    std::int32_t highest = 0;
    for (Eigen::Index c = 0; c < 3; ++c) {
        std::int32_t low = column[c];
        for (Eigen::Index i = c; i < column.size(); i += 3) low = std::min(low, column[i]);
        bases[c] = low >> shift; // rounds down
        for (Eigen::Index i = c; i < column.size(); i += 3)
            highest = std::max(highest, column[i] - bases[c] * (std::int32_t(1) << shift));
    }
    std::uint16_t width = 0;
    while (highest >> width) ++width;
    return width;
}

// The fields of `left`: bases, which are subtracted from it, and the bits of what remains.
std::vector<pliant_format_field> take_bases(Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic>& left)
{
    std::vector<pliant_format_field> fields(std::size_t(left.cols()));
    for (Eigen::Index j = 0; j < left.cols(); ++j) {
        std::int32_t bases[3];
        std::uint16_t width = 0; // wider fields count bases in larger units
        const auto fits = [](std::int32_t base) { return base >= INT16_MIN && base <= INT16_MAX; };
        while (place_bases(left.col(j), pliant_format_product_shift(width), bases) > width
               || !std::all_of(bases, bases + 3, fits))
            ++width;
        pliant_format_field& field = fields[std::size_t(j)];
        field.width = width;
        for (Eigen::Index c = 0; c < 3; ++c) {
            field.base[c] = std::int16_t(bases[c]);
            for (Eigen::Index i = c; i < left.rows(); i += 3)
                left(i, j) -= bases[c] * (std::int32_t(1) << pliant_format_product_shift(width));
        }
    }
    return fields;
}

// The lanes' bits in whole words, lowest first, then what is left of them in 16, 8 and 4 bits.
void put_lanes(Bytes& out, const std::vector<std::uint32_t>& lanes, std::uint32_t bits)
{
    const std::size_t words = bits / 32;
    for (std::size_t i = 0; i < words * part_rows; ++i) out.put(lanes[i]);
    const std::uint32_t* tail = lanes.data() + words * part_rows;
    std::uint32_t at = 0;
    if (bits & 16U) {
        for (Eigen::Index i = 0; i < part_rows; ++i) out.put(std::uint16_t(tail[i]));
        at = 16;
    }
    if (bits & 8U) {
        for (Eigen::Index i = 0; i < part_rows; ++i) out.put(std::uint8_t(tail[i] >> at));
        at += 8;
    }
    if (bits & 4U)
        for (Eigen::Index i = 0; i < part_rows / 2; ++i)
            out.put(std::uint8_t(((tail[i] >> at) & 15U) | ((tail[i + part_rows / 2] >> at) << 4)));
}

// One part of a left factor.
void put_part(Bytes& out, const Eigen::Ref<const Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic>>& left,
              const std::vector<pliant_format_field>& fields)
{
    std::uint32_t bits = 0;
    for (const pliant_format_field& field : fields) bits += field.width;
    bits = (bits + 3) / 4 * 4;
    std::vector<std::uint32_t> lanes(std::size_t(bits / 32 + 2) * part_rows, 0);
    for (Eigen::Index v = 0; v < left.rows() / 3; ++v)
        for (Eigen::Index c = 0; c < 3; ++c) {
            const auto lane = std::size_t(c * part_vertices + v);
            std::uint32_t at = 0;
            for (Eigen::Index j = 0; j < left.cols(); at += fields[std::size_t(j++)].width) {
                const std::uint64_t value = std::uint64_t(left(3 * v + c, j)) << (at % 32);
                lanes[at / 32 * part_rows + lane] |= std::uint32_t(value);
                lanes[(at / 32 + 1) * part_rows + lane] |= std::uint32_t(value >> 32);
            }
        }
    put_lanes(out, lanes, bits);
}

// Values of the vertices part by part, 16 times x, then y, then z; 0 behind the last vertex.
template <class T, class Value> void put_vertices(Bytes& out, Eigen::Index vertex_count, const Value& value)
{
    for (Eigen::Index first = 0; first < vertex_count; first += part_vertices)
        for (Eigen::Index lane = 0; lane < part_rows; ++lane) {
            const Eigen::Index v = first + lane % part_vertices;
            out.put(v < vertex_count ? T(value(v, lane / part_vertices)) : T(0));
        }
}

void put_data(Bytes& out, const Partition& partition, const Piece& piece, const Eigen::VectorXd& rest)
{
    const FittedTile& tile = partition.tiles[piece.tile];
    const auto first = Eigen::Index(piece.first), count = Eigen::Index(piece.count);
    const std::uint32_t* vertices = tile.vertices.data() + piece.first;
    for (Eigen::Index i = 0; i < (count + part_vertices - 1) / part_vertices * part_vertices; ++i)
        out.put(i < count ? std::uint16_t(vertices[i] - piece.block * partition.block_vertices) : std::uint16_t(0));
    if (tile.is_still) {
        put_vertices<float>(out, count,
                            [&](Eigen::Index v, Eigen::Index c) { return float(rest[3 * Eigen::Index(vertices[v]) + c]); });
        return;
    }
    const TileProduct& product = *tile.product;
    for (float scale : product.row_scales) out.put(scale);
    for (Eigen::Index j = 0; j < product.right.cols(); ++j)
        for (Eigen::Index i = 0; i < product.right.rows(); ++i) out.put(product.right(i, j));
    for (const pliant_format_field& field : tile.fields) out.put(field);
    put_vertices<std::uint16_t>(out, count, [&](Eigen::Index v, Eigen::Index c) { return product.numbers(first + v, c); });
    for (Eigen::Index v = first; v < first + count; v += part_vertices)
        put_part(out, product.left.middleRows(3 * v, 3 * std::min(part_vertices, first + count - v)), tile.fields);
}

float rounded_up(double value)
{
    const float nearest = float(value);
    return double(nearest) >= value ? nearest : std::nextafter(nearest, INFINITY);
}

double longest(const Eigen::VectorXd& vectors)
{
    double squared = 0;
    for (Eigen::Index i = 0; i < vectors.size(); i += 3) squared = std::max(squared, vectors.segment<3>(i).squaredNorm());
    return std::sqrt(squared);
}

// What bounds how far a column moves a vertex, and by an eighth of them the terms that are rounded.
double reach_of(const Eigen::MatrixXd& columns, const std::vector<FittedTile>& tiles, Eigen::Index j)
{
    double reach = longest(columns.col(j));
    for (const FittedTile& tile : tiles)
        if (tile.product) reach = std::max(reach, tile.product->terms[j] / 8);
    return reach;
}

void put_head(Bytes& out, const ProductSettings& settings, const Eigen::MatrixXd& columns, const Partition& partition)
{
    pliant_format_factored head {};
    head.tile_count = std::uint32_t(partition.pieces.size());
    head.position_error = float(settings.error);
    head.block_vertices = partition.block_vertices;
    out.put(head);
    for (Eigen::Index j = 0; j < columns.cols(); ++j)
        out.put(pliant_format_column { float(settings.scales[j]), 0, rounded_up(reach_of(columns, partition.tiles, j)),
                                       rounded_up(settings.samples.row(j).cwiseAbs().maxCoeff()) });
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
}

// By blocks; in a block by kinds.
std::vector<Piece> pieces_of(const std::vector<FittedTile>& tiles, std::uint32_t block_vertices,
                             const std::function<int(std::uint32_t)>& kind_of)
{
    std::vector<Piece> pieces;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        const VertexTile& vertices = tiles[t].vertices;
        for (std::size_t first = 0, last = 0; first < vertices.size(); first = last) {
            const std::uint32_t block = vertices[first] / block_vertices;
            while (last < std::min(vertices.size(), first + PLIANT_FORMAT_COMPACT_VERTICES)
                   && vertices[last] / block_vertices == block)
                ++last;
            pieces.push_back({ t, first, last - first, block, std::uint32_t(kind_of(vertices[first])) });
        }
    }
    std::stable_sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
        return std::make_pair(a.block, a.kind) < std::make_pair(b.block, b.kind);
    });
    return pieces;
}

// Into the smallest blocks, from `block_vertices` on, that do not cut tiles into many pieces.
Partition cut_into_blocks(const Eigen::VectorXd& rest, std::uint32_t block_vertices, const std::vector<bool>& is_still,
                          const std::function<int(std::uint32_t)>& kind_of)
{
    Partition out { block_vertices, {}, {} };
    for (const VertexTile& vertices : cut_tiles(rest, block_vertices, kind_of))
        out.tiles.push_back({ vertices, is_still[vertices[0]], {}, {} });
    out.pieces = pieces_of(out.tiles, block_vertices, kind_of);
    const bool is_dense = double(out.pieces.size()) <= most_pieces * double(out.tiles.size());
    if (is_dense || block_vertices == most_block_vertices) return out;
    return cut_into_blocks(rest, 2 * block_vertices, is_still, kind_of);
}

// What the vertices of a tile have of `from`, and back.
template <class M> M gather(const M& from, const VertexTile& vertices)
{
    M out(3 * Eigen::Index(vertices.size()), from.cols());
    for (std::size_t i = 0; i < vertices.size(); ++i)
        out.middleRows(3 * Eigen::Index(i), 3) = from.middleRows(3 * Eigen::Index(vertices[i]), 3);
    return out;
}

template <class M> void scatter(const M& from, const VertexTile& vertices, M& out)
{
    for (std::size_t i = 0; i < vertices.size(); ++i)
        out.middleRows(3 * Eigen::Index(vertices[i]), 3) = from.middleRows(3 * Eigen::Index(i), 3);
}

Bytes encode(const Partition& partition, const ProductSettings& settings, const Eigen::VectorXd& rest,
             const Eigen::MatrixXd& columns)
{
    Bytes out, data;
    const std::vector<Piece>& pieces = partition.pieces;
    put_head(out, settings, columns, partition);
    for (std::uint32_t block = 0, i = 0; i < pieces.size(); ++block) {
        out.put(i);
        while (i < pieces.size() && pieces[i].block == block) ++i;
    }
    out.put(std::uint32_t(pieces.size()));
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    for (const Piece& piece : pieces) {
        const std::optional<TileProduct>& product = partition.tiles[piece.tile].product;
        pliant_format_product head = product ? product->head : pliant_format_product {};
        head.offset = std::uint32_t(data.data.size() / sizeof(std::uint32_t));
        head.vertex_count = std::uint16_t(piece.count);
        out.put(head);
        put_data(data, partition, piece, rest);
    }
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    out.data.insert(out.data.end(), data.data.begin(), data.data.end());
    return out;
}

} // namespace

std::optional<FactoredBasis> factor_basis(Eigen::VectorXd& rest, Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples,
                                          double error, std::size_t boundary_count)
{
    std::vector<bool> is_still;
    for (Eigen::Index i = 0; i < columns.rows(); i += 3) is_still.push_back(columns.middleRows(i, 3).isZero(0));
    const auto kind_of = [&](std::uint32_t v) { return 2 * int(v >= boundary_count) + int(is_still[v]); };
    const ProductSettings settings = product_settings(columns, samples, error);
    Partition partition = cut_into_blocks(rest, fewest_block_vertices, is_still, kind_of);
    std::vector<FittedTile>& tiles = partition.tiles;
    Eigen::VectorXd stored_rest = rest;
    Eigen::MatrixXd stored_columns = columns;
    for_each_task(tiles.size(), [&](std::size_t t, std::size_t) {
        FittedTile& tile = tiles[t];
        if (tile.is_still) return;
        Eigen::VectorXd tile_rest = gather(rest, tile.vertices);
        Eigen::MatrixXd tile_columns = gather(columns, tile.vertices);
        tile.product = fit_product(settings, tile_rest, tile_columns);
        if (tile.product) tile.fields = take_bases(tile.product->left);
        scatter(tile_rest, tile.vertices, stored_rest);
        scatter(tile_columns, tile.vertices, stored_columns);
    });
    FactoredBasis out;
    for (const FittedTile& tile : tiles) {
        if (!tile.is_still && !tile.product) return {};
        if (tile.product) out.largest_error = std::max(out.largest_error, tile.product->largest_error);
    }
    out.chunk = encode(partition, settings, rest, stored_columns).data;
    rest = std::move(stored_rest);
    columns = std::move(stored_columns);
    return out;
}

} // namespace pliant
