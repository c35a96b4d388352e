#include "output/asset/compact_basis.h"

#include "base/common/parallel.h"
#include "output/asset/bytes.h"
#include "pliant_format.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace pliant {

namespace {

constexpr Eigen::Index tile_rows = 3 * PLIANT_FORMAT_COMPACT_VERTICES, part_rows = PLIANT_FORMAT_TILE_FLOATS;

// A column whose blends move less than this part of the error needs no bits; it only keeps scales finite.
constexpr double negligible = 1e-3;

using Integers = Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic>;

// What a tile becomes before its columns' bases are known.
struct Tile {
    float factor = 1;
    Integers numbers; // rows x d: in units of factor * scale
    double error = 0;
};

// The unit of every column: off by one of it, blends are off by the error at most.
Eigen::VectorXf scales_for(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples, double error)
{
    Eigen::VectorXf scales(columns.cols());
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
        const double largest = columns.col(j).cwiseAbs().maxCoeff();
        const double amplitude
            = std::max(samples.row(j).cwiseAbs().maxCoeff(), largest > 0 ? negligible * error / largest : 0.0);
        scales[j] = amplitude > 0 ? float(error / amplitude) : 0.0F;
    }
    return scales;
}

class TileFitter {
public:
    TileFitter(const Eigen::MatrixXd& columns, const Eigen::VectorXf& scales, const Eigen::MatrixXd& samples, double error)
        : columns_(columns)
        , scales_(scales)
        , samples_(samples)
        , error_(error)
    {
    }

    // The coarsest factor that keeps the error. Errors of columns add up to less than d times half a unit in each
    // coordinate, so 1/d always keeps it.
    Tile fit(Eigen::Index tile) const
    {
        double low = -std::log2(double(columns_.cols())) - 1, high = 5; // log2 of the factor
        Tile best = round_by(tile, std::exp2(low));
        for (int step = 0; step < 9; ++step) { // to a fiftieth of a bit
            const double middle = (low + high) / 2;
            Tile trial = round_by(tile, std::exp2(middle));
            if (trial.error > error_) {
                high = middle;
                continue;
            }
            low = middle;
            best = std::move(trial);
        }
        return best;
    }

private:
    Tile round_by(Eigen::Index tile, double factor) const
    {
        const Eigen::Index first = tile * tile_rows, rows = std::min(tile_rows, columns_.rows() - first);
        Tile out;
        out.factor = float(factor);
        out.numbers.setZero(rows, columns_.cols());
        Eigen::MatrixXd off = columns_.middleRows(first, rows);
        for (Eigen::Index j = 0; j < columns_.cols(); ++j) {
            const double unit = double(out.factor) * double(scales_[j]);
            if (unit == 0) continue;
            for (Eigen::Index i = 0; i < rows; ++i) {
                const double number = std::round(off(i, j) / unit);
                out.numbers(i, j) = std::int64_t(number);
                off(i, j) -= number * unit;
            }
        }
        const Eigen::MatrixXd errors = off * samples_;
        for (Eigen::Index s = 0; s < errors.cols(); ++s)
            for (Eigen::Index i = 0; i < rows; i += 3) out.error = std::max(out.error, errors.col(s).segment<3>(i).norm());
        return out;
    }

    const Eigen::MatrixXd& columns_;
    const Eigen::VectorXf& scales_;
    const Eigen::MatrixXd& samples_;
    double error_;
};

std::int64_t floor_shift(std::int64_t value, std::uint32_t shift)
{
    return std::int64_t(std::floor(std::ldexp(double(value), -int(shift))));
}

std::int64_t lowest(const Tile& tile, Eigen::Index j, Eigen::Index c)
{
    std::int64_t low = tile.numbers(c, j);
    for (Eigen::Index i = c; i < tile.numbers.rows(); i += 3) low = std::min(low, tile.numbers(i, j));
    return low;
}

// The smallest unit in which all bases of a column are 16-bit numbers.
std::uint32_t shift_for(const std::vector<Tile>& tiles, Eigen::Index j)
{
    std::uint32_t shift = 0;
    for (const Tile& tile : tiles)
        for (Eigen::Index c = 0; c < 3; ++c) {
            const std::int64_t low = lowest(tile, j, c);
            while (std::abs(floor_shift(low, shift)) > 32767) ++shift;
        }
    return shift;
}

// The bases, and `tile.numbers` relative to them from now on: the fields.
std::vector<pliant_format_field> take_bases(Tile& tile, const std::vector<std::uint32_t>& shifts)
{
    std::vector<pliant_format_field> fields(shifts.size());
    for (std::size_t j = 0; j < shifts.size(); ++j) {
        const Eigen::Index column = Eigen::Index(j);
        for (Eigen::Index c = 0; c < 3; ++c) {
            const std::int64_t base = floor_shift(lowest(tile, column, c), shifts[j]);
            fields[j].base[c] = std::int16_t(base);
            for (Eigen::Index i = c; i < tile.numbers.rows(); i += 3)
                tile.numbers(i, column) -= base * (std::int64_t(1) << shifts[j]);
        }
        const std::int64_t highest = tile.numbers.col(column).maxCoeff();
        while (highest >> fields[j].width) ++fields[j].width;
    }
    return fields;
}

