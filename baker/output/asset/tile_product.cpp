#include "output/asset/tile_product.h"

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

constexpr Eigen::Index affine_rows = PLIANT_FORMAT_AFFINE_ROWS;
constexpr double largest_row = 32767, largest_rest = 65535, largest_left = 1 << 22;

// A column that moves no vertex by more than this many units of rounding is left out. Found by trial: with 0.5, 1 and 4 the
// creature's basis is 7, 2 and 3 % larger.
constexpr double worthless = 2;

// Parts of the error that rounded rest positions take, and of it that a column must move a vertex to count at all.
constexpr double rest_share = 1e-3, negligible = 1e-3;

double largest_length(const Eigen::MatrixXd& vectors)
{
    double squared = 0;
    for (Eigen::Index s = 0; s < vectors.cols(); ++s)
        for (Eigen::Index i = 0; i < vectors.rows(); i += 3)
            squared = std::max(squared, vectors.col(s).segment<3>(i).squaredNorm());
    return std::sqrt(squared);
}

// Rows of a right factor in 16 bits; `rows` (of q) become what is stored.
class RightFactor {
public:
    RightFactor(const Eigen::VectorXd& scales, Eigen::MatrixXd& rows)
        : row_scales(std::size_t(rows.rows()))
        , numbers(rows.rows(), rows.cols())
    {
        for (Eigen::Index i = 0; i < rows.rows(); ++i) {
            double largest = 0;
            for (Eigen::Index j = 0; j < rows.cols(); ++j)
                if (scales[j] > 0) largest = std::max(largest, std::abs(rows(i, j)) / scales[j]);
            const double unit = double(row_scales[std::size_t(i)] = float(largest / largest_row));
            for (Eigen::Index j = 0; j < rows.cols(); ++j) {
                const double wanted = unit * scales[j] > 0 ? std::round(rows(i, j) / (unit * scales[j])) : 0;
                numbers(i, j) = std::int16_t(std::clamp(wanted, -largest_row, largest_row));
                rows(i, j) = unit * scales[j] * numbers(i, j);
            }
        }
    }

    std::vector<float> row_scales;
    Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic> numbers;
};

// Rest positions as numbers in the tile's box.
void round_rest(const ProductSettings& settings, const Eigen::VectorXd& rest, TileProduct& out)
{
    const Eigen::Map<const Eigen::Matrix3Xd> points(rest.data(), 3, rest.size() / 3);
    const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    const double scale = std::max((high - low).maxCoeff() / largest_rest, rest_share * settings.error);
    out.head.rest_scale = float(scale * (1 + 1e-6)); // rounding down must not reach the next number
    out.numbers.resize(points.cols(), 3);
    for (int c = 0; c < 3 && out.head.rest_scale > 0; ++c) {
        out.head.rest_origin[c] = float(low[c]);
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const double number = (points(c, i) - double(out.head.rest_origin[c])) / double(out.head.rest_scale);
            out.numbers(i, c) = std::uint16_t(std::clamp(std::round(number), 0.0, largest_rest));
        }
    }
}

// As stored, 3k.
Eigen::VectorXd rest_of(const TileProduct& tile)
{
    Eigen::VectorXd rest(3 * tile.numbers.rows());
    for (Eigen::Index i = 0; i < tile.numbers.rows(); ++i)
        for (int c = 0; c < 3; ++c)
            rest[3 * i + c] = double(tile.head.rest_origin[c]) + double(tile.head.rest_scale) * tile.numbers(i, c);
    return rest;
}

// 3k x 12: vertices of the affine maps whose parameters are the first rows of a right factor.
Eigen::MatrixXd affine_factor(const TileProduct& tile)
{
    Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(3 * tile.numbers.rows(), affine_rows);
    for (Eigen::Index i = 0; i < tile.numbers.rows(); ++i)
        for (int c = 0; c < 3; ++c) {
            factor(3 * i + c, c) = 1;
            for (int a = 0; a < 3; ++a) factor(3 * i + c, 3 + 3 * a + c) = tile.numbers(i, a);
        }
    return factor;
}

// The nearest affine map of every column, 12 x d. Tiles thinner than a hundredth of their width have none along their
// normal: its terms would be large and cancel each other.
Eigen::MatrixXd fit_affine(const Eigen::MatrixXd& factor, const Eigen::MatrixXd& columns)
{
    Eigen::MatrixXd scaled = factor;
    scaled.rightCols(affine_rows - 3) /= largest_rest;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
    solver.setThreshold(1e-2);
    Eigen::MatrixXd rows = solver.compute(scaled).solve(columns);
    rows.bottomRows(affine_rows - 3) /= largest_rest;
    return rows;
}

class ProductFitter {
public:
    // `residual` (3k x d): what the affine maps leave; `offset` (3k): the error of the rest positions.
    ProductFitter(const ProductSettings& settings, const Eigen::MatrixXd& residual, const Eigen::VectorXd& offset)
        : settings_(settings)
        , residual_(residual)
        , offset_(offset)
    {
        const Eigen::BDCSVD<Eigen::MatrixXd> svd(residual * settings.root, Eigen::ComputeThinU);
        left_ = svd.matrixU();
        right_ = left_.transpose() * residual;
        amplitudes_ = (right_ * settings.samples).cwiseAbs().rowwise().maxCoeff();
    }

    struct Trial {
        Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic> left;
        Eigen::MatrixXd right; // as stored
        std::vector<float> row_scales;
        Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic> right_numbers;
        double error = 0;
    };

