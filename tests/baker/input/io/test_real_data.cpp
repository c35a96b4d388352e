// Real poses of other people's making: all of them load, and spoilt ones are found out.
#include <doctest/doctest.h>

#include "files.h"
#include "input/io/encode_ply.h"
#include "input/poses/load_poses.h"
#include "skip.h"

#include <algorithm>

using namespace pliant;
using pliant_test::TemporaryFolder;

namespace {

std::vector<std::string> files_in(const std::string& folder, const std::string& extension)
{
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() == extension) paths.push_back(entry.path().string());
    }
    std::sort(paths.begin(), paths.end());
    return paths;
}

} // namespace

TEST_CASE("real data loads without errors")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    for (const char* set : { "goast_small/hinge", "goast_small/plate", "goast_small/saddle", "goast_small/sphere",
                             "human_pair", "ict_face", "makehuman_body", "mhr_body", "mhr_body_hi" }) {
        CAPTURE(set);
        const std::vector<std::string> paths = files_in(data + "/" + set, ".ply");
        std::vector<Diagnostic> warnings;
        const PoseSet poses = load_poses(paths, {}, &warnings);
        CHECK(poses.pose_count() == paths.size());
        // The saddle bends the other way, which is its mirror image; nothing else is remarkable.
        const bool is_saddle = std::string(set) == "goast_small/saddle";
        REQUIRE(warnings.size() == (is_saddle ? 1 : 0));
        if (is_saddle) CHECK(warnings[0].number == 3011);
    }
    // In any order: the first pose is the one that others are compared with.
    std::vector<std::string> bodies = files_in(data + "/makehuman_body", ".ply");
    for (int i = 0; i < 3; ++i) {
        std::rotate(bodies.begin(), bodies.begin() + 2, bodies.end());
        CHECK(load_poses(bodies).pose_count() == bodies.size());
    }
}

TEST_CASE("real data, spoilt")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    const auto number
        = [](const std::vector<std::string>& paths) { return pliant_test::number_of([&] { load_poses(paths); }); };
    // Parts are told.
    for (const char* set : { "cloth_ball", "ict_face/original_obj" }) {
        CAPTURE(set);
        const bool is_obj = std::string(set) != "cloth_ball";
        std::vector<Diagnostic> warnings;
        const PoseSet poses = load_poses(files_in(data + "/" + set, is_obj ? ".obj" : ".ply"), {}, &warnings);
        CHECK(poses.repairs.component_count > 1);
        CHECK(std::any_of(warnings.begin(), warnings.end(), [](const Diagnostic& f) { return f.number == 2208; }));
    }

    const TemporaryFolder folder;
    for (const std::string set :
         { "ict_face/neutral ict_face/jaw_open", "mhr_body/rest mhr_body/pose2", "human_pair/man human_pair/woman",
           "goast_small/sphere/unitSphere3 goast_small/sphere/unitSphere3_defX" }) {
        CAPTURE(set);
        const std::size_t space = set.find(' ');
        const std::vector<std::string> paths
            = { data + "/" + set.substr(0, space) + ".ply", data + "/" + set.substr(space + 1) + ".ply" };
        PoseSet poses = load_poses(paths);
        const auto changed = [&](const Positions& positions) {
            pliant_test::write_bytes(folder / "changed.ply", encode_ply(positions, poses.polygons));
            return number({ paths[0], folder / "changed.ply" });
        };
        CHECK(changed(poses.positions[1]) == 0);
        CHECK(changed(poses.positions[1] * Eigen::Vector3d(1, -1, 1).asDiagonal()) == 3007);
        CHECK(changed(100 * poses.positions[1]) == 3008);
        CHECK(changed(poses.positions[0]) == 3009);
        Positions shifted = poses.positions[1]; // one vertex was inserted and one lost: every number is off by one
        shifted << poses.positions[1].bottomRows(1), poses.positions[1].topRows(shifted.rows() - 1);
        // Neighbours may have neighbouring numbers, so small stretch is possible
        const int number_of_shifted = changed(shifted);
        CHECK((number_of_shifted == 3006 || number_of_shifted == 0));
        Positions reversed = poses.positions[1].colwise().reverse();
        CHECK(changed(reversed) == 3006);
    }
}
