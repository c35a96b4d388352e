// The basis of an asset as products of small factors, tile by tile: chunk BASF of formats/SPEC.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace pliant {

struct FactoredBasis {
    std::vector<std::uint8_t> chunk;
    double largest_error = 0; // of a vertex at the samples, input units
};

// Factors `columns` (3n x d, input units) around the shape `rest` (3n, relative to the origin of the asset), so that no
// vertex is off by more than `error` (> 0, input units) at the coordinates `samples` (d x s). Both become what the chunk
// says. A vertex with zeros in `columns` keeps its place in single precision, to the bit. Vertices from `boundary_count` on
// share no tiles with those before. Nothing, and both as they were, if a number would need more bits than the format has:
// then single precision is as good.
std::optional<FactoredBasis> factor_basis(Eigen::VectorXd& rest, Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples,
                                          double error, std::size_t boundary_count);

} // namespace pliant
