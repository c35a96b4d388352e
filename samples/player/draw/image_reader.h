// PNG and JPEG files in memory, decoded by libpng and libjpeg.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace pliant::player {

// RGBA, sRGB, top row first. No pixels: the bytes were not a readable PNG or JPEG file.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
};

// Calls take() with the size of the pixels, in bytes, before it decodes them; take() may throw.
Image read_image(const std::uint8_t* bytes, std::size_t size, const std::function<void(std::size_t)>& take);

} // namespace pliant::player
