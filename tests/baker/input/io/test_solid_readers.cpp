// The readers of solids: every layout of every format arrives bit for bit, everything else is refused by number and line.
#include <doctest/doctest.h>

#include "files.h"
#include "input/io/encode_msh.h"
#include "input/io/read_mesh.h"
#include "solid_samples.h"

#include <cstring>

using namespace pliant;
using pliant_test::number_of;
using pliant_test::Sample;
using pliant_test::SolidWriter;
using pliant_test::TemporaryFolder;

namespace {

// The one folder of this program: each file replaces the one before.
const TemporaryFolder& folder()
{
    static const TemporaryFolder result;
    return result;
}

MeshFile read(const std::string& file, const std::string& bytes)
{
    pliant_test::write_bytes(folder() / file, bytes);
    return read_mesh(folder() / file);
}

int error_of(const std::string& file, const std::string& bytes)
{
    return number_of([&] { read(file, bytes); });
}

std::string replaced(std::string text, const std::string& old, const std::string& by)
{
    const std::size_t at = text.find(old);
    REQUIRE_MESSAGE(at != std::string::npos, old);
    return text.replace(at, old.size(), by);
}

bool same_bits(const Positions& a, const Positions& b)
{
    return a.rows() == b.rows() && std::memcmp(a.data(), b.data(), sizeof(double) * std::size_t(a.size())) == 0;
}

const Sample& sample(const std::string& name)
{
    static const std::vector<Sample> samples = pliant_test::solid_samples();
    return *std::find_if(samples.begin(), samples.end(), [&](const Sample& s) { return s.name == name; });
}

std::string text_of(const std::string& name) { return sample(name).bytes; }

} // namespace

TEST_CASE("every layout arrives bit for bit, what is no tetrahedron is left out with a warning")
{
    const pliant_test::SampleSolid solid = pliant_test::sample_solid();
    for (const Sample& s : pliant_test::solid_samples()) {
        CAPTURE(s.name);
        DiagnosticList diagnostics;
        pliant_test::write_bytes(folder() / s.file, s.bytes);
        const std::optional<MeshFile> mesh = read_mesh(folder() / s.file, diagnostics);
        REQUIRE_MESSAGE(mesh, (diagnostics.diagnostics().empty() ? "" : to_text(diagnostics.diagnostics()[0])));
        CHECK(same_bits(mesh->positions, solid.positions));
        CHECK(mesh->tets == solid.tets);
        CHECK(mesh->faces.count() == 0);
        const bool is_text = s.name.find("endian") == std::string::npos;
        CHECK(mesh->tet_lines.size() == (is_text ? 3 : 0));
        if (s.file == "a.veg") {
            CHECK(diagnostics.diagnostics().empty());
            REQUIRE(mesh->regions.materials.size() == 2);
            CHECK(mesh->regions.materials[0].name == "A");
            CHECK(mesh->regions.materials[1].young == 2.5e7);
            CHECK(mesh->regions.materials[1].poisson == 0.3);
            CHECK(mesh->regions.of_tet == std::vector<std::uint32_t> { 1, 0, 1 });
        } else {
            REQUIRE(diagnostics.diagnostics().size() == 1);
            CHECK(diagnostics.diagnostics()[0].number == 2115);
            CHECK(diagnostics.diagnostics()[0].what == "2 triangles ignored: only tetrahedra are used");
            CHECK(mesh->regions.of_tet.empty());
        }
    }
}

TEST_CASE("line ends, a byte order mark, no end of the last line")
{
    for (const char* name :
         { "Gmsh 2.2, text", "Gmsh 4.1, text", "VTK 3.0, text", "VTK 5.1, text", "MEDIT", "Vega from 1" }) {
        CAPTURE(name);
        const Sample& s = sample(name);
        const MeshFile plain = read(s.file, s.bytes);
        for (const std::string& end : { std::string("\r\n"), std::string("\r") }) {
            std::string changed;
            for (const char c : s.bytes) changed += c == '\n' ? end : std::string(1, c);
            const MeshFile mesh = read(s.file, changed);
            CHECK(same_bits(mesh.positions, plain.positions));
            CHECK(mesh.tets == plain.tets);
            CHECK(mesh.tet_lines == plain.tet_lines);
        }
        CHECK(read(s.file, "\xef\xbb\xbf" + s.bytes).tets == plain.tets);
        CHECK(read(s.file, s.bytes.substr(0, s.bytes.size() - 1)).tets == plain.tets);
    }
}

