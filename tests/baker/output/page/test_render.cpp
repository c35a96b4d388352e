// The rasteriser of reports: what a triangle covers, what hides what, how shapes are framed, PNG and base64.
#include "output/page/png.h"
#include "output/page/render.h"

#include <Eigen/LU>
#include <cmath>
#include <doctest/doctest.h>
#include <limits>

using namespace pliant;

namespace {

// One pixel a unit, the origin in the upper left corner, seen along -z.
Camera flat_camera(int width, int height)
{
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.centre = { 0.5f * float(width), -0.5f * float(height), 0 };
    return camera;
}

struct Scene {
    std::vector<float> positions, normals;
    std::vector<std::uint32_t> triangles;
    std::vector<Colour> colours;

    // Corners in pixels, y downwards; z towards the viewer.
    void add(std::array<std::array<float, 3>, 3> corners, Colour colour)
    {
        for (const auto& corner : corners) {
            triangles.push_back(std::uint32_t(positions.size() / 3));
            positions.insert(positions.end(), { corner[0], -corner[1], corner[2] });
            colours.push_back(colour);
        }
    }
    PictureMesh mesh() const { return { positions, normals, triangles.data(), triangles.size() / 3, &colours }; }
};

constexpr Colour red { 0.8f, 0, 0 }, blue { 0, 0, 0.8f };

bool is_red(const std::uint8_t* pixel) { return pixel[3] != 0 && pixel[0] > 0 && pixel[2] == 0; }
bool is_blue(const std::uint8_t* pixel) { return pixel[3] != 0 && pixel[2] > 0 && pixel[0] == 0; }

double covered(const Image& image)
{
    double sum = 0;
    for (std::size_t i = 3; i < image.pixels.size(); i += 4) sum += image.pixels[i] / 255.0;
    return sum;
}

} // namespace

TEST_CASE("a triangle covers its area and nothing else")
{
    Scene scene;
    scene.add({ { { 2, 2, 0 }, { 18, 2, 0 }, { 2, 14, 0 } } }, red);
    const Image image = render(scene.mesh(), flat_camera(24, 20));
    CHECK(image.width == 24);
    CHECK(image.height == 20);
    CHECK(image.pixels.size() == 4 * 24 * 20);
    // 16 x 12 / 2 = 96 pixels; a border sample more or less a row and column.
    CHECK(covered(image) == doctest::Approx(96).epsilon(0.06));
    CHECK(image.at(3, 3)[3] == 255);
    CHECK(image.at(2, 13)[3] > 0); // the lower corner
    CHECK(image.at(17, 13)[3] == 0);
    CHECK(image.at(1, 2)[3] == 0);
    CHECK(image.at(2, 1)[3] == 0);
    CHECK(image.at(20, 3)[3] == 0);
    // Half of a pixel on the slanted side is half covered or so.
    CHECK(image.at(10, 7)[3] > 0);
    CHECK(image.at(10, 7)[3] < 255);
    CHECK(image.at(10, 8)[3] == 0);
}

TEST_CASE("two triangles of a square leave no gap and the order of corners does not matter")
{
    Scene scene;
    scene.add({ { { 1, 1, 0 }, { 9, 1, 0 }, { 1, 9, 0 } } }, red);
    scene.add({ { { 9, 1, 0 }, { 1, 9, 0 }, { 9, 9, 0 } } }, red);
    const Image image = render(scene.mesh(), flat_camera(10, 10));
    for (int y = 1; y < 9; ++y)
        for (int x = 1; x < 9; ++x) CHECK(image.at(x, y)[3] == 255);
    CHECK(covered(image) == 64);
}

TEST_CASE("what is nearer hides what is behind, whichever is drawn first")
{
    for (const bool near_first : { true, false }) {
        Scene scene;
        const auto add = [&](bool near) {
            scene.add({ { { 0, 0, near ? 1.0f : 0.0f },
                          { 20, 0, near ? 1.0f : 0.0f },
                          { 0, near ? 20.0f : 40.0f, near ? 1.0f : 0.0f } } },
                      near ? red : blue);
        };
        add(near_first);
        add(!near_first);
        const Image image = render(scene.mesh(), flat_camera(20, 20));
        CHECK(is_red(image.at(3, 3)));
        CHECK(is_blue(image.at(2, 19)));
    }
}

