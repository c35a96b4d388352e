// A painting on the graphics card: its textures and vertex attributes.
#pragma once

#include "draw/gl_objects.h"
#include "draw/painting.h"

#include <vector>

namespace pliant::player {

class Paint {
public:
    // Throws Error if the driver refuses the size of a texture.
    explicit Paint(const Painting& painting);

    // Adds texture coordinates and colours to the bound vertex array, as attributes 3 and 4.
    void attach() const;

    // The blended parts are last.
    const std::vector<PaintedPart>& parts() const { return parts_; }
    // For each blended part its vertices, each once.
    const std::vector<std::vector<std::uint32_t>>& blended() const { return blended_; }
    bool has(Alpha alpha) const;
    // Binds the texture of a part, or a white one, to the active unit.
    void bind(const PaintedPart& part) const;

private:
    std::vector<PaintedPart> parts_;
    std::vector<std::vector<std::uint32_t>> blended_;
    GlName vertices_, white_;
    std::vector<Texture> textures_;
    std::vector<GlName> images_; // those that a part shows: once, however many textures show them
};

// One white pixel, for parts without a texture.
GlName make_white_texture();

} // namespace pliant::player
