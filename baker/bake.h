// The baker's pipeline: poses in, asset out. Each stage is a function from plain structs to a plain struct.
#pragma once

#include "average/newton.h"
#include "average/shape_error.h"
#include "energy/discrete_shells.h"
#include "reduce/cubature.h"
#include "subspace/adaptive.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pliant {

enum class Material { discrete_shells, arap };
enum class SubspaceKind { adaptive, krylov, barbic };
enum class StandInKind { cubature, ghost };

// What an elastic energy is made of: shared by all verbs that need one.
struct EnergyOptions {
    Material material = Material::discrete_shells;
    ShellOptions shell;
    bool keep_placement = false; // do not align the poses
    SolverKind solver = default_solver();
};

struct BakeOptions {
    EnergyOptions energy;
    SubspaceKind subspace = SubspaceKind::adaptive;
    double tolerance = 1e-3;    // adaptive: mean relative L2 of the subspace over check weights
    int ritz_count = 2;         // krylov: vectors per tangent
    Eigen::Index dimension = 0; // 0: what the tolerance or ritz_count asks for (barbic: 4 modes a pose); else exactly this
    StandInKind stand_in = StandInKind::cubature;
    std::size_t element_count = 0; // cubature elements; 0: six per dimension
    std::size_t ghost_vertex_count = 800;
    std::uint64_t seed = 1;
    int check_count = 3; // weights at which the written asset is compared with the unreduced average
};

struct StageTime {
    std::string stage;
    double seconds;
};

struct BakeReport {
    std::size_t vertex_count = 0, pose_count = 0, element_count = 0, foldover_count = 0;
    Eigen::Index dimension = 0;
    std::vector<StageTime> stages;
    int factorization_count = 0;
    int unconverged_training_count = 0;
    AdaptiveReport adaptive; // empty for krylov
    CubatureReport cubature;
    double stand_in_error = 0; // largest relative distance of runtime and double-precision stand-in, relative L2
    std::vector<std::pair<Weights, ShapeError>> checks;
    int unconverged_check_count = 0;
    std::string certificate; // the JSON that went into the asset
};

struct BakedAsset {
    std::vector<std::uint8_t> bytes;
    BakeReport report;
};

// The energy of a shape set. The set must outlive it.
std::unique_ptr<Energy> make_energy(const ShapeSet& set, const EnergyOptions& options);

// Bakes. Throws Failure, or Interrupted through progress. Cost for some 15,000 vertices and 5 poses:
// minutes with the adaptive subspace (4 to 13 measured, tests/bench/README.md), about one with krylov.
BakedAsset bake(const PoseSet& poses, const BakeOptions& options, Progress& progress);

// What a bake would cost, from counts alone: dimension, seconds on one core, bytes of working memory.
struct BakeEstimate {
    Eigen::Index dimension;
    double seconds;
    double memory;
    double asset_size;
};
BakeEstimate estimate_bake(std::size_t vertex_count, std::size_t pose_count, const BakeOptions& options);

} // namespace pliant
