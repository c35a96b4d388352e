// What the command line calls a pose: a mesh file, or a glTF file with what of it is wanted.
#pragma once

#include "base/common/diagnostics.h"
#include "base/mesh/pose_set.h"

#include <optional>
#include <string>
#include <vector>

namespace pliant {

// "hero.glb#animation=Run@0,0.3" cut into a file and a choice. A '#' counts only behind a name that ends in .glb or .gltf.
struct PoseArgument {
    std::string path;
    std::string choice; // behind the '#'; empty: all there is
};
PoseArgument split_pose_argument(const std::string& argument);

// The poses of all arguments, in order.
struct PoseSources {
    Blend blend = Blend::average;
    std::vector<MeshFile> meshes; // those that could be read
    bool has_first = false;       // the first argument is among them
    bool share_frame = false;     // all are of one glTF file
    std::size_t count = 0;        // poses asked for; of an unreadable glTF file one
};

// Reads every argument: a mesh file (read_mesh) gives one pose, a glTF file
//   FILE.glb                        its shape at rest, then every morph target alone at weight 1
//   FILE.glb#rest                   its shape at rest: morph weights 0, nodes as the file places them, skins applied
//   FILE.glb#target=NAME[,NAME...]  these morph targets, each alone at weight 1
//   FILE.glb#animation=NAME@T[,T...] the animation (by name, or by number from 0) at these seconds
// Vertices and triangles come as an engine decodes them: all primitives of triangles of all meshes in the default scene, in
// the order of the nodes' numbers. Poses of one file share their RenderScene.
// Without a kind of blend one glTF file with morph targets, named without a choice, is one of layers, since that is what its
// targets mean; everything else is one of averages.
// Wrong choices (P1211 to P1213) are thrown as Failure (usage); more than pose_limit() poses or fewer than two as P3002 and
// P3001 (bad_input), before any is made. Everything else goes to the diagnostics: P2xxx.
PoseSources read_pose_sources(const std::vector<std::string>& arguments, std::optional<Blend> blend,
                              DiagnosticList& diagnostics);

// An animation of a glTF file: its name, or its number where it has none.
struct AnimationChoice {
    std::string name;
    double seconds = 0; // its end
};

// The animations of a glTF file, for people who choose poses. Throws Failure (bad_input) if the file is none.
std::vector<AnimationChoice> animation_choices(const std::string& path);

// "hero.glb#animation=Run@0,0.4,0.8": three poses of an animation, as an argument.
std::string example_of(const std::string& path, const AnimationChoice& animation);

// 64 weights: of layers the rest shape has none.
constexpr std::size_t pose_limit(Blend blend) { return blend == Blend::layers ? 65 : 64; }

} // namespace pliant
