// The C runtime as the baker uses it: to check what was written, to measure, and to blend on the command line.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"
#include "base/weights/domain.h"

#include "pliant.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pliant {

// Why the runtime refuses bytes, as a message (P5102). `path`: what they are called there.
Failure open_failure(pliant_result result, const std::string& path);

std::string certificate_of(const pliant_asset& asset); // JSON text
Polygons faces_of(const pliant_asset& asset);          // as the input gave them; of a solid its boundary

// An asset in aligned memory, opened by the runtime, with one solver. Movable, not copyable; one thread at a time.
class RuntimeBlender {
public:
    // Opens a copy of the bytes. Throws Failure (bad_input, P51xx) naming `path` if the runtime refuses them.
    RuntimeBlender(const std::vector<std::uint8_t>& bytes, const std::string& path, bool verify_checksums = false);

    // Reads the file first, an asset or a GLB with one inside, and verifies its checksums. Throws Failure (bad_input): as
    // above, and P2001, P2002 if it cannot be read.
    static RuntimeBlender from_file(const std::string& path);

    const pliant_asset& asset() const { return *asset_.get(); }
    WeightDomain domain() const;

    // Solves as a new solver would (`continuous` false) or going on from the last call. Throws Failure (usage, P1203) for
    // bad weights, naming them.
    std::vector<float> solve(const std::vector<float>& weights, bool continuous, pliant_solve_info* info = nullptr);

    // Positions of all vertices (3n floats, input units).
    std::vector<float> positions(const std::vector<float>& q) const;

    std::string pose_name(std::uint32_t pose) const;
    std::string certificate() const { return certificate_of(asset()); }
    Polygons faces() const { return faces_of(asset()); }
    std::vector<std::uint32_t> source_vertices() const; // of a solid: per vertex its number in the pose files; else empty

    // Coordinates of an example pose (d).
    std::vector<float> pose_coordinates(std::uint32_t pose) const;

    // The solver goes on until it is much nearer to the minimum than a frame needs; it starts anew.
    void solve_tightly();

    // Changes the solver's settings (default: those of the runtime); starts it anew.
    void configure(const pliant_solver_desc& desc);

private:
    Asset asset_;
    std::optional<Solver> solver_;
};

} // namespace pliant
