// Pictures of shapes for reports: a small software rasteriser, so that they can be drawn where there is neither a display
// nor a graphics driver. Parallel projection, depth buffer, smooth or flat shading, four samples a pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace pliant {

// Rows from the top; four bytes a pixel: red, green, blue (not multiplied by alpha), alpha. Where nothing is drawn alpha is
// 0.
struct Image {
    int width = 0, height = 0;
    std::vector<std::uint8_t> pixels;

    const std::uint8_t* at(int x, int y) const
    {
        return &pixels[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
    }
};

// How a shape is looked at.
struct Camera {
    Eigen::Matrix3f axes = Eigen::Matrix3f::Identity(); // rows: to the right, upwards, towards the viewer; orthonormal
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();   // of the picture
    float scale = 1;                                    // pixels a unit of length
    int width = 0, height = 0;                          // pixels

    // x to the right and y downwards in pixels from the upper left corner; z is larger the nearer.
    Eigen::Vector3f project(const float* position) const;
};

enum class UpAxis { x, y, z };
enum class View { front, side, three_quarter };

struct ViewOptions {
    UpAxis up = UpAxis::y;
    View view = View::three_quarter;
    int size = 360; // of the longer side of a picture, pixels
};

// One shape: 3 floats a vertex. Not owned.
using ShapeView = const std::vector<float>*;

// The camera that shows all `shapes` whole, at one scale. Which way a character looks is not known: `front` looks along the
// shorter of the two principal axes that the first shape has across `up`, at the side that the third coordinate points to in
// a right-handed frame (with up = y and a character that is widest along x: from +z, as glTF has it; with up = z: from -y).
// An axis within 15 degrees of a coordinate axis is taken to be that one. `side` turns by 90 degrees, three_quarter by 30
// and looks down by 12. Numbers that are not finite are passed over. `vertex_count`: how many of the vertices count.
Camera frame_shapes(const std::vector<ShapeView>& shapes, std::size_t vertex_count, const ViewOptions& options);

using Colour = std::array<float, 3>; // linear red, green, blue, 0 .. 1

// What is drawn. Nothing is owned.
struct PictureMesh {
    const std::vector<float>& positions;      // 3 a vertex
    const std::vector<float>& normals;        // 3 a vertex, unit; empty: flat shading
    const std::uint32_t* triangles = nullptr; // 3 vertices each, all below the number of positions
    std::size_t triangle_count = 0;
    const std::vector<Colour>* colours = nullptr; // a vertex; null: grey
    const std::vector<bool>* is_marked = nullptr; // a triangle; those that are show in a signal colour. Null: none
};

// Triangles are seen from both sides; those with a corner that is not finite are left out, and of a mesh that lies over
// itself more than some dozens of times the last ones. Cost: linear in triangles and samples.
Image render(const PictureMesh& mesh, const Camera& camera);

// How near the drawn mesh is, a pixel. shows(): whether the point (as Camera::project gives it) is not behind it, to `slack`
// pixels.
struct DepthMap {
    int width = 0, height = 0;
    std::vector<float> depths; // -infinity where there is nothing

    bool shows(const Eigen::Vector3f& point, float slack) const;
};
DepthMap draw_depths(const PictureMesh& mesh, const Camera& camera);

} // namespace pliant
