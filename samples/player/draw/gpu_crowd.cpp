#include "draw/gpu_crowd.h"

#include "blend/error.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstddef>

namespace pliant::player {
namespace {

void check(pliant_gl_result result, const pliant_gl& gl)
{
    if (result == PLIANT_GL_OK) return;
    std::string words = gl.message; // from the driver, possibly many lines
    std::replace(words.begin(), words.end(), '\n', ' ');
    words.erase(words.find_last_not_of(' ') + 1);
    std::string what = std::string("the graphics driver cannot compute the shapes: ") + pliant_gl_result_text(result);
    if (!words.empty()) what += " (" + words + ")";
    throw Error(ErrorNumber::rebuild_refused, ExitCode::failed, what, "use --rebuild cpu to compute them on the CPU");
}

} // namespace

GpuCrowd::GpuCrowd(const AssetFile& file, const glm::mat3& to_world, std::uint32_t count,
                   const std::vector<std::vector<std::uint32_t>>& blended, pliant_gl_loader load)
    : landmarks_(file.view(), to_world, blended)
    , to_world_(to_world)
{
    upload(file.view(), count, load);
}

void GpuCrowd::upload(const pliant_asset& asset, std::uint32_t count, pliant_gl_loader load)
{
    check(pliant_gl_init(&context_.gl, load, nullptr), context_.gl);
    std::vector<std::byte> memory(pliant_normals_memory(&asset));
    pliant_normals adjacency {};
    if (pliant_normals_init(&adjacency, &asset, memory.data(), memory.size()) != PLIANT_OK)
        throw Error(ErrorNumber::asset_refused, ExitCode::bad_input, "the asset has no triangles, which normals need",
                    "bake the asset again");
    check(pliant_gl_mesh_init(&mesh_.mesh, &context_.gl, &asset, &adjacency), context_.gl);
    shapes_.list.resize(count);
    for (BuiltShape& shape : shapes_.list) check(pliant_gl_instance_init(&shape.instance, &mesh_.mesh), context_.gl);
}

void GpuCrowd::rebuild(const Crowd& crowd, CrowdCost& cost)
{
    const Stopwatch placing;
    for (std::uint32_t i = 0; i < crowd.count(); ++i) {
        BuiltShape& shape = shapes_.list[i];
        const float* q = crowd.coordinates(i).data();
        const float floor = landmarks_.lowest(q);
        shape.placing = glm::translate(glm::mat4(1.0f), glm::vec3(0.0f, -floor, 0.0f)) * to_world_;
        landmarks_.means(q, shape.blended_centres);
    }
    cost.placing_us = placing.microseconds();
    const Stopwatch update;
    for (std::uint32_t i = 0; i < crowd.count(); ++i)
        check(pliant_gl_update(&shapes_.list[i].instance, crowd.coordinates(i).data()), context_.gl);
    glFinish();
    cost.update_us = update.microseconds();
}

const char* GpuCrowd::path_name() const
{
    return context_.gl.path == PLIANT_GL_PATH_COMPUTE ? "OpenGL, compute" : "OpenGL, feedback";
}

} // namespace pliant::player
