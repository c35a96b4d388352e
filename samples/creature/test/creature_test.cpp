// Generates the character and checks the properties that README.md promises. Usage: creature_test [VERTICES].
#include "../creature.h"
#include "mesh_checks.h"

#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

int failures = 0;

void expect(bool holds, const std::string& what)
{
    if (holds) return;
    ++failures;
    std::printf("FAILED: %s\n", what.c_str());
}

using namespace pliant::creature;

void test_topology(const Character& character, int wanted_vertices)
{
    const int n = int(character.poses.front().points.size());
    expect(character.poses.size() == 5, "five poses");
    expect(std::abs(n - wanted_vertices) <= wanted_vertices / 20,
           "the number of vertices is within 5 % of the one asked for");
    const TopologyReport topology = check_topology(n, character.faces);
    expect(topology.closed_manifold, "closed oriented manifold");
    expect(topology.all_vertices_used, "no unreferenced vertex");
    expect(topology.components == 1, "one component");
    expect(topology.euler_characteristic == 2, "genus 0");
}

// Prints the places of up to ten crossings, in the rest pose.
void report_crossings(const ShapeReport& report, const NamedShape& rest)
{
    for (std::size_t i = 0; i < report.crossings.size(); i += 1 + report.crossings.size() / 10) {
        const Vec3 &a = rest.points[report.crossings[i][0]], &b = rest.points[report.crossings[i][1]];
        std::printf("    at (%.1f %.1f %.1f) with (%.1f %.1f %.1f)\n", a.x(), a.y(), a.z(), b.x(), b.y(), b.z());
    }
}

void test_shapes(const Character& character)
{
    for (const NamedShape& pose : character.poses) {
        const ShapeReport r = check_shape(pose.points, character.faces);
        const bool rest = pose.name == "rest";
        std::printf(
            "%-6s smallest angle %5.2f deg, edge ratio %4.2f, largest dihedral %.3f rad, volume %.3f, crossings %zu\n",
            pose.name.c_str(), r.smallest_angle, r.edge_ratio, r.largest_dihedral, r.volume, r.crossings.size());
        expect(pose.points.size() == character.poses.front().points.size(), pose.name + ": as many vertices as rest");
        expect(r.finite, pose.name + ": finite");
        expect(r.coincident_vertices == 0, pose.name + ": no duplicate vertices");
        expect(r.smallest_angle > (rest ? 12.0 : 4.0), pose.name + ": no slivers");
        expect(!rest || r.edge_ratio < 8.0, pose.name + ": even triangles");
        expect(r.largest_dihedral < 2.0, pose.name + ": no folds");
        expect(r.volume > 0.0, pose.name + ": faces look outwards");
        expect(r.crossings.empty(), pose.name + ": does not cross itself");
        report_crossings(r, character.poses.front());
    }
}

// Few edges change their length much between any two poses.
void test_stretch(const Character& character)
{
    for (const NamedShape& from : character.poses)
        for (const NamedShape& to : character.poses) {
            const StretchReport r = check_stretch(from.points, to.points, character.faces);
            if (&from == &character.poses.front())
                std::printf("rest -> %-6s edge lengths x %.2f to %.2f, %.2f %% outside 0.6 to 1.7\n", to.name.c_str(),
                            r.least, r.most, 100.0 * r.share_outside);
            expect(r.share_outside < 0.01, from.name + " to " + to.name + ": 99 % of the edges keep their length");
        }
}

} // namespace

int main(int argc, char** argv)
{
    const int vertex_count = argc > 1 ? std::atoi(argv[1]) : 12000;
    const Character character = build_character(vertex_count);
    std::printf("%zu vertices, %zu faces\n", character.poses.front().points.size(), character.faces.size());
    test_topology(character, vertex_count);
    test_shapes(character);
    test_stretch(character);
    return failures > 0;
}
