// libFuzzer target: any bytes as a glTF file in memory: container, JSON, accessors, compressed views and Draco streams, the
// scene at rest and with every morph target, animations, what it is drawn with. Everything that is wrong is a Failure with
// numbered messages; no other exception leaves.
#include "input/gltf/animation.h"
#include "input/gltf/evaluate.h"
#include "input/gltf/read_render_scene.h"

#include <cstdlib>
#include <new>

using namespace pliant;

namespace {

constexpr std::size_t largest = 1 << 16; // vertices and triangles: more only cost time

void require(bool condition)
{
    if (!condition) std::abort();
}

void use_state(const GltfScene& scene, const GltfState& state, std::size_t vertex_count)
{
    Positions normals;
    std::vector<Diagnostic> warnings;
    GltfAllowance allowance(*scene.document);
    const Positions positions = evaluate(scene, state, allowance, &normals);
    require(positions.rows() == normals.rows() && static_cast<std::size_t>(positions.rows()) == vertex_count);
    render_scene(scene, normals, warnings);
}

void use_document(const std::shared_ptr<const GltfDocument>& document)
{
    std::vector<Diagnostic> warnings;
    document->named_files();
    const GltfScene scene = read_scene(document, warnings);
    const std::size_t vertex_count = scene.vertex_count();
    if (vertex_count > largest) return;
    for (const Triangle& triangle : triangles_of(scene))
        for (const std::uint32_t v : triangle) require(v < vertex_count);
    use_state(scene, scene.rest, vertex_count);
    GltfState all = scene.rest;
    for (std::vector<double>& weights : all.weights) weights.assign(weights.size(), 1);
    use_state(scene, all, vertex_count);
    const std::size_t animation_count = animation_names(*document).size();
    GltfAllowance allowance(*document);
    for (std::size_t i = 0; i < animation_count && i < 4; ++i)
        use_state(scene, animated_state(scene, i, animation_end(*document, i, allowance) / 2, allowance), vertex_count);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    try {
        use_document(std::make_shared<GltfDocument>("fuzz.glb", std::string(data, data + size)));
    } catch (const Failure& failure) {
        require(!failure.diagnostics().empty());
    } catch (const std::bad_alloc&) { // the verbs have a message for it
    }
    return 0;
}
