// A baked character as bytes: formats/SPEC.md: of the oldest minor version that has what it holds.
#pragma once

#include "base/mesh/render_mesh.h"
#include "base/weights/radial_function.h"
#include "input/gltf/render_scene.h"
#include "output/asset/reachable.h"
#include "output/asset/stored_shape.h"
#include "reduced/surrogate/surrogate_energy.h"

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
    const std::vector<std::uint32_t>* smoothing
        = nullptr;                         // groups of drawn vertices that share a normal; null: each its own
    std::size_t boundary_vertex_count = 0; // of a solid
    const DrawnSurface* drawn = nullptr;   // what is stored for drawing, in the place of the mesh's own vertices and faces
    const RenderScene* scene = nullptr;    // for GLTF; written if its vertices are as many as those drawn. Null: none
    const StoredShape* stored
        = nullptr; // of what is drawn; null: the subspace as it is, in single precision, without bounds
    std::optional<MorphRanges> morph_ranges; // of q as weights of morph targets
    std::string certificate;                 // JSON text
    std::vector<std::pair<Weights, Eigen::VectorXf>>
        answers; // weights and the q that the runtime found, in stored coordinates
};

// The bytes of the asset. Throws Failure (P4501) if a number does not fit the format, std::invalid_argument for a load whose centres
// are not the predictor's, and for smoothing groups that are not one number below the vertex count for each drawn vertex.
std::vector<std::uint8_t> encode_asset(const AssetModel& model);

} // namespace pliant
