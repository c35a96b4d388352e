// What a bake reports. The certificate, the report file, the command line and the warnings read it.
#pragma once

#include "bake/options.h"
#include "base/mesh/pose_set.h"
#include "elastic/average/family.h"
#include "elastic/average/shape_error.h"
#include "elastic/parts/tie_report.h"
#include "output/asset/check_render_mesh.h"
#include "reduced/surrogate/choose_surrogate.h"
#include "reduced/surrogate/reduced_solver.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant {

struct StageTime {
    std::string stage;
    double seconds;
};

// The poses and their energy. Vertices are named by their numbers in the files.
struct InputReport {
    std::size_t vertex_count = 0, tet_count = 0, pose_count = 0;
    Material material = Material::discrete_shells;
    std::size_t drawn_vertex_count = 0, drawn_triangle_count = 0; // of a render mesh that repairs made; else 0
    SurfaceRepairs repairs;
    bool is_aligned = true;                       // the poses were, with the first
    std::size_t rough_count = 0;                  // vertices with an ARAP cell, of reinforced shells
    std::uint32_t roughest_vertex = 0;            // of them
    std::size_t foldover_count = 0;               // hinges whose bending is damped
    std::vector<std::uint32_t> foldover_vertices; // of the edges of such hinges, the first of them
    std::vector<std::uint32_t> fixed_vertices;    // ascending
    std::vector<std::string> pose_names;
    std::vector<WeightRange> ranges; // of layers
};

// The surrogate energy and the dimension that were chosen.
struct FitReport {
    Eigen::Index dimension = 0;
    SurrogateKind kind = SurrogateKind::cubature;
    std::string reason; // why this kind, where there was a choice
    std::size_t element_count = 0;
    std::size_t training_count = 0;
    int unconverged_training_count = 0;
    SurrogateReport surrogate;
    SubspaceError subspace_error; // over the checks
};

// One blend of the finished asset, by the runtime, next to the unreduced average.
struct BlendCheck {
    Weights weights;
    ShapeError error;
    // The smallest ratio of a triangle's area to its smallest area in any pose; of a solid the smallest J: the ratio of a
    // tetrahedron's volume to its largest volume in any pose.
    double cell_ratio = 1;
    bool is_fresh = false;     // nothing was chosen by it
    bool has_converged = true; // the unreduced average
    bool is_near_jump = false; // a jump lies on the way to these weights, or another average
    const char* kind = "";     // of layers: WeightDomain::kind_of()
    double linear_error = 0;   // of layers: of the sum of their displacements, relative L2
};

// Blends of one kind of mixture of layers; relative L2.
struct KindErrors {
    std::string kind;
    std::size_t count = 0, lost_count = 0; // with errors; where no shape was found to compare with
    double mean = 0, largest = 0, linear_mean = 0, linear_largest = 0;
};

// How the basis was stored.
struct BasisReport {
    bool is_compact = false;
    double bytes_per_number = 0;
    // Of a vertex as the runtime rebuilds it, at training averages and poses, over the diagonal.
    double largest_difference = 0;
};

// Blends of the finished asset, and how they stand to the tolerance.
struct CheckReport {
    double runtime_error = 0; // largest distance of runtime and double-precision model, relative L2
    std::vector<BlendCheck> blends;
    double mean_error = 0, largest_error = 0; // relative L2, over all blends; of layers over those that are judged
    double largest_distance = 0;              // of a vertex, over the diagonal
    double cell_ratio = 1;                    // the smallest
    Weights worst_weights;
    bool meets_tolerance = false; // the mean, the largest if bounded, and every blend next to a jump
    BasisReport basis;
    std::vector<KindErrors> kinds;               // of layers
    double linear_error = 0;                     // of layers: as mean_error, of the linear sum
    std::optional<TieReport> ties;               // of a character in several parts, or with cracks
    std::optional<RenderMeshErrors> render_mesh; // at the same weights, of a solid that draws a surface of its own
};

struct BakeReport {
    InputReport input;
    std::size_t start_pose = 0;         // the average of all poses is reached from it
    std::size_t snapshot_count = 0;     // unreduced averages
    std::size_t interpolated_count = 0; // averages between them, which were not computed
    int unconverged_snapshot_count = 0;
    FitReport fit;
    CheckReport check;
    std::vector<Branch> branches; // where the family of averages jumps; vertices by their numbers in the files
    int factorization_count = 0;
    std::vector<StageTime> stages;
    std::string certificate; // the JSON that went into the asset
};

} // namespace pliant