std::uint32_t bits_of(const std::vector<pliant_format_field>& fields)
{
    std::uint32_t bits = 0;
    for (const pliant_format_field& field : fields) bits += field.width;
    return bits;
}

// One part: the lanes' bits, lowest first, in whole words, then what is left of them in 16, 8 and 4 bits.
void put_part(Bytes& out, const Tile& tile, const std::vector<pliant_format_field>& fields, Eigen::Index first)
{
    const std::uint32_t bits = (bits_of(fields) + 3) / 4 * 4, words = bits / 32;
    std::vector<std::uint32_t> lanes(std::size_t(words + 1) * part_rows, 0);
    for (Eigen::Index i = 0; i < part_rows && first + i < tile.numbers.rows(); ++i) {
        std::uint32_t at = 0;
        for (std::size_t j = 0; j < fields.size(); ++j) {
            const std::uint64_t value = std::uint64_t(tile.numbers(first + i, Eigen::Index(j))) << (at % 32);
            lanes[std::size_t(at / 32) * part_rows + std::size_t(i)] |= std::uint32_t(value);
            if (value >> 32) lanes[std::size_t(at / 32 + 1) * part_rows + std::size_t(i)] |= std::uint32_t(value >> 32);
            at += fields[j].width;
        }
    }
    for (std::size_t i = 0; i < std::size_t(words) * part_rows; ++i) out.put(lanes[i]);
    const std::uint32_t* tail = lanes.data() + std::size_t(words) * part_rows;
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

float rounded_up(double value)
{
    const float nearest = float(value);
    return double(nearest) >= value ? nearest : std::nextafter(nearest, INFINITY);
}

// Head and columns. `columns` are the packed ones.
Bytes begin_chunk(const Eigen::MatrixXd& columns, const Eigen::VectorXf& scales, const std::vector<std::uint32_t>& shifts,
                  const Eigen::MatrixXd& samples, std::size_t tile_count, double error)
{
    Bytes out;
    pliant_format_compact head {};
    head.tile_count = std::uint32_t(tile_count);
    head.position_error = float(error);
    out.put(head);
    for (Eigen::Index j = 0; j < columns.cols(); ++j) {
        double reach = 0;
        for (Eigen::Index i = 0; i < columns.rows(); i += 3) reach = std::max(reach, columns.col(j).segment<3>(i).norm());
        out.put(pliant_format_column { scales[j], shifts[std::size_t(j)], rounded_up(reach),
                                       rounded_up(samples.row(j).cwiseAbs().maxCoeff()) });
    }
    out.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    return out;
}

} // namespace

std::optional<CompactBasis> pack_basis(Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples, double error)
{
    const Eigen::Index d = columns.cols();
    const Eigen::VectorXf scales = scales_for(columns, samples, error);
    std::vector<Tile> tiles(std::size_t((columns.rows() + tile_rows - 1) / tile_rows));
    const TileFitter fitter(columns, scales, samples, error);
    for_each_task(tiles.size(), [&](std::size_t t, std::size_t) { tiles[t] = fitter.fit(Eigen::Index(t)); });

    std::vector<std::uint32_t> shifts;
    for (Eigen::Index j = 0; j < d; ++j) shifts.push_back(shift_for(tiles, j));
    if (*std::max_element(shifts.begin(), shifts.end()) > PLIANT_FORMAT_MAX_SHIFT) return {};
    CompactBasis out;
    std::vector<std::vector<pliant_format_field>> fields;
    Eigen::MatrixXd packed(columns.rows(), d);
    std::vector<pliant_format_tile> records;
    Bytes data;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        Tile& tile = tiles[t];
        const Eigen::Index first = Eigen::Index(t) * tile_rows;
        for (Eigen::Index j = 0; j < d; ++j)
            packed.block(first, j, tile.numbers.rows(), 1)
                = double(tile.factor) * double(scales[j]) * tile.numbers.col(j).cast<double>();
        fields.push_back(take_bases(tile, shifts));
        for (const pliant_format_field& field : fields[t])
            if (field.width > PLIANT_FORMAT_MAX_WIDTH) return {};
        records.push_back({ std::uint32_t(data.data.size() / sizeof(std::uint32_t)), tile.factor });
        for (Eigen::Index part = 0; part < tile.numbers.rows(); part += part_rows) put_part(data, tile, fields[t], part);
        out.largest_error = std::max(out.largest_error, tile.error);
        tile = Tile();
    }
    if (data.data.size() / sizeof(std::uint32_t) > UINT32_MAX) return {};
    Bytes chunk = begin_chunk(packed, scales, shifts, samples, tiles.size(), error);
    for (const pliant_format_tile& record : records) chunk.put(record);
    for (const auto& tile : fields)
        for (const pliant_format_field& field : tile) chunk.put(field);
    chunk.align(PLIANT_FORMAT_CHUNK_ALIGNMENT);
    chunk.data.insert(chunk.data.end(), data.data.begin(), data.data.end());
    out.chunk = std::move(chunk.data);
    columns = std::move(packed);
    return out;
}

} // namespace pliant
