// Elements of a surrogate energy as the chunk ELEM stores them.
#pragma once

#include "elastic/energy/energy.h"
#include "output/asset/asset_model.h"

#include <vector>

namespace pliant {

// An element ready for the runtime: its numbers, its cubature weight in them, and its difference rows at z = 0 (column 0)
// and along each z_j.
struct BakedElement {
    RuntimeElement element;
    Eigen::MatrixXd rows; // R x (1 + d)
};

// Element i of the asset's surrogate energy.
BakedElement bake_element(const AssetModel& asset, std::size_t i);

// The gauge as ties whose anchors stand still, one for each affine function. Empty without one.
std::vector<BakedElement> bake_gauge(const AssetModel& asset);

// Elements of one kind and layout.
using ElementBatch = std::vector<BakedElement>;

// As few batches and unused lanes as there can be: ARAP cells become open ones, sorted by their valence, and every sixteen
// take that of the largest among them, with spokes that have no stiffness. Elements of layers are sorted by the layers that
// change them.
std::vector<ElementBatch> group_elements(std::vector<BakedElement> elements, Blend blend);

// A layer, and sixteen lanes of a batch whose rest state it changes.
struct LayerChange {
    std::uint32_t layer, group;
};
std::vector<LayerChange> changes_of(const ElementBatch& batch);

} // namespace pliant
