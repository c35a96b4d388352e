// Drags a small bar: handles reach their targets, no tetrahedron turns over, every step ends in an equilibrium.
#include "../twisted_bar.h"

#include "base/mesh/tets.h"
#include "elastic/pose/drag.h"
#include "elastic/pose/rest_pose.h"
#include "input/io/encode_msh.h"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace pliant;

namespace {

constexpr int cells = 2, length_cells = 12;

// A folder of this process, gone at the end.
struct Folder {
    std::filesystem::path path = std::filesystem::temp_directory_path() / ("pliant_drag_" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string file(const std::string& name, const std::string& text) const
    {
        std::ofstream(path / name, std::ios::binary) << text;
        return (path / name).string();
    }
};

// The bar of twisted_bar.h at rest: along z, 1 x 1 x 6.
struct Bar {
    Folder folder;
    DiagnosticList diagnostics;
    RestPose rest;

    Bar()
    {
        const PoseSet poses = twisted_bar(cells, length_cells, 0);
        rest = *read_rest_pose(folder.file("bar.msh", encode_msh(poses.positions[0], poses.tets)), diagnostics);
        REQUIRE(!diagnostics.has_errors());
    }
    Handles handles(const std::string& script)
    {
        const Handles result(read_script(folder.file("script.txt", script), diagnostics), rest.mesh.positions, diagnostics);
        for (const Diagnostic& diagnostic : diagnostics.diagnostics()) INFO(diagnostic.where << ": " << diagnostic.what);
        REQUIRE(!diagnostics.has_errors());
        return result;
    }
};

Shape to_solver_units(const NormalizedPoses& set, const Positions& positions)
{
    Shape shape(positions.size());
    for (Eigen::Index i = 0; i < shape.size(); ++i) shape[i] = (positions(i / 3, i % 3) - set.centre[i % 3]) / set.length;
    return shape;
}

// Drags, and checks what must hold of every result.
Positions drag_and_check(const Bar& bar, const Handles& handles, SolidLaw law)
{
    const NormalizedPoses set = to_shape_set(bar.rest, handles.vertices());
    const SolidOptions material { law, -1 };
    int steps = 0;
    const DragResult result = drag(set, handles, material, [&](const DragStep& step) {
        CHECK(step.energy <= step.start_energy);
        CHECK(step.smallest_j > 0);
        ++steps;
    });
    CHECK(steps == result.steps);
    CHECK(steps >= handles.nominal_steps());
    CHECK(result.last.time == 1);

    const Positions places = handles.at(1);
    for (std::size_t i = 0; i < handles.vertices().size(); ++i)
        CHECK(result.positions.row(handles.vertices()[i]) == places.row(Eigen::Index(i)));

    // The positions as they are written: no tetrahedron turned over, no force on a vertex that is free.
    const Shape y = to_solver_units(set, result.positions);
    CHECK(smallest_j(set, y).value == doctest::Approx(result.last.smallest_j).epsilon(1e-6));
    CHECK(smallest_j(set, y).value > 0.1);
    const Solid energy(set, material);
    Shape forces = Shape::Zero(y.size());
    double scale = 0;
    CHECK(add_gradient(energy, Weights::Ones(1), y, forces, &scale) == doctest::Approx(result.last.energy).epsilon(1e-6));
    for (const std::uint32_t v : handles.vertices()) forces.segment<3>(3 * Eigen::Index(v)).setZero();
    CHECK(forces.norm() < 1e-4 * scale);
    return result.positions;
}

constexpr char bend[] = "box 0 0 0  1 1 0.1  hold   # the foot\n"
                        "box 0 0 0.9  1 1 1  turn 0.5 0.5 0.5  1 0 0  90\n";

} // namespace

TEST_CASE("a bar is bent by 90 degrees")
{
    Bar bar;
    const Handles handles = bar.handles(bend);
    CHECK(handles.nominal_steps() == 9);
    CHECK(handles.vertices().size() == 2 * std::size_t((cells + 1) * (cells + 1) * 2));
    for (const SolidLaw law : { SolidLaw::mooney_rivlin, SolidLaw::stvk }) {
        const Positions bent = drag_and_check(bar, handles, law);
        CHECK(bent.row(0) == bar.rest.mesh.positions.row(0)); // held to the bit
        // A quarter turn about the x axis through (0, 0, 3): the end of the bar, 3 above it, comes to y = -3.
        const Eigen::RowVector3d end = bent.bottomRows((cells + 1) * (cells + 1)).colwise().mean();
        CHECK((end - Eigen::RowVector3d(0, -3, 3)).norm() < 1e-12);
    }
}

// Its straight shape is an equilibrium, too, by symmetry, but of more energy.
TEST_CASE("a bar that is pressed along itself buckles")
{
    Bar bar;
    for (const char* press : { "-0.15", "-0.2" }) {
        const Handles handles = bar.handles("box 0 0 0  1 1 0  hold\nbox 0 0 1  1 1 1  move 0 0 " + std::string(press));
        const Positions pressed = drag_and_check(bar, handles, SolidLaw::mooney_rivlin);
        const int layer = (cells + 1) * (cells + 1);
        const Eigen::RowVector3d middle = pressed.middleRows(layer * length_cells / 2, layer).colwise().mean();
        const Eigen::RowVector3d foot = pressed.topRows(layer).colwise().mean();
        CHECK((middle - foot).head<2>().norm() > 0.3);
    }
}

TEST_CASE("a bar is twisted, stretched and taken hold of by numbers")
{
    Bar bar;
    const int last = (cells + 1) * (cells + 1) * (length_cells + 1) - 1;
    // Lengths are fractions of the diagonal.
    const double stretch = 1 / std::sqrt(38.0);
    const Handles handles
        = bar.handles("box 0 0 0  1 1 0  hold\nvertices " + std::to_string(last) + " " + std::to_string(last - 2) + " "
                      + std::to_string(last - 6) + " " + std::to_string(last - 8) + " turn 0.5 0.5 0  0 0 2  -80 move 0 0 "
                      + std::to_string(stretch) + "\r\n\n");
    CHECK(handles.nominal_steps() == 10); // 80 degrees and 0.162 of the diagonal
    const Positions result = drag_and_check(bar, handles, SolidLaw::mooney_rivlin);
    // The corner (1, 1, 12) / 2 turned clockwise by 80 degrees and lifted by one.
    const double angle = -80 * std::acos(-1.0) / 180;
    const Eigen::RowVector3d expected(0.5 * std::cos(angle) - 0.5 * std::sin(angle),
                                      0.5 * std::sin(angle) + 0.5 * std::cos(angle), 7);
    CHECK((result.row(last) - expected).norm() < 1e-5); // the script has six digits
}

TEST_CASE("motion that leaves no room is given up, not forced")
{
    Bar bar;
    // The end is to come to the other side of the foot: the body between them would be inside out.
    const Handles handles = bar.handles("box 0 0 0  1 1 0.45  hold\nbox 0 0 0.55  1 1 1  move 0 0 -0.5\n");
    const NormalizedPoses set = to_shape_set(bar.rest, handles.vertices());
    try {
        drag(set, handles, { SolidLaw::mooney_rivlin, -1 });
        FAIL("a body turned inside out was taken for a pose");
    } catch (const Failure& failure) {
        CHECK(failure.code() == ExitCode::failed);
        CHECK(failure.diagnostics()[0].number == 4304);
        CHECK(std::string(failure.what()).find("stuck at") != std::string::npos);
    }
}

TEST_CASE("the first region that names a vertex has it")
{
    Bar bar;
    const Handles handles
        = bar.handles("sphere 0.5 0.5 1  0.06  hold\nbox 0 0 0.9  1 1 1  move 0.01 0 0\nbox 0 0 0 1 1 0 hold\n");
    const std::size_t layer = (cells + 1) * (cells + 1);
    CHECK(handles.count(0) == 1); // the middle of the end
    CHECK(handles.count(1) == 2 * layer - 1);
    CHECK(handles.count(2) == layer);
}