TEST_CASE("a file cut off anywhere ends in an error, or has lost nothing of its tetrahedra")
{
    const pliant_test::SampleSolid solid = pliant_test::sample_solid();
    for (const Sample& s : pliant_test::solid_samples()) {
        CAPTURE(s.name);
        for (std::size_t size = 0; size < s.bytes.size(); ++size) {
            CAPTURE(size);
            DiagnosticList diagnostics;
            pliant_test::write_bytes(folder() / s.file, s.bytes.substr(0, size));
            const std::optional<MeshFile> mesh = read_mesh(folder() / s.file, diagnostics);
            REQUIRE(mesh.has_value() != diagnostics.has_errors());
            if (!mesh) continue;
            REQUIRE(same_bits(mesh->positions, solid.positions));
            REQUIRE(mesh->tets == solid.tets);
        }
    }
}

TEST_CASE("a byte that is another one never crashes a reader")
{
    for (const Sample& s : pliant_test::solid_samples()) {
        CAPTURE(s.name);
        for (std::size_t i = 0; i < s.bytes.size(); ++i) {
            for (const char c : { '\0', '-', '9', '\xff', '\n' }) {
                std::string changed = s.bytes;
                changed[i] = c;
                DiagnosticList diagnostics;
                pliant_test::write_bytes(folder() / s.file, changed);
                const std::optional<MeshFile> mesh = read_mesh(folder() / s.file, diagnostics);
                REQUIRE(mesh.has_value() != diagnostics.has_errors());
                if (!mesh) continue;
                REQUIRE(mesh->positions.allFinite());
                for (const Tetrahedron& tet : mesh->tets) {
                    for (const std::uint32_t v : tet) REQUIRE(v < std::uint64_t(mesh->positions.rows()));
                }
            }
        }
    }
}

TEST_CASE("what we write we read, every bit")
{
    const pliant_test::SampleSolid solid = pliant_test::sample_solid();
    const std::string bytes = encode_msh(solid.positions, solid.tets);
    const MeshFile mesh = read("a.msh", bytes);
    CHECK(same_bits(mesh.positions, solid.positions));
    CHECK(mesh.tets == solid.tets);
    CHECK(encode_msh(mesh.positions, mesh.tets) == bytes);
}

TEST_CASE("Gmsh: what is wrong")
{
    const std::string two = text_of("Gmsh 2.2, text"), four = text_of("Gmsh 4.1, text");
    CHECK(error_of("a.msh", replaced(two, "2.2 0", "4.0 0")) == 2111);
    CHECK(error_of("a.msh", replaced(two, "2.2 0 8", "2.2 0 4")) == 2111);
    CHECK(error_of("a.msh", replaced(two, "$Elements", "$Comments\nno end")) == 2101);
    CHECK(error_of("a.msh", replaced(two, "$Nodes\n6", "$Nodes\n-6")) == 2102);
    CHECK(error_of("a.msh", replaced(two, "$Nodes\n6", "$Nodes\n7")) == 2106);
    CHECK(error_of("a.msh", replaced(two, "$Nodes\n6", "$Nodes\n5")) == 2110);
    CHECK(error_of("a.msh", replaced(two, "$Nodes\n6", "$Nodes\n4000000000")) == 2007);
    CHECK(error_of("a.msh", replaced(two, "$Nodes\n6", "$Nodes\n60000000")) == 2104);
    CHECK(error_of("a.msh", replaced(two, "\n13 ", "\n10 ")) == 2118);
    CHECK(error_of("a.msh", replaced(two, " 2 7 8 ", " 2000000000 7 8 ")) == 2109);
    CHECK(error_of("a.msh", replaced(two, " 2 7 8 ", " -1 7 8 ")) == 2102);
    CHECK(error_of("a.msh", replaced(two, "\n3 4 2", "\n3 5 2")) == 2114);
    CHECK(error_of("a.msh", replaced(two, "\n3 4 2", "\n3 999 2")) == 2114);
    CHECK(error_of("a.msh", two + two.substr(two.find("$Elements"))) == 2117);
    CHECK(error_of("a.msh", two.substr(0, two.find("$Nodes")) + two.substr(two.find("$Elements"))) == 2117);
    CHECK(error_of("a.msh", two + "rest") == 2112);
    CHECK(error_of("a.msh", replaced(four, "2 6 1 6", "2 7 1 6")) == 2102);
    CHECK(error_of("a.msh", replaced(four, "2 6 1 6", "3 6 1 6")) == 2106);
    CHECK(error_of("a.msh", replaced(four, "3 1 0 4", "3 1 0 5")) == 2102);
    CHECK(error_of("a.msh", replaced(four, "3 1 0 4", "4 1 0 4")) == 2102);
    CHECK(error_of("a.msh", replaced(four, "3 1 4 3", "3 1 11 3")) == 2114);
    CHECK(error_of("a.msh", replaced(four, "2 1 2 2", "2 1 2 18446744073709551615")) == 2106);
    CHECK(error_of("a.msh", replaced(four, "77 6 5 4 3", "77 6 5 4 9223372036854775807")) == 2103);
    CHECK(error_of("a.msh", replaced(four, "77 6 5 4 3", "77 6 5 4 -9223372036854775808")) == 2103);
    CHECK(error_of("a.msh", replaced(four, "77 6 5 4 3", "77 6 5 4 3 2")) == 2109);
    // Tags at the ends of their range.
    const std::string far
        = replaced(replaced(four, "\n6 \n", "\n9223372036854775807 \n"), "\n5 \n", "\n-9223372036854775808 \n");
    CHECK(error_of("a.msh", far) == 2103);
}

