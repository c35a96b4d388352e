// PNG and JPEG files in memory, decoded.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pliant::player {

// RGBA, sRGB, top row first. No pixels: the bytes were not a readable PNG or JPEG file.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;
};

// Bytes of pixels that decoding it goes over: those of the image, or more if it has far more scans than other images. 0 if
// it is not readable.
std::size_t decoded_size(const std::uint8_t* bytes, std::size_t size);

Image read_image(const std::uint8_t* bytes, std::size_t size);

} // namespace pliant::player
