// The shapes of a crowd, reconstructed by pliant::gl: one mesh on the graphics card, and two buffers for each character.
#pragma once

#include "blend/crowd.h"
#include "blend/landmarks.h"
#include "draw/actor.h"

#include <string>

namespace pliant::player {

class GpuCrowd {
public:
    // blended: the vertices of each blended part (paint.h). load: finds the functions of the current GL context, which
    // must stay current for the lifetime of the crowd. The file must outlive it. Throws Error if the driver cannot
    // reconstruct shapes.
    GpuCrowd(const AssetFile& file, const glm::mat3& to_world, std::uint32_t count,
             const std::vector<std::vector<std::uint32_t>>& blended, pliant_gl_loader load);

    // Reconstructs all shapes from the result of crowd.solve(), waits for completion, and sets the cost's placing_us and
    // update_us. A complete framebuffer must be bound: transform feedback requires one.
    void rebuild(const Crowd& crowd, CrowdCost& cost);

    const BuiltShape& shape(std::uint32_t character) const { return shapes_.list[character]; }
    const char* path_name() const; // "OpenGL, compute" or "OpenGL, feedback"

private:
    // Freed in the order that pliant_gl.h requires, also when the constructor throws before mesh and instances exist.
    struct Context {
        pliant_gl gl {};
        ~Context() { pliant_gl_free(&gl); }
    };
    struct Mesh {
        pliant_gl_mesh mesh {};
        ~Mesh() { pliant_gl_mesh_free(&mesh); }
    };
    struct Shapes {
        std::vector<BuiltShape> list;
        ~Shapes()
        {
            for (BuiltShape& shape : list) pliant_gl_instance_free(&shape.instance);
        }
    };

    void upload(const pliant_asset& asset, std::uint32_t count, pliant_gl_loader load);

    Context context_;
    Mesh mesh_;
    Shapes shapes_;
    Landmarks landmarks_;
    glm::mat4 to_world_;
};

} // namespace pliant::player
