// The basis of an asset quantised to few bits: chunk BASC of formats/SPEC.md.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace pliant {

struct CompactBasis {
    std::vector<std::uint8_t> chunk;
    double largest_error = 0; // of a vertex at the samples, input units
};

// Packs `columns` (3n x d, input units) so that no vertex is off by more than `error` (> 0, input units) at the coordinates
// `samples` (d x s), and puts the packed numbers into `columns`. Empty, and `columns` as they were, if a number would need
// more bits than the format has: then single precision is as good.
std::optional<CompactBasis> pack_basis(Eigen::MatrixXd& columns, const Eigen::MatrixXd& samples, double error);

} // namespace pliant