TEST_CASE("MEDIT: what is wrong")
{
    const std::string good = text_of("MEDIT");
    CHECK(error_of("a.mesh", replaced(good, "Dimension\n3", "Dimension\n2")) == 2111);
    CHECK(error_of("a.mesh", replaced(good, "Vertices\n6", "Vertices\n7")) == 2106);
    CHECK(error_of("a.mesh", replaced(good, "Vertices\n6", "Vertices\n5")) == 2112);
    CHECK(error_of("a.mesh", replaced(good, "Vertices\n6", "Vertices\n-5")) == 2102);
    CHECK(error_of("a.mesh", replaced(good, "Vertices\n6", "Vertices\n99999999")) == 2007);
    CHECK(error_of("a.mesh", replaced(good, "Tetrahedra\n3", "Tetrahedra\n9999999")) == 2104);
    CHECK(error_of("a.mesh", replaced(good, "1 2 3 4 0", "0 2 3 4 0")) == 2103);
    CHECK(error_of("a.mesh", replaced(good, "1 2 3 4 0", "7 2 3 4 0")) == 2103);
    CHECK(error_of("a.mesh", replaced(good, "Triangles 2 ", "Hexahedra 1 1 2 3 4 5 6 7 8 0\nTriangles 2 ")) == 2114);
    CHECK(error_of("a.mesh", replaced(good, "Triangles 2 ", "Hexahedra 0\nTriangles 2 ")) == 0);
    CHECK(error_of("a.mesh", replaced(good, "Tetrahedra\n3", "Tetrahydra\n3")) == 2112);
    CHECK(error_of("a.mesh", replaced(good, "End\n", "End\n5")) == 2110);
    CHECK(error_of("a.mesh", replaced(good, "End\n", "Tetrahedra 0\nEnd\n")) == 2117);
    CHECK(error_of("a.mesh", good.substr(0, good.find("Tetrahedra")) + "End\n") == 2116);
    CHECK(error_of("a.mesh", "MeshVersionFormatted 1\nEnd\n") == 2101);
    CHECK(error_of("a.mesh", "MeshVersionFormatted 1\nVertices 0\nTetrahedra 0\nEnd\n") == 2005);
}

TEST_CASE("Vega: what is wrong")
{
    const std::string good = text_of("Vega from 1");
    CHECK(error_of("a.veg", replaced(good, "*VERTICES\n6 3", "*VERTICES\n6 2")) == 2111);
    CHECK(error_of("a.veg", replaced(good, "*VERTICES\n6", "*VERTICES\n5")) == 2112);
    CHECK(error_of("a.veg", replaced(good, "*VERTICES\n6", "*VERTICES\nx")) == 2102);
    CHECK(error_of("a.veg", replaced(good, "*VERTICES\n6", "*VERTICES\n7")) == 2101);
    CHECK(error_of("a.veg", replaced(good, "*VERTICES\n6", "*VERTICES\n70000000")) == 2007);
    CHECK(error_of("a.veg", replaced(good, "\n1 ", "\n2 ")) == 2118);
    CHECK(error_of("a.veg", replaced(good, "0.10000000000000001", "0,1")) == 2106);
    CHECK(error_of("a.veg", replaced(good, "0.10000000000000001", "")) == 2109);
    CHECK(error_of("a.veg", replaced(good, "0.10000000000000001", "0 0")) == 2109);
    CHECK(error_of("a.veg", replaced(good, "TET\n", "CUBIC\n")) == 2114);
    CHECK(error_of("a.veg", replaced(good, "TET\n3 4", "TET\n3 10")) == 2108);
    CHECK(error_of("a.veg", replaced(good, "1 1 2 3 4", "1 1 2 3")) == 2109);
    CHECK(error_of("a.veg", replaced(good, "1 1 2 3 4", "1 0 2 3 4")) == 2103);
    CHECK(error_of("a.veg", replaced(good, "1 1 2 3 4", "1 1 2 3 x")) == 2106);
    CHECK(error_of("a.veg", replaced(good, "*SET s", "*INCLUDE s")) == 2111);
    CHECK(error_of("a.veg", replaced(good, "*SET s", "*SAT s")) == 2112);
    CHECK(error_of("a.veg", replaced(good, "*SET s", "*SET allElements")) == 2119);
    CHECK(error_of("a.veg", replaced(good, ",3 ", ",4 ")) == 2103);
    CHECK(error_of("a.veg", replaced(good, ",3 ", ",x ")) == 2106);
    CHECK(error_of("a.veg", replaced(good, "ENU, 1000, 1e6", "ENU, 1000, -1e6")) == 2119);
    CHECK(error_of("a.veg", replaced(good, "ENU, 1000, 1e6", "ENU, 1000, nan")) == 2119);
    CHECK(error_of("a.veg", replaced(good, "ENU, 1000, 1e6, 0.45", "ENU, 1000, 1e6, 0,45")) == 2119);
    CHECK(error_of("a.veg", replaced(good, "*MATERIAL B", "*MATERIAL A")) == 2119);
    CHECK(error_of("a.veg", replaced(good, "s, B", "s B extra")) == 2119);
    CHECK(error_of("a.veg", good.substr(0, good.find("*ELEMENTS"))) == 2117);
    // Materials are optional; a single one needs no region.
    const std::string bare = good.substr(0, good.find("*MATERIAL"));
    CHECK(read("a.veg", bare).regions.of_tet.empty());
    const MeshFile uniform = read("a.veg", bare + "*MATERIAL m\nENU, 1, 2, 0\n");
    CHECK(uniform.regions.of_tet == std::vector<std::uint32_t> { 0, 0, 0 });
    // The last region counts.
    const MeshFile over = read("a.veg", good + "*REGION\nallElements, A\n");
    CHECK(over.regions.of_tet == std::vector<std::uint32_t> { 0, 0, 0 });
}

