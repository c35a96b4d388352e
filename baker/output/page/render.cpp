#include "output/page/render.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

namespace {

constexpr int samples = 2; // across and down a pixel

// How many samples of their boxes triangles may visit: a mesh that lies over itself some dozens of times, small triangles.
constexpr std::size_t layers = 64, samples_of_triangle = 16;

constexpr Colour grey { 0.46f, 0.46f, 0.46f };
constexpr Colour signal { 0.80f, 0.16f, 0.03f };

// One sample of the picture before it is filtered.
struct Samples {
    int width, height;
    std::vector<float> depth;
    std::vector<std::array<float, 3>> colour; // linear; empty: only depths are wanted

    Samples(int w, int h, bool has_colour)
        : width(w)
        , height(h)
        , depth(std::size_t(w) * std::size_t(h), -std::numeric_limits<float>::infinity())
        , colour(has_colour ? depth.size() : 0)
    {
    }
};

Eigen::Vector3f row(const std::vector<float>& values, std::uint32_t vertex)
{
    return Eigen::Map<const Eigen::Vector3f>(&values[3 * std::size_t(vertex)]);
}

// A key light from the upper left, a fill light from the right and the sky; n in the camera's axes, towards the viewer.
float brightness(const Eigen::Vector3f& n)
{
    static const Eigen::Vector3f key = Eigen::Vector3f(-0.45f, 0.65f, 0.62f).normalized();
    static const Eigen::Vector3f fill = Eigen::Vector3f(0.85f, 0.05f, 0.45f).normalized();
    const float rim = 0.72f + 0.28f * n.z(); // edges turn away a little darker: shapes read better
    return rim
        * (0.16f + 0.80f * std::max(0.0f, n.dot(key)) + 0.16f * std::max(0.0f, n.dot(fill)) + 0.10f * (0.5f + 0.5f * n.y()));
}

std::uint8_t encode_srgb(float linear)
{
    const float c = std::clamp(linear, 0.0f, 1.0f);
    const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
    return std::uint8_t(std::lround(255 * s));
}

struct Corner {
    Eigen::Vector3f place, normal; // in samples, in the camera's axes
    Colour colour;
};

// Twice the signed area of p, q and the point (x, y).
float edge(const Eigen::Vector3f& p, const Eigen::Vector3f& q, float x, float y)
{
    return (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x());
}

std::array<float, 3> shade(const std::array<Corner, 3>& corners, const std::array<float, 3>& share)
{
    Eigen::Vector3f n = Eigen::Vector3f::Zero();
    Colour colour {};
    for (std::size_t i = 0; i < 3; ++i) {
        n += share[i] * corners[i].normal;
        for (std::size_t c = 0; c < 3; ++c) colour[c] += share[i] * corners[i].colour[c];
    }
    const float length = n.norm();
    n = length > 0 ? Eigen::Vector3f(n / length) : Eigen::Vector3f::UnitZ();
    if (n.z() < 0) n = -n; // the back of a face is lit as its front
    const float light = brightness(n);
    return { light * colour[0], light * colour[1], light * colour[2] };
}

// A sample belongs to a triangle if its middle lies inside or on the border: neighbours leave no gap. Nothing is drawn if
// the box of the triangle has more samples than are `left`.
void fill(const std::array<Corner, 3>& corners, Samples& out, std::size_t& left)
{
    const auto &a = corners[0].place, &b = corners[1].place, &c = corners[2].place;
    const float area = edge(a, b, c.x(), c.y());
    if (!(std::abs(area) > 0) || !std::isfinite(area)) return;
    // Clamped before they become integers: corners may lie anywhere.
    const auto first = [](float low, int size) { return int(std::clamp(std::floor(low), 0.0f, float(size))); };
    const auto last = [](float high, int size) { return int(std::clamp(std::ceil(high), 0.0f, float(size))); };
    const int x0 = first(std::min({ a.x(), b.x(), c.x() }), out.width),
              x1 = last(std::max({ a.x(), b.x(), c.x() }), out.width);
    const int y0 = first(std::min({ a.y(), b.y(), c.y() }), out.height),
              y1 = last(std::max({ a.y(), b.y(), c.y() }), out.height);
    const std::size_t visited = std::size_t(std::max(x1 - x0, 0)) * std::size_t(std::max(y1 - y0, 0));
    if (visited > left) return;
    left -= visited;
    for (int y = y0; y < y1; ++y) {
        for (int x = x0; x < x1; ++x) {
            const float px = float(x) + 0.5f, py = float(y) + 0.5f;
            const std::array<float, 3> share { edge(b, c, px, py) / area, edge(c, a, px, py) / area,
                                               edge(a, b, px, py) / area };
            if (!(share[0] >= 0 && share[1] >= 0 && share[2] >= 0)) continue;
            const float depth = share[0] * a.z() + share[1] * b.z() + share[2] * c.z();
            const std::size_t i = std::size_t(y) * std::size_t(out.width) + std::size_t(x);
            if (!(depth > out.depth[i])) continue;
            out.depth[i] = depth;
            if (!out.colour.empty()) out.colour[i] = shade(corners, share);
        }
    }
}

void draw(const PictureMesh& mesh, const Camera& camera, Samples& out)
{
    const float factor = float(out.width) / float(camera.width);
    std::size_t left = layers * out.depth.size() + samples_of_triangle * mesh.triangle_count;
    for (std::size_t t = 0; t < mesh.triangle_count; ++t) {
        std::array<Corner, 3> corners;
        const bool is_marked = mesh.is_marked && (*mesh.is_marked)[t];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t v = mesh.triangles[3 * t + i];
            corners[i].place = factor * camera.project(&mesh.positions[3 * std::size_t(v)]);
            if (!mesh.normals.empty()) corners[i].normal = camera.axes * row(mesh.normals, v);
            corners[i].colour = is_marked ? signal : mesh.colours ? (*mesh.colours)[v] : grey;
        }
        if (mesh.normals.empty()) {
            const auto &a = corners[0].place, &b = corners[1].place, &c = corners[2].place;
            Eigen::Vector3f n = (b - a).cross(c - a);
            n.y() = -n.y(); // places count downwards
            for (Corner& corner : corners) corner.normal = n;
        }
        if (corners[0].place.allFinite() && corners[1].place.allFinite() && corners[2].place.allFinite())
            fill(corners, out, left);
    }
}

