// Pictures as text that a page can hold.
#pragma once

#include "output/page/render.h"

#include <string>
#include <string_view>

namespace pliant {

// A PNG: grey with alpha where all pixels are grey, else RGBA. Throws std::bad_alloc.
std::string encode_png(const Image& image);

std::string encode_base64(std::string_view bytes);

// "data:image/png;base64,..."
std::string data_uri(const Image& image);

} // namespace pliant
