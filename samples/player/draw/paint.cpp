#include "draw/paint.h"

#include "blend/error.h"

#include <algorithm>
#include <cstddef>

namespace pliant::player {
namespace {

GLint gl_wrap(Wrap wrap)
{
    return wrap == Wrap::repeat ? GL_REPEAT : wrap == Wrap::mirror ? GL_MIRRORED_REPEAT : GL_CLAMP_TO_EDGE;
}

GlName upload(const Image& image)
{
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (image.width > most || image.height > most)
        throw Error(ErrorNumber::gl_refused, ExitCode::failed,
                    "a texture of " + std::to_string(image.width) + " x " + std::to_string(image.height)
                        + " is above the driver's limit of " + std::to_string(most),
                    "show the asset with --plain");
    GlName name = make_texture();
    glBindTexture(GL_TEXTURE_2D, name.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8_ALPHA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image.pixels.data());
    glGenerateMipmap(GL_TEXTURE_2D);
    return name;
}

// Of the bound texture.
void set_parameters(const Texture& texture)
{
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, gl_wrap(texture.wrap_x));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, gl_wrap(texture.wrap_y));
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, texture.nearest ? GL_NEAREST : GL_LINEAR);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, texture.nearest ? GL_NEAREST : GL_LINEAR_MIPMAP_LINEAR);
}

std::vector<std::uint32_t> vertices_of(const PaintedPart& part, const std::vector<std::uint32_t>& indices)
{
    const auto first = indices.begin() + part.first_index;
    std::vector<std::uint32_t> vertices(first, first + part.index_count);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

} // namespace

GlName make_white_texture() { return upload({ 1, 1, { 255, 255, 255, 255 } }); }

Paint::Paint(const Painting& painting)
    : parts_(painting.parts)
    , vertices_(make_buffer())
    , white_(make_white_texture())
    , textures_(painting.textures)
    , images_(painting.images.size())
{
    const auto blended = std::stable_partition(parts_.begin(), parts_.end(),
                                               [](const PaintedPart& part) { return part.alpha != Alpha::blend; });
    for (auto part = blended; part != parts_.end(); ++part) blended_.push_back(vertices_of(*part, painting.indices));
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(painting.vertices.size() * sizeof(PaintedVertex)),
                 painting.vertices.data(), GL_STATIC_DRAW);
    for (const PaintedPart& part : parts_) {
        if (!part.texture) continue;
        const std::size_t image = textures_[*part.texture].image;
        if (images_[image].get() == 0) images_[image] = upload(painting.images[image]);
    }
}

void Paint::attach() const
{
    glBindBuffer(GL_ARRAY_BUFFER, vertices_.get());
    glEnableVertexAttribArray(3);
    glEnableVertexAttribArray(4);
    glVertexAttribPointer(3, 2, GL_FLOAT, GL_FALSE, sizeof(PaintedVertex), nullptr);
    glVertexAttribPointer(4, 4, GL_FLOAT, GL_FALSE, sizeof(PaintedVertex),
                          reinterpret_cast<const void*>(offsetof(PaintedVertex, colour)));
}

bool Paint::has(Alpha alpha) const
{
    return std::any_of(parts_.begin(), parts_.end(), [&](const PaintedPart& part) { return part.alpha == alpha; });
}

void Paint::bind(const PaintedPart& part) const
{
    if (!part.texture) {
        glBindTexture(GL_TEXTURE_2D, white_.get());
        return;
    }
    const Texture& texture = textures_[*part.texture];
    glBindTexture(GL_TEXTURE_2D, images_[texture.image].get());
    set_parameters(texture);
}

} // namespace pliant::player