TEST_CASE("surfaces that pass through each other are cut where they meet")
{
    Scene scene;
    scene.add({ { { 0, 0, 0 }, { 20, 0, 0 }, { 0, 40, 0 } } }, red);
    scene.add({ { { 0, 0, -1 }, { 20, 0, 1 }, { 0, 40, -1 } } }, blue); // nearer where x > 10
    const Image image = render(scene.mesh(), flat_camera(20, 20));
    CHECK(is_red(image.at(5, 2)));
    CHECK(is_blue(image.at(14, 2)));
}

TEST_CASE("smooth shading turns with the normals, flat shading with the face")
{
    Scene scene;
    scene.add({ { { 0, 0, 0 }, { 20, 0, 0 }, { 0, 20, 0 } } }, { 0.5f, 0.5f, 0.5f });
    const Image flat = render(scene.mesh(), flat_camera(20, 20));
    CHECK(flat.at(2, 2)[0] == flat.at(12, 2)[0]);
    const float tilted = std::sqrt(0.5f);
    scene.normals = { -tilted, 0, tilted, tilted, 0, tilted, -tilted, 0, tilted };
    const Image smooth = render(scene.mesh(), flat_camera(20, 20));
    CHECK(smooth.at(2, 2)[0] > smooth.at(15, 2)[0] + 10); // the light comes from the left
}

TEST_CASE("numbers that are none, and corners far away, do no harm")
{
    Scene scene;
    const float nan = std::numeric_limits<float>::quiet_NaN(), huge = 3e38f;
    scene.add({ { { nan, 0, 0 }, { 20, 0, 0 }, { 0, 20, 0 } } }, red);
    scene.add({ { { -huge, -huge, 0 }, { huge, 0, 0 }, { 0, huge, 0 } } }, red);
    scene.add({ { { 5, 5, 0 }, { 5, 5, 0 }, { 5, 5, 0 } } }, red);
    scene.add({ { { -1e6f, 4, 0 }, { 1e6f, 4, 0 }, { 0, 6, 0 } } }, blue);
    const Image image = render(scene.mesh(), flat_camera(20, 20));
    CHECK(is_blue(image.at(3, 4)));
    CHECK(image.at(3, 15)[3] == 0);
    const Camera camera = frame_shapes({ &scene.positions }, scene.positions.size() / 3, {});
    CHECK(camera.width > 0);
    CHECK(camera.height > 0);
    CHECK(std::isfinite(camera.scale));
}

TEST_CASE("a marked triangle shows in the signal colour")
{
    Scene scene;
    scene.add({ { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 10, 0 } } }, { 0.5f, 0.5f, 0.5f });
    scene.add({ { { 10, 10, 0 }, { 20, 10, 0 }, { 10, 20, 0 } } }, { 0.5f, 0.5f, 0.5f });
    const std::vector<bool> is_marked { false, true };
    PictureMesh mesh = scene.mesh();
    mesh.is_marked = &is_marked;
    const Image image = render(mesh, flat_camera(20, 20));
    CHECK(image.at(2, 2)[0] == image.at(2, 2)[2]);
    CHECK(image.at(12, 12)[0] > 2 * image.at(12, 12)[2]);
}

TEST_CASE("the depth map says what can be seen")
{
    Scene scene;
    scene.add({ { { 0, 0, 0 }, { 20, 0, 0 }, { 0, 20, 0 } } }, red);
    const DepthMap depths = draw_depths(scene.mesh(), flat_camera(20, 20));
    CHECK(depths.shows({ 4, 4, 0 }, 0.1f));
    CHECK_FALSE(depths.shows({ 4, 4, -5 }, 0.1f));
    CHECK(depths.shows({ 18, 18, -5 }, 0.1f)); // nothing is there
    CHECK_FALSE(depths.shows({ 25, 4, 0 }, 0.1f));
}

