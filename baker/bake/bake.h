// The baker's pipeline: poses in, asset out. Each stage is a function from plain structs to a plain struct.
#pragma once

#include "base/mesh/render_mesh.h"
#include "base/mesh/weld.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "elastic/energy/discrete_shells.h"
#include "elastic/parts/tie_report.h"
#include "output/asset/check_render_mesh.h"
#include "reduced/subspace/adaptive.h"
#include "reduced/surrogate/choose_surrogate.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

enum class Material { discrete_shells, arap, stvk, mooney_rivlin };
enum class SubspaceKind { adaptive, krylov, barbic };
enum class StandInKind { automatic, quartic, cubature, ghost };

// What an elastic energy is made of: shared by all verbs that need one.
struct EnergyOptions {
    std::optional<Material> material; // none: discrete shells for surfaces, stvk for solids
    ShellOptions shell;
    double poisson = -1;                       // of solids; negative: 0.4 for stvk, 0.45 for mooney-rivlin
    bool keep_placement = false;               // do not align the poses
    std::string fixed_path;                    // a file of vertices that stay where they are; empty: none
    std::vector<std::uint32_t> fixed_vertices; // the same by the files' numbers, where a certificate names them
    double weld_tolerance
        = default_weld_tolerance; // of surfaces: vertices this near in all poses are one (over the diagonal); 0: none
    SolverKind solver = default_solver();
};

struct BakeOptions {
    EnergyOptions energy;
    SubspaceKind subspace = SubspaceKind::adaptive;
    double tolerance = 1e-3;    // total relative L2, mean over the checks
    double tolerance_max = 0;   // the largest over them; 0: not bounded
    int ritz_count = 2;         // krylov: vectors per tangent
    Eigen::Index dimension = 0; // 0: what the tolerance or ritz_count asks for (barbic: 4 modes a pose); else exactly this
    StandInKind stand_in = StandInKind::automatic; // quartic for stvk up to 32 dimensions, else cubature
    std::size_t element_count = 0;                 // cubature elements; 0: as few as keep the tolerance
    CubatureSolver cubature_solver = CubatureSolver::nnls;
    std::size_t ghost_vertex_count = 800;
    std::uint64_t seed = 1;
    int check_count = 24;         // weights at which d, the elements and the dead load are judged
    int fresh_count = 4;          // weights that nothing was chosen by
    double position_error = 1e-5; // of a vertex by storing the basis in few bits, over the diagonal; 0: single precision
    bool keep_scene = true;       // of poses from glTF: store materials, texture coordinates and images
    std::shared_ptr<const DrawnSurface> drawn; // of a solid: what the asset draws in the place of its boundary; none: that
};

struct StageTime {
    std::string stage;
    double seconds;
};

// One blend of the finished asset, by the runtime, next to the truth.
struct AssetCheck {
    Weights weights;
    ShapeError error;
    double cell_ratio
        = 1; // smallest area of a triangle over the smallest it has in any pose; of a solid the smallest J = volume of
             // a tetrahedron over the largest it has in any pose
    bool is_fresh = false;     // nothing was chosen by it
    bool has_converged = true; // the truth
};

// How the basis was stored.
struct BasisReport {
    bool is_compact = false;
    double bytes_per_number = 0;
    double largest_difference
        = 0; // of a vertex as the runtime rebuilds it, at training averages and poses, over the diagonal
};

struct BakeReport {
    std::size_t vertex_count = 0, tet_count = 0, pose_count = 0, element_count = 0, foldover_count = 0;
    std::size_t drawn_vertex_count = 0; // of a surface whose elastic mesh is not the drawn one, as repairs tells; else 0
    std::size_t drawn_triangle_count = 0;
    std::vector<std::uint32_t> foldover_vertices; // of the edges of such hinges, numbers of the files; the first of them
    SurfaceRepairs repairs;
    StandInKind stand_in_kind = StandInKind::cubature; // what was chosen
    std::string stand_in_reason;                       // why, where there was a choice
    std::vector<std::uint32_t> fixed_vertices;         // numbers of the files
    Eigen::Index dimension = 0;
    std::vector<StageTime> stages;
    int factorization_count = 0;
    std::size_t start_pose = 0; // the average of all poses is reached from it
    std::vector<BranchFinding> findings;
    std::size_t training_count = 0;
    int unconverged_training_count = 0;
    AdaptiveReport adaptive;      // empty for other subspaces
    SubspaceError subspace_error; // over the checks
    StandInReport stand_in;
    double runtime_error = 0; // largest relative distance of runtime and double-precision model, relative L2
    std::vector<AssetCheck> checks;
    double mean_error = 0, largest_error = 0; // total, over all of them
    double largest_distance = 0, cell_ratio = 1;
    Weights worst_weights;
    bool meets_tolerance = false;
    BasisReport basis;
    std::optional<TieReport> ties;    // of a character in several parts, or with cracks
    std::optional<DrawnErrors> drawn; // at the same weights, where the asset draws a surface of its own
    std::string certificate;          // the JSON that went into the asset
};

struct BakedAsset {
    std::vector<std::uint8_t> bytes;
    BakeReport report;
};

// The material that the options mean for surfaces or solids. Throws Failure (usage, P1206) for one of the other sort.
Material material_for(const EnergyOptions& options, bool is_solid);

// The energy of a shape set. The set must outlive it. Of a character in several parts it costs some averages (elastic/parts/calibrate_ties.h).
std::unique_ptr<Energy> make_energy(const ShapeSet& set, const EnergyOptions& options, Progress* progress = nullptr);

// Bakes. Throws Failure, or Interrupted through progress. Cost for some 15,000 vertices and 5 poses:
// minutes with the adaptive subspace (4 to 8 measured, tests/bench/README.md), about one with krylov.
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
