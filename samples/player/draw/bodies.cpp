#include "draw/bodies.h"

#include <cstddef>

namespace pliant::player {

// The element buffer binding belongs to a vertex array, and none exists yet: upload through another binding.
Bodies::Bodies(const pliant_asset& asset)
    : index_count_(static_cast<GLsizei>(asset.triangle_count * 3))
    , indices_(make_buffer())
{
    glBindBuffer(GL_COPY_WRITE_BUFFER, indices_.get());
    glBufferData(GL_COPY_WRITE_BUFFER, static_cast<GLsizeiptr>(index_count_) * 4, asset.triangles, GL_STATIC_DRAW);
}

// The painting's indices follow the asset's own in the one index buffer that all vertex arrays use.
void Bodies::take_paint(const pliant_asset& asset, const Painting& painting, const Paint& paint)
{
    paint_ = &paint;
    const GLsizeiptr own = static_cast<GLsizeiptr>(index_count_) * 4,
                     more = static_cast<GLsizeiptr>(painting.indices.size()) * 4;
    glBindBuffer(GL_COPY_WRITE_BUFFER, indices_.get());
    glBufferData(GL_COPY_WRITE_BUFFER, own + more, nullptr, GL_STATIC_DRAW);
    glBufferSubData(GL_COPY_WRITE_BUFFER, 0, own, asset.triangles);
    glBufferSubData(GL_COPY_WRITE_BUFFER, own, more, painting.indices.data());
}

void Bodies::point_to_vertices(Mesh& mesh) const
{
    const auto at = [](std::size_t offset) { return reinterpret_cast<const void*>(offset); };
    glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.get());
    glEnableVertexAttribArray(0);
    glEnableVertexAttribArray(1);
    glEnableVertexAttribArray(2);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), at(offsetof(Vertex, position)));
    glVertexAttribPointer(1, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), at(offsetof(Vertex, normal)));
    glVertexAttribPointer(2, 1, GL_FLOAT, GL_FALSE, sizeof(Vertex), at(offsetof(Vertex, heat)));
    mesh.positions = mesh.vertices.get();
}

// Attribute 2, the heat, has the constant value that place() sets.
void Bodies::point_to_shape(Mesh& mesh, const BuiltShape& shape) const
{
    glDisableVertexAttribArray(2);
    pliant_gl_bind_attributes(&shape.instance, 0, 1);
    mesh.positions = shape.instance.position_buffer;
}

void Bodies::place(const std::vector<Actor>& actors)
{
    glVertexAttrib1f(2, Vertex {}.heat);
    while (meshes_.size() < actors.size()) {
        Mesh mesh { make_buffer(), make_vertex_array() };
        glBindVertexArray(mesh.array.get());
        if (paint_) paint_->attach();
        meshes_.push_back(std::move(mesh));
    }
    for (std::size_t i = 0; i < actors.size(); ++i) {
        Mesh& mesh = meshes_[i];
        const BuiltShape* built = actors[i].built;
        if (mesh.positions != (built ? built->instance.position_buffer : mesh.vertices.get())) {
            glBindVertexArray(mesh.array.get());
            if (built)
                point_to_shape(mesh, *built);
            else
                point_to_vertices(mesh);
            glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.get()); // replaces pliant::gl's index buffer, which has no parts
        }
        if (built) continue;
        const std::vector<Vertex>& vertices = *actors[i].vertices;
        glBindBuffer(GL_ARRAY_BUFFER, mesh.vertices.get());
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                     GL_STREAM_DRAW);
    }
}

void Bodies::draw(std::size_t actor) const
{
    glBindVertexArray(meshes_[actor].array.get());
    glDrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

void Bodies::draw(std::size_t actor, const PaintedPart& part) const
{
    const std::size_t first = static_cast<std::size_t>(index_count_) + part.first_index;
    glBindVertexArray(meshes_[actor].array.get());
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.index_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(first * 4));
}

} // namespace pliant::player