TEST_CASE("VTK: what is wrong")
{
    const std::string good = text_of("VTK 3.0, text"), offsets = text_of("VTK 5.1, text");
    CHECK(error_of("a.vtk", replaced(good, "ASCII", "XML")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "UNSTRUCTURED_GRID", "POLYDATA")) == 2111);
    CHECK(error_of("a.vtk", replaced(good, "6 double", "6 int")) == 2111);
    CHECK(error_of("a.vtk", replaced(good, "6 double", "7 double")) == 2106);
    CHECK(error_of("a.vtk", replaced(good, "6 double", "5 double")) == 2112);
    CHECK(error_of("a.vtk", replaced(good, "6 double", "70000000 double")) == 2007);
    CHECK(error_of("a.vtk", replaced(good, "CELLS 5 23", "CELLS 5 22")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "CELLS 5 23", "CELLS 5 24")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "CELLS 5 23", "CELLS 4 23")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "\n3 0 1 2", "\n-3 0 1 2")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "\n3 0 1 2", "\n4000000000 0 1 2")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "\n4 0 1 2 3", "\n4 0 1 2 6")) == 2103);
    CHECK(error_of("a.vtk", replaced(good, "\n4 0 1 2 3", "\n4 0 1 2 -1")) == 2103);
    CHECK(error_of("a.vtk", replaced(good, "CELL_TYPES 5", "CELL_TYPES 4")) == 2102);
    CHECK(error_of("a.vtk", replaced(good, "\n5 \n", "\n10 \n")) == 2108);
    CHECK(error_of("a.vtk", replaced(good, "\n10 \n", "\n12 \n")) == 2114);
    CHECK(error_of("a.vtk", replaced(good, "CELL_TYPES", "CELLS")) == 2117);
    CHECK(error_of("a.vtk", good.substr(0, good.find("CELL_TYPES"))) == 2117);
    CHECK(error_of("a.vtk", replaced(offsets, "int64\n0 3 ", "int64\n1 3 ")) == 2102);
    CHECK(error_of("a.vtk", replaced(offsets, "int64\n0 3 ", "int64\n0 -3 ")) == 2102);
    CHECK(error_of("a.vtk", replaced(offsets, "CONNECTIVITY vtktypeint64", "CONNECTIVITY float")) == 2102);
    CHECK(error_of("a.vtk", replaced(offsets, "1 1 double", "1 1 string")) == 2111);
    CHECK(error_of("a.vtk", replaced(offsets, "1 1 double", "99999999 99999999 double")) == 2104);
}

TEST_CASE("a solid is what its name says")
{
    CHECK(error_of("a.msh", text_of("MEDIT")) == 2004);
    CHECK(error_of("a.mesh", text_of("Vega from 1")) == 2004);
    CHECK(error_of("a.veg", text_of("VTK 3.0, text")) == 2004);
    CHECK(error_of("a.vtk", text_of("Gmsh 2.2, text")) == 2004);
    CHECK(error_of("a.obj", text_of("MEDIT")) == 2004);
    CHECK(read("A.MSH", text_of("Gmsh 2.2, text")).tets.size() == 3);
}
