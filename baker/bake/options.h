// What a bake is asked for. The defaults are those of the command line.
#pragma once

#include "base/mesh/pose_set.h"
#include "base/mesh/render_mesh.h"
#include "base/mesh/weld.h"
#include "elastic/average/solver_pool.h"
#include "elastic/energy/discrete_shells.h"
#include "reduced/surrogate/cubature.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

enum class Material { discrete_shells, arap, stvk, mooney_rivlin };
enum class Continuity { automatic, off };
enum class SubspaceKind { adaptive, krylov, barbic };
enum class SurrogateKind { automatic, quartic, cubature, ghost };

// The numbers that a command line, a configuration and a certificate may hold.
struct NumberRange {
    double least, most;
};
constexpr NumberRange poisson_range { 0, 0.499 }, thickness_range { 1e-6, 1 }, foldover_damping_range { 0, 1 },
    weld_range { 0, 1e-3 };

// What an elastic energy is made of: shared by all verbs that need one.
struct EnergyOptions {
    std::optional<Blend> blend;       // none: what the poses are
    std::optional<Material> material; // none: stvk for solids, discrete shells for surfaces
    // Of discrete shells. automatic: with ARAP cells at rough vertices; off: as in the literature.
    Continuity continuity = Continuity::automatic;
    ShellOptions shell;
    double poisson = -1;                       // of solids; negative: 0.4 for stvk, 0.45 for mooney-rivlin
    bool keep_placement = false;               // do not align the poses; layers are where they are anyway
    std::string fixed_path;                    // a file of vertices that stay where they are; empty: none
    std::vector<std::uint32_t> fixed_vertices; // the same by the files' numbers, where a certificate names them
    // Of surfaces: vertices this near in all poses are one (over the diagonal); 0: none
    double weld_tolerance = default_weld_tolerance;
    SolverKind solver = default_solver();
};

// The range of a layer's weight, by the layer's name; without one of all layers that no other names.
struct NamedRange {
    std::string layer;
    WeightRange range;
};

struct BakeOptions {
    EnergyOptions energy;
    std::vector<NamedRange> ranges; // of layers
    SubspaceKind subspace = SubspaceKind::adaptive;
    double tolerance = 1e-3;    // total relative L2, mean over the checks
    double tolerance_max = 0;   // the largest over them; 0: not bounded
    int ritz_count = 2;         // krylov: vectors per tangent
    Eigen::Index dimension = 0; // 0: what the tolerance or ritz_count asks for (barbic: 4 modes); else exactly this
    SurrogateKind surrogate = SurrogateKind::automatic; // quartic for stvk up to 32 dimensions, else cubature
    std::size_t element_count = 0;                      // cubature elements; 0: as few as keep the tolerance
    CubatureSolver cubature_solver = CubatureSolver::nnls;
    std::size_t ghost_vertex_count = 800;
    std::uint64_t seed = 1;
    int check_count = 24; // weights at which d, the elements and the dead load are judged
    int fresh_count = 16; // weights that nothing was chosen by
    // Of a vertex by storing the basis in few bits, over the diagonal; 0: single precision. Without one: basis_error().
    std::optional<double> position_error;
    double basis_error() const { return position_error.value_or(std::min(5e-5, tolerance / 20)); }
    // Seconds from the start of the bake, after which it refines no more and writes the best so far. 0: it refines nothing.
    std::optional<double> time_limit;
    bool keep_scene = true; // of poses from glTF: store materials, texture coordinates and images
    // Of a solid: the surface that the asset draws instead of the solid's boundary. Null: the boundary.
    std::shared_ptr<const RenderMesh> render_mesh;
};

// Where the weights lie; ranges are widened to hold the initial weights of the poses. Throws Failure (usage, P1231 to P1233)
// for ranges that are empty, do not hold 0 or name no layer.
WeightDomain domain_of(const BakeOptions& options, const PoseSet& poses);

// Throws Failure (usage, P1240) if a tolerance is given and no blend is to be compared with an average.
void require_comparisons(const BakeOptions& options, bool has_tolerance);

// A bake that refines nothing, with a rough tolerance: each unless the caller sets a limit of time or a tolerance.
void make_preview(BakeOptions& options, bool has_tolerance);

// Names used on the command line and in JSON.
const char* name_of(Blend blend);
const char* name_of(Material material);
const char* name_of(Continuity continuity);
const char* name_of(Membrane membrane);
const char* name_of(SubspaceKind kind);
const char* name_of(SurrogateKind kind);
const char* name_of(SolverKind kind);

} // namespace pliant