    // The coarsest rounding that keeps the error; the finest one tried if none does.
    Trial fit() const
    {
        double low = -8, high = 6; // log2 of the rounding over the error
        Trial best = round_by(std::exp2(high));
        if (best.error <= settings_.error) return best;
        best = round_by(std::exp2(low));
        for (int step = 0; step < 9; ++step) {
            const double middle = (low + high) / 2;
            Trial trial = round_by(std::exp2(middle));
            (trial.error > settings_.error ? high : low) = middle;
            if (trial.error <= settings_.error) best = std::move(trial);
        }
        return best;
    }

private:
    // Every column rounds blends equally much: by `factor` times the error.
    Trial round_by(double factor) const
    {
        const double unit = factor * settings_.error;
        std::vector<Eigen::Index> kept;
        for (Eigen::Index i = 0; i < left_.cols(); ++i)
            if (left_.col(i).cwiseAbs().maxCoeff() * amplitudes_[i] > worthless * unit) kept.push_back(i);
        const auto count = Eigen::Index(kept.size());
        Trial out;
        out.error = HUGE_VAL;
        if (count > Eigen::Index(PLIANT_FORMAT_MAX_PRODUCT_COLUMNS)) return out;
        for (Eigen::Index i : kept) // finer than the format can say
            if (left_.col(i).cwiseAbs().maxCoeff() * amplitudes_[i] > largest_left * unit) return out;
        out.left.resize(left_.rows(), count);
        out.right.resize(count, residual_.cols());
        for (Eigen::Index k = 0; k < count; ++k) {
            const Eigen::Index i = kept[std::size_t(k)];
            out.left.col(k) = (left_.col(i) * (amplitudes_[i] / unit)).array().round().cast<std::int32_t>();
            out.right.row(k) = right_.row(i) * (unit / amplitudes_[i]);
        }
        RightFactor rounded(settings_.scales, out.right);
        out.row_scales = std::move(rounded.row_scales);
        out.right_numbers = std::move(rounded.numbers);
        Eigen::MatrixXd errors = (residual_ - out.left.cast<double>() * out.right) * settings_.samples;
        out.error = largest_length(errors.colwise() + offset_);
        return out;
    }

    const ProductSettings& settings_;
    const Eigen::MatrixXd& residual_;
    const Eigen::VectorXd& offset_;
    Eigen::MatrixXd left_, right_; // 3k x rank, rank x d
    Eigen::VectorXd amplitudes_;   // of the rows of right_, at the samples
};

// Rows of both parts one below the other, padded.
void join_rows(const RightFactor& affine, const ProductFitter::Trial& columns, TileProduct& out)
{
    out.head.column_count = std::uint16_t(columns.left.cols());
    const auto rows = Eigen::Index(pliant_format_product_rows(&out.head));
    out.right.setZero(rows, affine.numbers.cols());
    out.right.topRows(affine_rows) = affine.numbers;
    out.right.middleRows(affine_rows, columns.left.cols()) = columns.right_numbers;
    out.row_scales = affine.row_scales;
    out.row_scales.insert(out.row_scales.end(), columns.row_scales.begin(), columns.row_scales.end());
    out.row_scales.resize(std::size_t(rows), 0.0F);
}

// For every column, over the coordinates: of the affine map, and of columns whose bases and fields are added up apart.
Eigen::VectorXd terms_of(const Eigen::MatrixXd& rows, const ProductFitter::Trial& fitted)
{
    Eigen::VectorXd terms = Eigen::VectorXd::Zero(rows.cols());
    for (int c = 0; c < 3; ++c) {
        Eigen::VectorXd sum = rows.row(c).cwiseAbs().transpose();
        for (int a = 0; a < 3; ++a) sum += largest_rest * rows.row(3 + 3 * a + c).cwiseAbs().transpose();
        terms = terms.cwiseMax(sum);
    }
    for (Eigen::Index i = 0; i < fitted.left.cols(); ++i)
        terms += 3.0 * fitted.left.col(i).cwiseAbs().maxCoeff() * fitted.right.row(i).cwiseAbs().transpose();
    return terms;
}

} // namespace

ProductSettings product_settings(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples, double error)
{
    const Eigen::Index d = columns.cols();
    ProductSettings out { Eigen::VectorXd(d), samples, Eigen::MatrixXd(), error };
    for (Eigen::Index j = 0; j < d; ++j) {
        const double largest = columns.col(j).cwiseAbs().maxCoeff();
        const double reach
            = std::max(samples.row(j).cwiseAbs().maxCoeff(), largest > 0 ? negligible * error / largest : 0.0);
        out.scales[j] = reach > 0 ? double(float(1 / reach)) : 0;
    }
    Eigen::MatrixXd moments = samples * samples.transpose() / double(samples.cols());
    moments.diagonal().array() += 1e-12 * moments.trace() + 1e-300;
    out.root = moments.llt().matrixL();
    return out;
}

std::optional<TileProduct> fit_product(const ProductSettings& settings, Eigen::VectorXd& rest, Eigen::MatrixXd& columns)
{
    TileProduct out;
    out.head.vertex_count = std::uint16_t(rest.size() / 3);
    round_rest(settings, rest, out);
    if (!std::isnormal(out.head.rest_scale)) return {}; // zero would say that the tile is still
    const Eigen::VectorXd stored = rest_of(out), offset = rest - stored;
    const Eigen::MatrixXd factor = affine_factor(out);
    Eigen::MatrixXd rows = fit_affine(factor, columns);
    const RightFactor affine(settings.scales, rows);
    const Eigen::MatrixXd affine_columns = factor * rows, residual = columns - affine_columns;
    const ProductFitter::Trial fitted = ProductFitter(settings, residual, offset).fit();
    if (fitted.error > settings.error) return {};
    join_rows(affine, fitted, out);
    out.left = fitted.left;
    out.largest_error = fitted.error;
    out.terms = terms_of(rows, fitted);
    rest = stored;
    columns = affine_columns + fitted.left.cast<double>() * fitted.right;
    return out;
}

} // namespace pliant
