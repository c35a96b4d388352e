#include "base/mesh/triangulate.h"

namespace pliant {

Triangulation triangulate(const Polygons& polygons)
{
    Triangulation result;
    for (std::size_t face = 0; face < polygons.count(); ++face) {
        const std::uint32_t* corners = &polygons.indices[polygons.offsets[face]];
        for (std::size_t i = 2; i < polygons.size(face); ++i) {
            result.triangles.push_back({ corners[0], corners[i - 1], corners[i] });
            result.faces.push_back(static_cast<std::uint32_t>(face));
        }
    }
    return result;
}

} // namespace pliant
