// How a bake judges what it has made: the encoded asset, opened by the real runtime, against what it was made from.
#pragma once

#include "bake/bake.h"
#include "output/asset/asset_writer.h"
#include "reduced/surrogate/blend_model.h"

namespace pliant {

// Fills asset.answers with the runtime's: at the mean, at edge mid-points and between. They go into the asset as its own test, and are
// compared with the model in double precision. They hold for asset.stored as it is.
void collect_answers(AssetModel& asset, const BlendModel& model, const TrainingSet& training, BakeReport& report);

// Blends of the finished asset against a(w): at the checks, and at weights that nothing was chosen by.
void check_asset(const std::vector<std::uint8_t>& bytes, AverageFamily& family, SolverPool& pool,
                 std::vector<CheckPoint>& checks, const BakeOptions& options, Progress& progress, BakeReport& report);

// Coordinates of the training averages, then of the poses (d x samples): their convex hull is about what blends reach.
Eigen::MatrixXd reachable_coordinates(const Subspace& subspace, const TrainingSet& training);

// Positions that the runtime rebuilds at these coordinates against the subspace in double precision.
BasisReport check_basis(const AssetModel& asset, const Eigen::MatrixXd& reachable);

} // namespace pliant