Image filter(const Samples& in, int width, int height)
{
    Image image { width, height, std::vector<std::uint8_t>(4 * std::size_t(width) * std::size_t(height)) };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Colour sum {};
            int count = 0;
            for (int s = 0; s < samples * samples; ++s) {
                const std::size_t i = std::size_t(samples * y + s / samples) * std::size_t(in.width)
                    + std::size_t(samples * x + s % samples);
                if (std::isinf(in.depth[i])) continue;
                ++count;
                for (std::size_t c = 0; c < 3; ++c) sum[c] += in.colour[i][c];
            }
            if (count == 0) continue;
            std::uint8_t* pixel = &image.pixels[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))];
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = encode_srgb(sum[c] / float(count));
            pixel[3] = std::uint8_t(255 * count / (samples * samples));
        }
    }
    return image;
}

} // namespace

Eigen::Vector3f Camera::project(const float* position) const
{
    const Eigen::Vector3f p = axes * (Eigen::Map<const Eigen::Vector3f>(position) - centre) * scale;
    return { 0.5f * float(width) + p.x(), 0.5f * float(height) - p.y(), p.z() };
}

Image render(const PictureMesh& mesh, const Camera& camera)
{
    Samples out(samples * camera.width, samples * camera.height, true);
    draw(mesh, camera, out);
    return filter(out, camera.width, camera.height);
}

DepthMap draw_depths(const PictureMesh& mesh, const Camera& camera)
{
    Samples out(camera.width, camera.height, false);
    draw(mesh, camera, out);
    return { out.width, out.height, std::move(out.depth) };
}

bool DepthMap::shows(const Eigen::Vector3f& point, float slack) const
{
    if (!point.allFinite() || point.x() < 0 || point.y() < 0 || point.x() >= float(width) || point.y() >= float(height))
        return false;
    return point.z() + slack >= depths[std::size_t(point.y()) * std::size_t(width) + std::size_t(point.x())];
}

} // namespace pliant
