// The basis on one tile as a product of small factors: a tile of chunk BASF of formats/SPEC.md.
#pragma once

#include "pliant_format.h"

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace pliant {

// What all tiles of a basis share.
struct ProductSettings {
    Eigen::VectorXd scales;  // d: of q, float values
    Eigen::MatrixXd samples; // d x s: where the error is kept
    Eigen::MatrixXd root;    // d x d: of the second moments of `samples`
    double error = 0;        // of a vertex, input units
};

struct TileProduct {
    pliant_format_product head {};
    std::vector<float> row_scales;
    Eigen::Matrix<std::int16_t, Eigen::Dynamic, Eigen::Dynamic> right; // rows, padded, x d
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic> left;  // 3 vertices x columns
    Eigen::Matrix<std::uint16_t, Eigen::Dynamic, 3> numbers;           // of the rest positions
    double largest_error = 0;                                          // at the samples
    Eigen::VectorXd terms; // d: the largest sum of magnitudes that a coordinate adds up for each column
};

// Settings for the basis `columns` (3n x d).
ProductSettings product_settings(const Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples, double error);

// The vertices `rest` (3k, relative to the origin of the asset) that move by `columns` (3k x d), both replaced by what the
// product says. Nothing if its numbers are too large for the format. Cost: some ten products of `columns` with the samples.
std::optional<TileProduct> fit_product(const ProductSettings& settings, Eigen::VectorXd& rest, Eigen::MatrixXd& columns);

} // namespace pliant
