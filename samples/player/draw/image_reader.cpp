#include "draw/image_reader.h"

// The one file that compiles stb's image reader; its warnings are not ours.
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_MAX_DIMENSIONS 16384 // what graphics drivers take at most
#include <stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <climits>

namespace pliant::player {

Image read_image(const std::uint8_t* bytes, std::size_t size)
{
    Image image;
    if (size > INT_MAX) return image;
    int channels = 0;
    stbi_uc* pixels
        = stbi_load_from_memory(bytes, static_cast<int>(size), &image.width, &image.height, &channels, STBI_rgb_alpha);
    if (pixels)
        image.pixels.assign(pixels,
                            pixels + 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    stbi_image_free(pixels);
    return image;
}

} // namespace pliant::player
