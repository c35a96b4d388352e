#include "output/page/png.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <zlib.h>

namespace {

// zlib packs a third smaller than the deflate of stb.
unsigned char* pack(unsigned char* data, int size, int* packed_size, int quality)
{
    uLongf length = compressBound(uLong(size));
    auto* out = static_cast<unsigned char*>(std::malloc(length));
    if (out && compress2(out, &length, data, uLong(size), quality) != Z_OK) {
        std::free(out);
        out = nullptr;
    }
    *packed_size = out ? int(length) : 0;
    return out;
}

} // namespace

// stb compiles its implementation into the one file that asks for it; its warnings are not ours.
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STBIW_ZLIB_COMPRESS pack
#include <stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace pliant {

namespace {

void append(void* context, void* data, int size)
{
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), std::size_t(size));
}

bool is_grey(const Image& image)
{
    for (std::size_t i = 0; i < image.pixels.size(); i += 4)
        if (image.pixels[i] != image.pixels[i + 1] || image.pixels[i] != image.pixels[i + 2]) return false;
    return true;
}

} // namespace

std::string encode_png(const Image& image)
{
    std::vector<std::uint8_t> grey;
    const bool is_small = is_grey(image);
    if (is_small)
        for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
            grey.push_back(image.pixels[i]);
            grey.push_back(image.pixels[i + 3]);
        }
    const int channels = is_small ? 2 : 4;
    std::string png;
    stbi_write_png_compression_level = 9;
    if (!stbi_write_png_to_func(append, &png, image.width, image.height, channels,
                                is_small ? grey.data() : image.pixels.data(), channels * image.width))
        throw std::bad_alloc(); // nothing else can go wrong
    return png;
}

std::string encode_base64(std::string_view bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? std::uint8_t(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += k <= count ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return text;
}

std::string data_uri(const Image& image) { return "data:image/png;base64," + encode_base64(encode_png(image)); }

} // namespace pliant