TEST_CASE("a shape is framed whole, its long horizontal axis across the picture")
{
    // A box 1 wide along x, 4 high along y, 2 deep along z.
    std::vector<float> box;
    for (const float x : { 0.0f, 1.0f })
        for (const float y : { 0.0f, 4.0f })
            for (const float z : { 10.0f, 12.0f }) box.insert(box.end(), { x, y, z });
    ViewOptions options;
    options.view = View::front;
    options.size = 200;
    const Camera front = frame_shapes({ &box }, 8, options);
    CHECK((front.axes * front.axes.transpose()).isIdentity(1e-5f));
    CHECK(front.axes.row(1).isApprox(Eigen::RowVector3f(0, 1, 0)));
    CHECK(std::abs(front.axes(0, 2)) == doctest::Approx(1)); // z is longer than x
    CHECK(front.axes.determinant() == doctest::Approx(1));
    CHECK(front.height == 200);
    CHECK(front.width == 100);
    for (std::size_t v = 0; v < 8; ++v) {
        const Eigen::Vector3f p = front.project(&box[3 * v]);
        CHECK(p.x() > 0);
        CHECK(p.x() < float(front.width));
        CHECK(p.y() > 0);
        CHECK(p.y() < float(front.height));
    }
    const float top[3] = { 0, 4, 10 }, foot[3] = { 0, 0, 10 };
    CHECK(front.project(top).y() < front.project(foot).y());

    options.up = UpAxis::x;
    const Camera lying = frame_shapes({ &box }, 8, options);
    CHECK(std::abs(lying.axes(0, 1)) == doctest::Approx(1));
    CHECK(lying.width == 200);
    options.view = View::side;
    CHECK(std::abs(frame_shapes({ &box }, 8, options).axes(0, 2)) == doctest::Approx(1));
    options.view = View::three_quarter;
    const Camera turned = frame_shapes({ &box }, 8, options);
    CHECK((turned.axes * turned.axes.transpose()).isIdentity(1e-5f));
    CHECK(turned.axes.row(2).dot(Eigen::RowVector3f(1, 0, 0)) > 0.1f); // from above
}

TEST_CASE("with y upwards a wide character is seen from +z, with z upwards from -y")
{
    const std::vector<float> wide { -3, 0, -1, 3, 0, -1, -3, 2, 1, 3, 2, 1 };
    ViewOptions options;
    options.view = View::front;
    CHECK(frame_shapes({ &wide }, 4, options).axes.row(2).isApprox(Eigen::RowVector3f(0, 0, 1)));
    options.up = UpAxis::z;
    CHECK(frame_shapes({ &wide }, 4, options).axes.row(2).isApprox(Eigen::RowVector3f(0, -1, 0)));
}

TEST_CASE("pictures as PNG: grey ones take two channels, coloured ones four")
{
    Scene scene;
    scene.add({ { { 0, 0, 0 }, { 10, 0, 0 }, { 0, 10, 0 } } }, { 0.5f, 0.5f, 0.5f });
    const std::string grey = encode_png(render(scene.mesh(), flat_camera(12, 10)));
    CHECK(grey.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    CHECK(grey.substr(16, 8) == std::string("\0\0\0\x0c\0\0\0\x0a", 8));
    CHECK(int(grey[25]) == 4); // colour type: grey with alpha
    scene.colours.assign(3, red);
    CHECK(int(encode_png(render(scene.mesh(), flat_camera(12, 10)))[25]) == 6);
}

TEST_CASE("base64 as RFC 4648 has it")
{
    CHECK(encode_base64("").empty());
    CHECK(encode_base64("f") == "Zg==");
    CHECK(encode_base64("fo") == "Zm8=");
    CHECK(encode_base64("foo") == "Zm9v");
    CHECK(encode_base64("foobar") == "Zm9vYmFy");
    CHECK(encode_base64(std::string("\0\xff\x80", 3)) == "AP+A");
}

TEST_CASE("thousands of triangles over the whole picture take no more time than some dozens")
{
    Scene scene;
    for (int i = 0; i < 200; ++i) scene.add({ { { -40, -40, 0 }, { 80, -40, 0 }, { -40, 80, 0 } } }, red);
    scene.add({ { { -40, -40, 1 }, { 80, -40, 1 }, { -40, 80, 1 } } }, blue);
    scene.add({ { { 2, 2, 1 }, { 4, 2, 1 }, { 2, 4, 1 } } }, blue);
    const Image image = render(scene.mesh(), flat_camera(20, 20));
    CHECK(is_red(image.at(10, 10)));
    CHECK(is_blue(image.at(2, 2))); // small enough for what is left
    scene.triangles.erase(scene.triangles.begin(), scene.triangles.begin() + 3 * 150);
    CHECK(is_blue(render(scene.mesh(), flat_camera(20, 20)).at(10, 10)));
}
