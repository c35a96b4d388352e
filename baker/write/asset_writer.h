// A baked character as bytes: formats/SPEC.md: of the oldest minor version that has what it holds.
#pragma once

#include "mesh/drawn_surface.h"
#include "reduce/stand_in.h"
#include "warmstart/predictor.h"
#include "write/reachable.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

// Everything an asset holds. Borrowed parts must outlive the call of encode_asset.
struct AssetModel {
    const ShapeSet* set = nullptr;
    const Subspace* subspace = nullptr;
    const StandIn* stand_in = nullptr;
    Shape stand_in_reference; // the shape of the stand-in's mesh at q = mean
    Eigen::VectorXd mean;     // q of the stand-in's equal-weight average
    Eigen::MatrixXd root;     // S: q = mean + S z
    double energy_scale = 1;
    Predictor predictor;           // of z
    std::optional<Predictor> load; // c(w), a gradient by z; same centres as the predictor
    std::vector<std::string> names;
    const Polygons* polygons = nullptr;                          // faces as given
    const std::vector<std::uint32_t>* source_vertices = nullptr; // of a solid: numbers in the files; null or empty: the same
    std::size_t boundary_vertex_count = 0;                       // of a solid
    const DrawnSurface* drawn
        = nullptr; // of a solid: what is stored for drawing, in the place of its own vertices and faces
    std::optional<MorphRanges> morph_ranges;                  // of q as weights of morph targets
    std::string certificate;                                  // JSON text
    std::vector<std::pair<Weights, Eigen::VectorXf>> answers; // weights and the q that the runtime found
};

// The bytes of the asset. Throws Failure (P4501) if a number does not fit the format, std::invalid_argument for a load whose centres
// are not the predictor's.
std::vector<std::uint8_t> encode_asset(const AssetModel& model);

} // namespace pliant
