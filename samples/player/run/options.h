// The command line.
#pragma once

#include "blend/character.h"
#include "blend/weight_path.h"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>

#include <optional>
#include <string>
#include <vector>

namespace pliant::player {

// How the shapes of a crowd are reconstructed. automatic: by pliant::gl, unless the driver renders on the processor.
enum class Rebuild { automatic, gpu, cpu };

struct Options {
    std::string asset;
    std::string screenshot; // path; empty: none
    std::string sheet;      // path; empty: none
    std::string sequence;   // pattern of paths; empty: none
    int benchmark_frames = 0;
    bool json = false;
    std::vector<double> weights;          // empty: equal, of layers those that the asset starts with
    std::vector<std::string> set_weights; // of layers: NAME=W
    std::string path;                     // file of weights; empty: none
    double fps = 30.0;                    // rows per second
    int count = 0;                        // pictures of a sequence; 0: one per row of the path
    std::string truth_weights, truth_pattern;
    bool heat = false;
    int crowd = 0; // characters; 0: not a crowd
    Rebuild rebuild = Rebuild::automatic;
    bool linear = false;
    bool both = false;
    bool hud = false;
    bool plain = false; // without the asset's materials
    bool wire = false;  // with the edges of all triangles
    bool up_is_z = false;
    int width = 0, height = 0;     // 0: the default of the mode
    std::optional<glm::vec2> view; // yaw and pitch in degrees
    double exit_after = 0.0;       // seconds; 0: never

    bool has_weights() const { return !weights.empty() || !set_weights.empty(); }
    glm::mat3 to_world() const;
};

// The options, or an exit code if nothing is left to do (--help, --version).
struct ParsedLine {
    Options options;
    std::optional<int> exit_code;
};
// Throws Error for wrong usage.
ParsedLine parse_command_line(int argc, char** argv);

// The path to play: the one that the options name, else layer_walk() if the asset has layers. Throws Error.
std::optional<WeightPath> path_for(const Options& options, const AssetFile& file);

// The weights to show for an asset: as given, else equal, or of layers those that the asset starts with. Throws Error
// (P5902) if they are not weights of this asset.
std::vector<double> weights_for(const Options& options, const AssetFile& file);

} // namespace pliant::player
