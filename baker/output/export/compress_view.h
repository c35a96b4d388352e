// Views of a GLB as EXT_meshopt_compression stores them, by meshoptimizer. What comes out of a decoder is the same to the
// bit, except that a triangle may start at another of its corners.
#pragma once

#include <string>
#include <string_view>

namespace pliant {

// Rows of `stride` bytes (a multiple of 4, at most 256), mode ATTRIBUTES.
std::string compress_rows(std::string_view bytes, std::size_t stride);

// Corners of triangles, in 2 or 4 bytes each (`stride`), mode TRIANGLES. Triangles keep their order and their side.
std::string compress_triangles(std::string_view bytes, std::size_t stride);

} // namespace pliant
