#include "bake/estimate.h"

#include "base/common/parallel.h"
#include "base/weights/weights.h"
#include "elastic/average/family.h"
#include "input/gltf/render_scene.h"
#include "pliant_format.h"
#include "reduced/subspace/mixtures.h"

#include <algorithm>
#include <cmath>

namespace pliant {

// Fills the simplex more or less evenly; for two poses a line.
std::size_t training_count(std::size_t pose_count)
{
    const std::size_t counts[] = { 33, 80, 128, 160, 192 };
    return pose_count < 7 ? counts[std::max<std::size_t>(pose_count, 2) - 2] : 256;
}

namespace {

std::size_t weight_count(std::size_t pose_count, const BakeOptions& options)
{
    return pose_count - (options.energy.blend == Blend::layers);
}

bool is_of_mixtures(std::size_t pose_count, const BakeOptions& options)
{
    return options.energy.blend == Blend::layers || pose_count > few_poses;
}

// Averages at most.
std::size_t snapshot_limit(std::size_t pose_count, const BakeOptions& options)
{
    return is_of_mixtures(pose_count, options) ? mixture_count(weight_count(pose_count, options))
                                               : training_count(pose_count);
}

// Bytes of images and of the vertices' attributes.
double scene_size(const PoseSet& poses)
{
    double size = 0;
    if (!poses.scene) return size;
    for (const std::string& image : poses.scene->images) size += double(image.size());
    for (const VertexAttribute& attribute : poses.scene->attributes) size += sizeof(float) * double(attribute.values.size());
    return size;
}

// The adaptive dimension depends on the poses. Of averages about four per pair, found on bodies in very different poses
// (fewer when they are alike); of layers six each, of many poses twice their number.
double expected_dimension(std::size_t pose_count, const BakeOptions& options)
{
    const double m = double(pose_count), l = double(weight_count(pose_count, options));
    if (options.dimension) return double(options.dimension);
    if (options.subspace != SubspaceKind::adaptive)
        return std::min((m - 1) + m * (m - 1) * (1 + options.ritz_count), double(PLIANT_FORMAT_MAX_DIMENSION));
    if (options.energy.blend == Blend::layers) return std::min(64 + l, 6 * l);
    return pose_count > few_poses ? 2 * m : std::min(64.0, 4 * m * (m - 1) / 2);
}

} // namespace

int factorization_limit(std::size_t pose_count, const BakeOptions& options)
{
    // Newton's method from a guess: in each iteration the exact and the projected Hessian. A way ends with one such step and
    // its tangent; once more it starts at a blend or at the neighbours.
    constexpr int step_limit = 2 * iteration_limit + 2;
    const int training = std::max(int(snapshot_limit(pose_count, options)), int(options.dimension) + 8); // in groups of 8
    const int averages = int(pose_count) + training + options.check_count + 2 * options.fresh_count;     // two ways to these
    return averages * (path_limit + 2 * step_limit);
}

BakeEstimate estimate_bake(const PoseSet& poses, const BakeOptions& options)
{
    const std::size_t pose_count = poses.pose_count();
    const double n = double(poses.vertex_count()), m = double(pose_count);
    const bool is_adaptive = options.subspace == SubspaceKind::adaptive, has_mixtures = is_of_mixtures(pose_count, options);
    BakeEstimate estimate {};
    estimate.dimension = Eigen::Index(expected_dimension(pose_count, options));
    const double d = double(estimate.dimension);
    // From bakes of human_pair, creature, ict_face and makehuman on two cores: seconds of a factorisation with its Hessian
    // and the steps taken with it, and of a reduced gradient. Within a factor of two of these; too little where many
    // averages snap.
    const double factorisation = 0.14 * std::pow(n / 1e4, 1.3), gradient = 0.6e-6 * n * (1 + d / 60);
    const double training = is_adaptive ? double(snapshot_limit(pose_count, options)) : 0;
    const double averages = training + double(options.check_count);
    // A training average takes about 1.4; half of them are interpolated, more or less. Of mixtures none is.
    const double factorisations = has_mixtures ? 4 * (0.6 * training + double(options.check_count + options.fresh_count))
                                               : 8 * m + 0.7 * training + double(options.check_count + options.fresh_count);
    const double solves = double(options.check_count) + (is_adaptive ? 0 : double(training_count(pose_count)));
    estimate.seconds = factorisations * factorisation + solves * 20 * gradient + d * d * 4e-3;
    constexpr double preview_share = 0.2; // of the seconds of a whole bake
    if (options.time_limit)
        estimate.seconds = std::clamp(*options.time_limit, preview_share * estimate.seconds, estimate.seconds);
    // Factor and Hessian of every thread, all averages three times over while their directions are found, up to 64 with
    // their derivatives as rotations and strains (48 bytes a vertex of a surface), a few copies of the basis. Besides, the
    // process and what it needs for the smallest of meshes, the rows of 12 degrees of freedom of the elements that compete
    // (8,000 of about five a vertex), as they are and whitened, and the scene: read, kept, encoded, opened and written.
    constexpr double process = 40 << 20;
    const double rows = sizeof(double) * 12 * 2 * d * std::min(8e3, 5 * n);
    const double derivatives = has_mixtures ? 4 * m : 2 * m * std::min(training, 64 + m), scene = scene_size(poses);
    estimate.memory = process + 5 * scene + rows + 18e3 * n * double(worker_count())
        + 24 * n * (5 * d + (is_adaptive ? 3 * averages : 0) + derivatives);
    // Triangles, about 1.7 bytes for a number of the basis, and elements of 9 rows.
    estimate.asset_size = (options.keep_scene ? scene : 0) + 24 * n + 1.7 * n * d + 4 * d * 36 * (d + 1 + m);
    return estimate;
}

} // namespace pliant
