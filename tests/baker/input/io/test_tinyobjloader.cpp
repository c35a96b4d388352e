// Our OBJ reader against tinyobjloader, which shares no code with it. It does not round to nearest, so coordinates may
// differ by some units in the last place.
#include <doctest/doctest.h>

#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include "files.h"
#include "input/io/read_mesh.h"
#include "skip.h"

#include <cmath>
#include <random>

using namespace pliant;

namespace {

void compare(const std::string& path)
{
    CAPTURE(path);
    const MeshFile mesh = read_mesh(path);
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning, error;
    REQUIRE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, path.c_str(), nullptr, false));

    REQUIRE(attributes.vertices.size() == static_cast<std::size_t>(mesh.positions.size()));
    double worst = 0; // in units in the last place
    for (std::size_t i = 0; i < attributes.vertices.size(); ++i) {
        const double ours = mesh.positions.data()[i];
        const double ulp = std::nextafter(std::abs(ours), 1e300) - std::abs(ours);
        worst = std::max(worst, std::abs(attributes.vertices[i] - ours) / ulp);
    }
    CHECK(worst <= 8);

    std::vector<std::uint32_t> indices, sizes;
    for (const tinyobj::shape_t& shape : shapes) {
        for (const unsigned char size : shape.mesh.num_face_vertices) sizes.push_back(size);
        for (const tinyobj::index_t& index : shape.mesh.indices)
            indices.push_back(static_cast<std::uint32_t>(index.vertex_index));
    }
    CHECK(indices == mesh.faces.indices);
    REQUIRE(sizes.size() == mesh.faces.count());
    for (std::size_t face = 0; face < sizes.size(); ++face) REQUIRE(sizes[face] == mesh.faces.size(face));
}

} // namespace

TEST_CASE("random numbers and faces")
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> coordinate(-2000, 2000);
    std::string text = "mtllib none.mtl\n";
    constexpr int vertex_count = 3000;
    for (int i = 0; i < vertex_count; ++i) {
        char line[128];
        std::snprintf(line, sizeof line, "v %.*g %.6f %.9e\n", 17, coordinate(random), coordinate(random),
                      coordinate(random));
        text += line;
        if (i % 500 == 0) text += "vt 0.5 0.5\nvn 0 0 1\n";
    }
    for (int i = 0; i < 2000; ++i) {
        text += i % 100 == 0 ? "g part" + std::to_string(i) + "\nf" : "f";
        const int size = 3 + static_cast<int>(random() % 4);
        for (int corner = 0; corner < size; ++corner) {
            const int vertex = static_cast<int>(random() % vertex_count);
            text += i % 3 == 0 ? " " + std::to_string(vertex - vertex_count)
                               : " " + std::to_string(vertex + 1) + (i % 3 == 1 ? "/1/1" : "//2");
        }
        text += "\n";
    }
    const pliant_test::TemporaryFolder folder;
    pliant_test::write_bytes(folder / "random.obj", text);
    compare(folder / "random.obj");
}

TEST_CASE("real files")
{
    const std::string data = pliant_test::data_folder();
    if (data.empty()) PLIANT_SKIP("no data: set PLIANT_DATA");
    compare(data + "/ict_face/original_obj/generic_neutral_mesh.obj");
    compare(data + "/ict_face/original_obj/jawOpen.obj");
    compare(data + "/tet_small/beam3_tet_surface.obj");
}
