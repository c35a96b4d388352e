// Does the unreduced average converge? At equal weights and at ten random ones, on real poses.
//   pliant_converge POSE... [-- POSE...]...
// One line a weight; exit code 1 if any of them did not converge. Minutes per set: not part of the test run.
#include "bake/bake.h"
#include "bake/make_energy.h"
#include "cli/console.h"
#include "elastic/average/family.h"
#include "input/poses/load_poses.h"

#include <cstring>
#include <fmt/core.h>

using namespace pliant;

namespace {

void print(const char* name, const NewtonResult& r)
{
    fmt::print("  {:<8} {:<13} {:3} iterations, decrement {:.1e}, unbalanced force {:.1e}, energy {:.6e}\n", name,
               r.has_converged ? "converged" : "NOT CONVERGED", r.iterations, r.decrement, r.residual, r.energy);
    std::fflush(stdout);
}

int unconverged_of(const std::vector<std::string>& paths)
{
    const PoseSet poses = load_poses(paths);
    const NormalizedPoses set = normalize(poses);
    const std::unique_ptr<Energy> energy = make_energy(set, EnergyOptions());
    SolverPool pool(*energy, set, default_solver());
    AverageFamily family(pool, NewtonOptions(), nullptr);
    fmt::print("{} ...: {} vertices, {} poses\n", paths[0], poses.vertex_count(), poses.pose_count());
    print("equal", family.mean());
    int unconverged = !family.mean().has_converged;
    Random random(7);
    for (int i = 0; i < 10; ++i) {
        const NewtonResult result = family.at(random.weights(set.pose_count(), i % 2 == 1), 0, nullptr).average;
        print("random", result);
        unconverged += !result.has_converged;
    }
    return unconverged;
}

} // namespace

int main(int argc, char** argv)
try {
    std::vector<std::vector<std::string>> sets(1);
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--"))
            sets.emplace_back();
        else
            sets.back().push_back(argv[i]);
    }
    int unconverged = 0;
    for (const auto& set : sets) unconverged += unconverged_of(set);
    return unconverged ? 1 : 0;
} catch (const Failure& failure) {
    for (const Diagnostic& branch : failure.branches()) print_finding("converge", branch);
    return int(failure.code());
}
