// The actors of a scene on the graphics card: one index buffer, and for each actor a vertex array.
#pragma once

#include "draw/actor.h"
#include "draw/gl_objects.h"
#include "draw/paint.h"

namespace pliant::player {

class Bodies {
public:
    explicit Bodies(const pliant_asset& asset);

    // From now on vertex arrays have places and colours, and parts can be drawn. Before the first place(); the paint must outlive this.
    void take_paint(const pliant_asset& asset, const Painting& painting, const Paint& paint);

    // Uploads the actors' vertices; those of built shapes are there already.
    void place(const std::vector<Actor>& actors);
    // Of the actor's triangles all, or those of a part.
    void draw(std::size_t actor) const;
    void draw(std::size_t actor, const PaintedPart& part) const;

private:
    struct Mesh {
        GlName vertices, array;
        GLuint positions = 0; // the buffer that the array's attributes point to
    };

    void point_to_vertices(Mesh& mesh) const;
    void point_to_shape(Mesh& mesh, const BuiltShape& shape) const;

    GLsizei index_count_;
    GlName indices_;
    const Paint* paint_ = nullptr;
    std::vector<Mesh> meshes_;
};

} // namespace pliant::player
