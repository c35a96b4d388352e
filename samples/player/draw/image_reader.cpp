#include "draw/image_reader.h"

#include <algorithm>
#include <climits>
#include <cstdlib>

namespace {

// Of the image that this thread reads.
thread_local std::size_t allocation_limit = 0;

void* limited_allocation(void* pointer, std::size_t size)
{
    return size > allocation_limit ? nullptr : std::realloc(pointer, size);
}

} // namespace

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
// A file of a few kilobytes can say that it has few pixels and unpack to gigabytes.
#define STBI_MALLOC(size) limited_allocation(nullptr, size)
#define STBI_REALLOC(pointer, size) limited_allocation(pointer, size)
#define STBI_FREE(pointer) std::free(pointer)
#include <stb_image.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace pliant::player {
namespace {

// Of one allocation. The reader copies the file, unpacks up to 8 bytes a pixel into room that it doubles, and makes images
// of whole blocks, up to 32 pixels wide.
std::size_t most_memory(std::size_t file_size, std::size_t pixels_size)
{
    constexpr std::size_t most_of_all = std::size_t(1) << 30; // the pixels of the largest image
    return std::min(most_of_all, 2 * file_size + 16 * pixels_size + (std::size_t(1) << 16));
}

// Bytes of its pixels, from its first bytes; 0 if it is not readable.
std::size_t pixel_size(const std::uint8_t* bytes, std::size_t size)
{
    int width = 0, height = 0, channels = 0;
    allocation_limit = most_memory(size, 0);
    if (size > INT_MAX || !stbi_info_from_memory(bytes, static_cast<int>(size), &width, &height, &channels)) return 0;
    return 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

// Of a JPEG file: each scan of a progressive one goes over all pixels, and can have a dozen bytes.
std::size_t scan_count(const std::uint8_t* bytes, std::size_t size)
{
    constexpr std::uint8_t start_of_scan[] = { 0xFF, 0xDA };
    std::size_t count = 0;
    if (size == 0 || bytes[0] != start_of_scan[0]) return 0; // PNG
    for (const std::uint8_t* at = bytes; at != bytes + size; ++count, ++at) {
        at = std::search(at, bytes + size, start_of_scan, start_of_scan + 2);
        if (at == bytes + size) break;
    }
    return count;
}

} // namespace

std::size_t decoded_size(const std::uint8_t* bytes, std::size_t size)
{
    constexpr std::size_t honest_scans = 16; // encoders make about ten
    return pixel_size(bytes, size) * (1 + scan_count(bytes, size) / honest_scans);
}

Image read_image(const std::uint8_t* bytes, std::size_t size)
{
    Image image;
    if (size > INT_MAX) return image;
    int channels = 0;
    allocation_limit = most_memory(size, pixel_size(bytes, size));
    stbi_uc* pixels
        = stbi_load_from_memory(bytes, static_cast<int>(size), &image.width, &image.height, &channels, STBI_rgb_alpha);
    if (pixels)
        image.pixels.assign(pixels,
                            pixels + 4 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    stbi_image_free(pixels);
    return image;
}

} // namespace pliant::player
