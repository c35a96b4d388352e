// A whole bake of more poses than anybody blends at once, looked at through the C runtime.
#include "../for_reference.h"
#include "../layered_bodies.h"

#include "base/mesh/align.h"
#include "base/weights/domain.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace pliant;

namespace {

// A tube of 16 poses: four angles of the twist below by four of the bend above.
PoseSet many_poses()
{
    PoseSet poses = tube_poses(1, Tube {});
    const Positions straight = poses.positions[0];
    poses.positions.clear();
    poses.names.clear();
    for (int i = 0; i < 16; ++i) {
        poses.positions.push_back(layered_positions(straight, 0.4 * (i % 4), 0.4 * (i / 4)));
        poses.names.push_back("pose" + std::to_string(i));
    }
    poses.paths = poses.names;
    return poses;
}

} // namespace

TEST_CASE("sixteen poses bake to an asset whose blends are near the averages")
{
    const PoseSet poses = many_poses();
    BakeOptions options;
    options.tolerance = 3e-3;
    Progress silent;
    const BakedAsset baked = bake(poses, options, silent);
    CHECK(baked.report.check.meets_tolerance);
    CHECK(baked.report.snapshot_count > 40);
    CHECK(baked.report.interpolated_count == 0);
    CHECK(baked.report.fit.dimension <= 28);

    RuntimeBlender blender(baked.bytes, "many");
    const NormalizedPoses set = normalize(poses, true);
    CHECK(blender.asset().weight_count == 16);
    for (const std::size_t k : { 0, 7, 15 }) { // poses come back
        std::vector<float> w(16, 0.0f);
        w[k] = 1;
        CHECK(relative_distance(set, from_input_units(set, blender.positions(blender.solve(w, false))), set.shapes[k])
              < 1e-4);
    }
    std::vector<float> corners(16, 0.0f), few(16, 0.0f);
    corners[0] = corners[15] = corners[3] = corners[12] = 0.25f;
    few[5] = few[10] = 0.5f;
    write_for_reference("many", baked, blender, { corners, few, std::vector<float>(16, 0.0625f) });
}

TEST_CASE("weights of many poses: a third of them of few, the same for the same seed")
{
    const WeightDomain domain = WeightDomain::simplex(40);
    CHECK(domain.is_wide());
    CHECK(!WeightDomain::simplex(12).is_wide());
    const std::vector<Weights> all = domain.draw_all(5, 30);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto used = (all[i].array() > 0).count();
        CHECK(all[i].sum() == doctest::Approx(1));
        CHECK((i % 3 == 2 ? used == 40 : i % 3 == 1 ? used == 2 : used >= 3 && used <= 6));
        CHECK(all[i] == domain.draw_all(5, 30)[i]);
    }
}
