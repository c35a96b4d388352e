#include "output/page/page_pictures.h"

#include "output/asset/asset_facts.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace pliant {

namespace {

constexpr std::size_t circle_limit = 24; // in a picture: more hide it
constexpr float crowded_distance = 6;    // pixels, half a circle's radius: two nearer than this show as one

double diagonal_of(const std::vector<float>& positions)
{
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
    for (std::size_t i = 0; i < positions.size(); i += 3) {
        const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(&positions[i]).cast<double>();
        if (!p.allFinite()) continue;
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (low.array() <= high.array()).all() ? (high - low).norm() : 0;
}

// Grey, amber, rust: as the scale of the style sheet, in linear light.
Colour heat(float part)
{
    const Colour colours[3] = { { 0.46f, 0.46f, 0.46f }, { 0.80f, 0.50f, 0.12f }, { 0.52f, 0.05f, 0.01f } };
    const float place = std::clamp(part, 0.0f, 1.0f) * 2;
    const std::size_t i = place < 1 ? 0 : 1;
    Colour out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = colours[i][c] + (place - float(i)) * (colours[i + 1][c] - colours[i][c]);
    return out;
}

float distance(const std::vector<float>& positions, const std::vector<float>& others, std::size_t vertex)
{
    return (Eigen::Map<const Eigen::Vector3f>(&positions[3 * vertex])
            - Eigen::Map<const Eigen::Vector3f>(&others[3 * vertex]))
        .norm();
}

} // namespace

PagePainter::PagePainter(const RuntimeBlender& blender, const std::vector<std::vector<float>>& shown,
                         const ViewOptions& view)
    : blender_(blender)
    , faces_(blender.faces())
    , view_size_(view.size)
    , has_file_numbers_(!has_render_mesh(blender.certificate()))
{
    const pliant_asset& asset = blender.asset();
    const std::size_t memory = pliant_normals_memory(&asset);
    adjacency_.resize(memory / 8 + 1);
    if (pliant_normals_init(&normals_, &asset, adjacency_.data(), memory) != PLIANT_OK) normals_ = {};
    std::vector<std::vector<float>> shapes;
    for (const std::vector<float>& q : shown) shapes.push_back(shape(q).positions);
    std::vector<ShapeView> views;
    for (const std::vector<float>& positions : shapes) views.push_back(&positions);
    camera_ = frame_shapes(views, asset.boundary_vertex_count, view);
    diagonal_ = diagonal_of(shapes[0]);
    for (std::size_t f = 0; f < faces_.count(); ++f)
        first_triangles_.push_back(
            first_triangles_.empty() ? 0 : first_triangles_.back() + faces_.offsets[f] - faces_.offsets[f - 1] - 2);
    if (!first_triangles_.empty())
        first_triangles_.push_back(first_triangles_.back() + faces_.offsets[faces_.count()]
                                   - faces_.offsets[faces_.count() - 1] - 2);
    if (first_triangles_.empty() || first_triangles_.back() != asset.triangle_count) first_triangles_.clear();
}

std::vector<float> PagePainter::normals(const std::vector<float>& positions) const
{
    if (normals_.vertex_count == 0) return {};
    std::vector<float> out(3 * std::size_t(normals_.vertex_count));
    pliant_normals_compute(&normals_, positions.data(), 3 * sizeof(float), 0, normals_.vertex_count, out.data(),
                           3 * sizeof(float));
    return out;
}

std::vector<float> PagePainter::positions(const std::vector<float>& q) const
{
    const std::uint32_t count = blender_.asset().boundary_vertex_count;
    std::vector<float> out(3 * std::size_t(count));
    pliant_reconstruct(&blender_.asset(), q.data(), 0, count, out.data(), 3 * sizeof(float));
    return out;
}

DrawnShape PagePainter::shape(const std::vector<float>& q) const
{
    DrawnShape out { positions(q), {} };
    out.normals = normals(out.positions);
    return out;
}

Camera PagePainter::camera(int size) const
{
    Camera camera = camera_;
    const float factor = float(size) / float(view_size_);
    camera.scale *= factor;
    camera.width = int(std::lround(float(camera_.width) * factor));
    camera.height = int(std::lround(float(camera_.height) * factor));
    return camera;
}

PictureMesh PagePainter::mesh(const DrawnShape& shape) const
{
    const pliant_asset& asset = blender_.asset();
    return { shape.positions, shape.normals, asset.triangles, asset.triangle_count };
}

Image PagePainter::draw(const DrawnShape& shape, int size) const { return render(mesh(shape), camera(size)); }

Image PagePainter::draw_difference(const DrawnShape& shape, const DrawnShape& other, int size) const
{
    const double largest = farthest(shape.positions, other.positions) * diagonal_;
    std::vector<Colour> colours;
    for (std::size_t v = 0; v < shape.positions.size() / 3; ++v)
        colours.push_back(heat(largest > 0 ? float(distance(shape.positions, other.positions, v) / largest) : 0));
    PictureMesh drawn = mesh(shape);
    drawn.colours = &colours;
    return render(drawn, camera(size));
}

bool PagePainter::find_vertex(std::uint32_t source, std::uint32_t& vertex) const
{
    const pliant_asset& asset = blender_.asset();
    vertex = source;
    if (asset.source_vertices) // of a solid; what is inside has no place in a picture
        vertex = std::uint32_t(std::find(asset.source_vertices, asset.source_vertices + asset.boundary_vertex_count, source)
                               - asset.source_vertices);
    return vertex < asset.boundary_vertex_count;
}

PagePicture PagePainter::draw_marked(const DrawnShape& shape, const std::vector<std::uint32_t>& vertices,
                                     const std::vector<std::uint32_t>& faces, int size) const
{
    std::vector<bool> is_marked(blender_.asset().triangle_count, false);
    PictureMesh drawn = mesh(shape);
    drawn.is_marked = &is_marked;
    struct Place {
        Eigen::Vector3f position;
        std::string label;
    };
    std::vector<Place> places;
    for (const std::uint32_t face : faces) {
        if (!has_file_numbers_ || face >= faces_.count()) continue;
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (std::uint32_t i = faces_.offsets[face]; i < faces_.offsets[face + 1]; ++i)
            sum += Eigen::Map<const Eigen::Vector3f>(&shape.positions[3 * std::size_t(faces_.indices[i])]);
        places.push_back(
            { sum / float(std::max(1u, faces_.offsets[face + 1] - faces_.offsets[face])), fmt::format("face {}", face) });
        if (!first_triangles_.empty())
            for (std::uint32_t t = first_triangles_[face]; t < first_triangles_[face + 1]; ++t) is_marked[t] = true;
    }
    for (const std::uint32_t source : vertices) {
        std::uint32_t vertex = 0;
        if (!has_file_numbers_ || !find_vertex(source, vertex)) continue;
        places.push_back({ Eigen::Map<const Eigen::Vector3f>(&shape.positions[3 * std::size_t(vertex)]),
                           fmt::format("vertex {}", source) });
    }
    const Camera at = camera(size);
    PagePicture picture;
    picture.image = render(drawn, at);
    const DepthMap depths = draw_depths(drawn, at);
    const float slack = 0.02f * float(size); // a vertex on a rim lies this much behind the pixel's middle
    for (const Place& place : places) {
        if (picture.marks.size() == circle_limit) break;
        const Eigen::Vector3f point = at.project(place.position.data());
        const bool is_crowded = std::any_of(picture.marks.begin(), picture.marks.end(), [&](const PageMark& mark) {
            return std::hypot(mark.x - point.x(), mark.y - point.y()) < crowded_distance;
        });
        if (!is_crowded) picture.marks.push_back({ point.x(), point.y(), depths.shows(point, slack), place.label });
    }
    return picture;
}

double PagePainter::farthest(const std::vector<float>& positions, const std::vector<float>& others) const
{
    double largest = 0;
    for (std::size_t v = 0; v < positions.size() / 3; ++v)
        largest = std::max(largest, double(distance(positions, others, v)));
    return diagonal_ > 0 && std::isfinite(largest) ? largest / diagonal_ : 0;
}

} // namespace pliant
