// The actors of a scene on the graphics card: one index buffer, and one vertex array for each actor.
#pragma once

#include "draw/actor.h"
#include "draw/gl_objects.h"
#include "draw/paint.h"

namespace pliant::player {

class Bodies {
public:
    explicit Bodies(const pliant_asset& asset);

    // Adds texture coordinates and colours to the vertex arrays, and lets parts be drawn. Call it before the first
    // place(). The paint must outlive the bodies.
    void take_paint(const pliant_asset& asset, const Painting& painting, const Paint& paint);

    // Uploads the actors' vertices; built shapes are in buffers already.
    void place(const std::vector<Actor>& actors);
    // Draws all triangles of an actor, or those of one part.
    void draw(std::size_t actor) const;
    void draw(std::size_t actor, const PaintedPart& part) const;

private:
    struct Mesh {
        GlName vertices, array;
        GLuint positions = 0; // the buffer that the array's attributes read
    };

    void point_to_vertices(Mesh& mesh) const;
    void point_to_shape(Mesh& mesh, const BuiltShape& shape) const;

    GLsizei index_count_;
    GlName indices_;
    const Paint* paint_ = nullptr;
    std::vector<Mesh> meshes_;
};

} // namespace pliant::player
