// A painting on the graphics card: its textures, and the numbers of its vertices.
#pragma once

#include "draw/gl_objects.h"
#include "draw/painting.h"

#include <vector>

namespace pliant::player {

class Paint {
public:
    // Throws Error if the driver refuses a picture of that size.
    explicit Paint(const Painting& painting);

    // Adds places and colours to the vertex array that is bound, as attributes 3 and 4.
    void attach() const;

    // The blended ones last.
    const std::vector<PaintedPart>& parts() const { return parts_; }
    // For each of these the vertices it draws, each of them once.
    const std::vector<std::vector<std::uint32_t>>& blended() const { return blended_; }
    bool has(Alpha alpha) const;
    // Binds the texture of a part, or white, to the unit that is active.
    void bind(const PaintedPart& part) const;

private:
    std::vector<PaintedPart> parts_;
    std::vector<std::vector<std::uint32_t>> blended_;
    GlName vertices_, white_;
    std::vector<GlName> textures_;
};

// One white pixel, for what has no texture.
GlName make_white_texture();

} // namespace pliant::player
