// Pictures of blends for a page, all by one camera.
#pragma once

#include "output/asset/runtime_blender.h"
#include "output/page/page_data.h"

#include <string>
#include <vector>

namespace pliant {

// A shape as it is drawn: 3 floats a vertex, of a solid its boundary alone.
struct DrawnShape {
    std::vector<float> positions, normals;
};

// Draws shapes of one asset. Keeps a reference to it.
class PagePainter {
public:
    // `shown`: coordinates of shapes that all pictures must have room for.
    PagePainter(const RuntimeBlender& blender, const std::vector<std::vector<float>>& shown, const ViewOptions& view);

    std::vector<float> positions(const std::vector<float>& q) const;
    DrawnShape shape(const std::vector<float>& q) const;
    // `size`: of the longer side, pixels.
    Image draw(const DrawnShape& shape, int size) const;
    // `shape` coloured by how far its vertices lie from those of `other`.
    Image draw_difference(const DrawnShape& shape, const DrawnShape& other, int size) const;
    // Faces in colour, and circles round faces and vertices (numbers of the pose files); what the asset does not have is
    // left out.
    PagePicture draw_marked(const DrawnShape& shape, const std::vector<std::uint32_t>& vertices,
                            const std::vector<std::uint32_t>& faces, int size) const;

    // Largest distance of two vertices over the diagonal of pose 0.
    double farthest(const std::vector<float>& positions, const std::vector<float>& others) const;
    double diagonal() const { return diagonal_; }

private:
    Camera camera(int size) const;
    std::vector<float> normals(const std::vector<float>& positions) const;
    PictureMesh mesh(const DrawnShape& shape) const;
    // The number that a vertex of the files has in the asset, or none.
    bool find_vertex(std::uint32_t source, std::uint32_t& vertex) const;

    const RuntimeBlender& blender_;
    Polygons faces_;
    // Of each face, and one past the last; empty if triangles and faces do not match
    std::vector<std::uint32_t> first_triangles_;
    std::vector<std::uint64_t> adjacency_;
    pliant_normals normals_ {};
    Camera camera_; // for pictures of view_size_
    int view_size_;
    double diagonal_ = 0;
    bool has_file_numbers_; // vertices and faces are those of the pose files
};

} // namespace pliant
