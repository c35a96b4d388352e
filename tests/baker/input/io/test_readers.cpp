// The readers: every number arrives bit for bit, every variant of a format is understood, everything else is refused.
#include <doctest/doctest.h>

#include "files.h"
#include "input/io/encode_ply.h"
#include "input/io/read_mesh.h"

#include <cmath>
#include <cstring>
#include <limits>

using namespace pliant;
using pliant_test::number_of;
using pliant_test::TemporaryFolder;

namespace {

MeshFile read(const std::string& name, const std::string& content)
{
    const TemporaryFolder folder;
    pliant_test::write_bytes(folder / name, content);
    return read_mesh(folder / name);
}

int error_of(const std::string& name, const std::string& content)
{
    return number_of([&] { read(name, content); });
}

std::vector<std::uint32_t> face(const MeshFile& mesh, std::size_t index)
{
    return { mesh.faces.indices.begin() + mesh.faces.offsets[index],
             mesh.faces.indices.begin() + mesh.faces.offsets[index + 1] };
}

using Face = std::vector<std::uint32_t>;

// ------------------------------------------------------------------------------------------------------- PLY, all variants

enum class Encoding { ascii, little_endian, big_endian };
const char* const encoding_names[] = { "ascii", "binary_little_endian", "binary_big_endian" };
const char* const integer_types[]
    = { "char", "uchar", "short", "ushort", "int", "uint", "int8", "uint8", "int16", "uint16", "int32", "uint32" };

// Writes values of a PLY body one after the other; independent of the code under test.
class BodyWriter {
public:
    explicit BodyWriter(Encoding encoding)
        : encoding_(encoding)
    {
    }

    void integer(const std::string& type, std::int64_t value)
    {
        const bool is_wide = type.find("32") != std::string::npos || type == "int" || type == "uint";
        const bool is_narrow = type.find("char") != std::string::npos || type == "int8" || type == "uint8";
        if (encoding_ == Encoding::ascii)
            text(std::to_string(value));
        else
            raw(&value, is_wide ? 4 : is_narrow ? 1 : 2);
    }
    void real(const std::string& type, double value)
    {
        char buffer[64];
        std::snprintf(buffer, sizeof buffer, "%.17g", value);
        const float narrow = static_cast<float>(value);
        if (encoding_ == Encoding::ascii)
            text(buffer);
        else if (type[0] == 'f' && type != "float64")
            raw(&narrow, 4);
        else
            raw(&value, 8);
    }
    void end_element()
    {
        if (encoding_ == Encoding::ascii) bytes_ += '\n';
    }
    const std::string& bytes() const { return bytes_; }

private:
    void text(const std::string& word) { bytes_ += (bytes_.empty() || bytes_.back() == '\n' ? "" : " ") + word; }
    void raw(const void* value, std::size_t size) // the tests run on little-endian machines
    {
        std::string bytes(static_cast<const char*>(value), size);
        if (encoding_ == Encoding::big_endian) bytes.assign(bytes.rbegin(), bytes.rend());
        bytes_ += bytes;
    }
    Encoding encoding_;
    std::string bytes_;
};

const double coordinates[4][3]
    = { { 0.1, -123456.789012, 1e-300 }, { 1.0 / 3.0, 5e17, -0.0 }, { 1, 2, 3 }, { -1e-7, 0.7, 9.25 } };
const std::vector<Face> faces = { { 0, 1, 2 }, { 0, 2, 3, 1 } };

std::string make_ply(Encoding encoding, const std::string& real, const std::string& count, const std::string& index)
{
    std::string header
        = std::string("ply\nformat ") + encoding_names[int(encoding)] + " 1.0\ncomment a comment\nobj_info x\n";
    header += "element camera 2\nproperty list uchar double a\nproperty " + index + " b\n";
    header += "element vertex 4\nproperty uchar red\nproperty " + real + " z\nproperty " + real
        + " x\nproperty list int short w\n";
    header += "property " + real + " y\nelement face 2\nproperty float quality\nproperty list " + count + " " + index;
    header += " vertex_index\nproperty list ushort float texcoord\nelement edge 1\nproperty int v1\nend_header\n";
    BodyWriter body(encoding);
    for (int camera = 0; camera < 2; ++camera) {
        body.integer("uchar", camera);
        for (int i = 0; i < camera; ++i) body.real("double", 0.5);
        body.integer(index, 7);
        body.end_element();
    }
    for (const auto& x : coordinates) {
        body.integer("uchar", 200);
        body.real(real, x[2]);
        body.real(real, x[0]);
        body.integer("int", 2);
        body.integer("short", -5);
        body.integer("short", 5);
        body.real(real, x[1]);
        body.end_element();
    }
    for (const Face& corners : faces) {
        body.real("float", 0.25);
        body.integer(count, std::int64_t(corners.size()));
        for (const std::uint32_t corner : corners) body.integer(index, corner);
        body.integer("ushort", 1);
        body.real("float", 1.5);
        body.end_element();
    }
    body.integer("int", 3);
    body.end_element();
    return header + body.bytes();
}

} // namespace

TEST_CASE("PLY: every encoding and type arrives bit for bit")
{
    for (const Encoding encoding : { Encoding::ascii, Encoding::little_endian, Encoding::big_endian }) {
        for (const char* real : { "float", "double", "float32", "float64" }) {
            for (const char* count : integer_types) {
                for (const char* index : integer_types) {
                    CAPTURE(encoding_names[int(encoding)]);
                    CAPTURE(real);
                    CAPTURE(count);
                    CAPTURE(index);
                    const MeshFile mesh = read("a.ply", make_ply(encoding, real, count, index));
                    REQUIRE(mesh.positions.rows() == 4);
                    const bool is_single = std::string(real) == "float" || std::string(real) == "float32";
                    for (int v = 0; v < 4; ++v) {
                        for (int c = 0; c < 3; ++c) {
                            // Text keeps what it says, whatever type the header names.
                            const double x = coordinates[v][c];
                            const double expected = is_single && encoding != Encoding::ascii ? double(float(x)) : x;
                            const double got = mesh.positions(v, c);
                            REQUIRE(std::memcmp(&got, &expected, sizeof got) == 0);
                        }
                    }
                    REQUIRE(mesh.faces.count() == 2);
                    REQUIRE(face(mesh, 0) == faces[0]);
                    REQUIRE(face(mesh, 1) == faces[1]);
                    REQUIRE(mesh.face_lines.size() == (encoding == Encoding::ascii ? 2 : 0));
                }
            }
        }
    }
}

TEST_CASE("PLY: a binary file cut off anywhere is refused")
{
    const std::string whole = make_ply(Encoding::little_endian, "double", "uchar", "int");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        CAPTURE(size);
        REQUIRE(error_of("a.ply", whole.substr(0, size)) != 0);
    }
    CHECK(error_of("a.ply", whole + '\0') == 2110);
}

TEST_CASE("PLY: what we write we read")
{
    Positions positions(3, 3);
    positions << 0.1, 0.2, 0.3, 1e-30, -2.5, 1e17, 4, 5, 6;
    Polygons polygons;
    polygons.indices = { 0, 1, 2 };
    polygons.offsets = { 0, 3 };
    SUBCASE("triangle") {}
    SUBCASE("a face with 300 corners")
    {
        for (int i = 0; i < 300; ++i) polygons.indices.push_back(std::uint32_t(i % 3));
        polygons.offsets.push_back(303);
    }
    const std::string bytes = encode_ply(positions, polygons);
    const MeshFile mesh = read("a.ply", bytes);
    CHECK(mesh.positions == positions.cast<float>().cast<double>());
    CHECK(mesh.faces.indices == polygons.indices);
    CHECK(mesh.faces.offsets == polygons.offsets);
    const bool is_wide = polygons.count() == 2;
    CHECK((bytes.find("property list uchar int vertex_indices") != std::string::npos) == !is_wide);
}

TEST_CASE("PLY: headers that are wrong")
{
    const std::string body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    const std::string vertex = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
    const std::string face_element = "element face 1\nproperty list uchar int vertex_indices\n";
    const std::string ascii = "ply\nformat ascii 1.0\n";
    CHECK(error_of("a.ply", ascii + vertex + face_element + "end_header\n" + body) == 0);
    CHECK(error_of("a.ply", "ply\n" + vertex + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", "ply\nformat ascii 2.0\n" + vertex + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", "ply\nformat ebcdic 1.0\n" + vertex + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", ascii + "property float x\n" + vertex + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", ascii + vertex + vertex + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", ascii + vertex + "property float x\n" + face_element + "end_header\n" + body) == 2102);
    CHECK(error_of("a.ply", ascii + "element vertex 3\nproperty float x\nproperty float y\n" + face_element + "end_header\n")
          == 2102);
    CHECK(error_of("a.ply", ascii + vertex + "element face 1\nproperty list float int vertex_indices\nend_header\n" + body)
          == 2102);
    CHECK(error_of("a.ply", ascii + vertex + "element face 1\nproperty list uchar float vertex_indices\nend_header\n" + body)
          == 2111);
    CHECK(error_of("a.ply", ascii + vertex + "element face 1\nproperty int vertex_indices\nend_header\n" + body) == 2102);
    CHECK(
        error_of("a.ply", ascii + vertex + "element tristrips 1\nproperty list int int vertex_indices\nend_header\n" + body)
        == 2111);
    CHECK(error_of("a.ply", ascii + vertex + "end_header\n0 0 0\n1 0 0\n0 1 0\n") == 2006);
    CHECK(error_of("a.ply", ascii + vertex + face_element + body) == 2102); // no end_header
    CHECK(error_of("a.ply", ascii + vertex + face_element) == 2101);
    CHECK(error_of("a.ply", ascii + "element vertex -3\nproperty float x\nend_header\n") == 2102);
    CHECK(error_of("a.ply", ascii + "element vertex 99999999999999999999\nproperty float x\nend_header\n") == 2102);
}

TEST_CASE("PLY: line ends of the header, data that looks like one")
{
    for (const std::string& end : { std::string("\n"), std::string("\r\n"), std::string("\r") }) {
        std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
                             "property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
        for (std::size_t at = header.find('\n'); at != std::string::npos; at = header.find('\n', at + end.size()))
            header.replace(at, 1, end);
        const MeshFile mesh = read("a.ply", header + std::string("\n\r\n\1\2\3\4\5\6\3\0\1\2", 13));
        CAPTURE(end.size());
        CHECK(mesh.positions(0, 0) == 10);
        CHECK(mesh.positions(0, 1) == 13);
        CHECK(mesh.positions(2, 2) == 6);
        CHECK(face(mesh, 0) == Face { 0, 1, 2 });
    }
}

// ------------------------------------------------------------------------------------------------------------------ numbers

TEST_CASE("numbers: nearest double, no locale, nothing but numbers")
{
    const auto x_of = [](const std::string& word) {
        return read("a.obj", "v " + word + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").positions(0, 0);
    };
    CHECK(x_of("123456.789012") == 123456.789012);
    CHECK(x_of("0.1") == 0.1);
    CHECK(x_of("+1.5") == 1.5);
    CHECK(x_of("-.5") == -0.5);
    CHECK(x_of("5.") == 5.0);
    CHECK(x_of("1E2") == 100.0);
    CHECK(x_of("2.2250738585072011e-308") == 2.2250738585072011e-308); // denormal
    CHECK(x_of("9007199254740993") == 9007199254740992.0);
    CHECK(x_of("1e-400") == 0.0);
    CHECK(x_of("-1e-400") == 0.0);
    CHECK(x_of("0.00000001e-320") == 0.0);
    CHECK(x_of("1e-99999999999999999999") == 0.0);
    CHECK(x_of("0e999999") == 0.0);
    CHECK(x_of("0.001e-9223372036854775808") == 0.0);
    CHECK(x_of("1e18") == 1e18);
    const auto error_in
        = [](const std::string& word) { return error_of("a.obj", "v " + word + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"); };
    for (const char* word : { "nan", "NaN", "-nan", "inf", "-Infinity", "1e400", "-1e400", "1e99999999999999999999",
                              "123e307", "100e9223372036854775807" })
        CHECK_MESSAGE(error_in(word) == 2105, word);
    for (const char* word :
         { "0,5", "abc", "1.5f", "0x10", "1e", "--1", "+-1", "+", "-", ".", "1.2.3", "1_000", "\xd9\xa1" })
        CHECK_MESSAGE(error_in(word) == 2106, word);
    CHECK(error_in("1.0001e18") == 2113);
    CHECK(error_in("1e300") == 2113);
}

TEST_CASE("numbers: double precision in all text formats")
{
    const std::string x = "123456.789012";
    CHECK(read("a.obj", "v " + x + " 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").positions(0, 0) == 123456.789012);
    CHECK(read("a.off", "OFF\n3 1 0\n" + x + " 0 0\n1 0 0\n0 1 0\n3 0 1 2").positions(0, 0) == 123456.789012);
    CHECK(read("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
               "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                   + x + " 0 0\n1 0 0\n0 1 0\n3 0 1 2")
              .positions(0, 0)
          == 123456.789012);
}

// ---------------------------------------------------------------------------------------------------------------------- OBJ

TEST_CASE("OBJ: everything that is usual")
{
    const std::string text = "# comment\nmtllib a.mtl\no head/left\ng a/b c#d\nusemtl skin\ns 1\n"
                             "v 0 0 0 # here\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0 1 0.5 0.5 0.5\nvt 0 nan\nvn 0 0 1\n"
                             "f 1/1/1 2/1/1 3//1 4/7\nf -1 -2 \\\n -3\n# C:\\models\\\nf\t1 2 +3\n";
    const MeshFile plain = read("a.obj", text);
    CHECK(plain.positions.rows() == 4);
    CHECK(plain.positions.row(2) == Eigen::RowVector3d(1, 1, 0));
    REQUIRE(plain.faces.count() == 3);
    CHECK(face(plain, 0) == Face { 0, 1, 2, 3 });
    CHECK(face(plain, 1) == Face { 3, 2, 1 });
    CHECK(face(plain, 2) == Face { 0, 1, 2 });
    CHECK(plain.face_lines == std::vector<std::uint32_t> { 13, 14, 17 });

    const auto with_ends = [&](const std::string& end) {
        std::string changed;
        for (const char c : text) changed += c == '\n' ? end : std::string(1, c);
        return changed;
    };
    for (const std::string& changed :
         { with_ends("\r\n"), with_ends("\r"), "\xef\xbb\xbf" + text, text.substr(0, text.size() - 1) }) {
        const MeshFile mesh = read("a.obj", changed);
        CHECK(mesh.positions == plain.positions);
        CHECK(mesh.faces.indices == plain.faces.indices);
        CHECK(mesh.face_lines == plain.face_lines);
    }
    CHECK(face(read("b.OBJ", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"), 0) == Face { 0, 1, 2 }); // vertices after their face
}

TEST_CASE("OBJ: what is wrong is named with its line")
{
    const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    CHECK(error_of("a.obj", good + "f 1 2 0\n") == 2107);
    CHECK(error_of("a.obj", good + "f 1 2 4\n") == 2103);
    CHECK(error_of("a.obj", good + "f 1 2 -4\n") == 2103);
    CHECK(error_of("a.obj", good + "f 1 2 99999999999\n") == 2103);
    CHECK(error_of("a.obj", good + "f 1 2 -9223372036854775808\n") == 2103);
    CHECK(error_of("a.obj", good + "f 1 2 99999999999999999999\n") == 2106);
    CHECK(error_of("a.obj", good + "f 1 2 x\n") == 2106);
    CHECK(error_of("a.obj", good + "f 1 2 3.5\n") == 2106);
    CHECK(error_of("a.obj", good + "f 1 2 3/x\n") == 2106);
    CHECK(error_of("a.obj", good + "f 1/1/1/1 2 3\n") == 2106);
    CHECK(error_of("a.obj", good + "f 1 2\n") == 2108);
    CHECK(error_of("a.obj", "v 0 0\n" + good + "f 1 2 3\n") == 2109);
    CHECK(error_of("a.obj", "v 0 0 0 0 0\n" + good + "f 1 2 3\n") == 2109);
    CHECK(error_of("a.obj", good + "surf 0 1 0 1 1 2 3\nf 1 2 3\n") == 2111);
    CHECK(error_of("a.obj", good + "vv 1 2 3\nf 1 2 3\n") == 2112);
    CHECK(error_of("a.obj", good) == 2006);
    CHECK(error_of("a.obj", "# nothing\n") == 2005);
    CHECK(error_of("a.obj", "") == 2005);
    try {
        read("a.obj", good + "f 1 2 3\nf 1 2 9001\n");
        FAIL("was accepted");
    } catch (const Failure& failure) {
        CHECK(failure.code() == ExitCode::bad_input);
        const Diagnostic& diagnostic = failure.diagnostics().at(0);
        CHECK(diagnostic.where.substr(diagnostic.where.size() - 7) == "a.obj:5");
        CHECK(diagnostic.what == "face 1 uses vertex 9001, the file has 3 (counted from 1)");
        CHECK(!diagnostic.hint.empty());
    }
}

TEST_CASE("a face with 300 corners is kept")
{
    std::string obj, face_line = "f", off_face = "300";
    for (int i = 1; i <= 300; ++i) {
        obj += "v " + std::to_string(i) + " 0 1\n";
        face_line += " " + std::to_string(i);
        off_face += " " + std::to_string(i - 1);
    }
    CHECK(read("a.obj", obj + face_line + "\n").faces.size(0) == 300);
    std::string off = "OFF 300 1 0\n";
    for (int i = 1; i <= 300; ++i) off += std::to_string(i) + " 0 1\n";
    CHECK(read("a.off", off + off_face).faces.size(0) == 300);
}

// ---------------------------------------------------------------------------------------------------------------------- OFF

TEST_CASE("OFF: variants")
{
    const std::string body = "0 0 0\n# comment\n\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n";
    for (const std::string head :
         { "OFF\n3 1 0\n", "OFF 3 1 0\n", "OFF\n3 1\n", "# c\n\nOFF # c\n3 1 3 # c\n", "OFF\r\n3 1 0\r\n" }) {
        const MeshFile mesh = read("a.off", head + body);
        CAPTURE(head);
        CHECK(mesh.positions.rows() == 3);
        CHECK(mesh.positions(1, 0) == 1);
        REQUIRE(mesh.faces.count() == 1);
        CHECK(face(mesh, 0) == Face { 0, 1, 2 });
    }
    const MeshFile coloured = read("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 1\n1 0 0 0 0 0 1\n0 1 0 0 0 0 1\n3 2 1 0\n");
    CHECK(coloured.positions(2, 1) == 1);
    CHECK(face(coloured, 0) == Face { 2, 1, 0 });
    for (const std::string kind : { "NCOFF", "CNOFF", "NCSTOFF", "STCNOFF" })
        CHECK(read("a.off", kind + "\n3 1 0\n0 0 0 1 1\n1 0 0 1 1\n0 1 0 1 1\n3 2 1 0\n").positions(2, 1) == 1);
    CHECK(error_of("a.off", "CCOFF\n3 1 0\n") == 2111);
}

TEST_CASE("OFF: what is wrong")
{
    CHECK(error_of("a.off", "4OFF\n3 1 0\n") == 2111);
    CHECK(error_of("a.off", "OFF BINARY\n\1\2\3") == 2111);
    CHECK(error_of("a.off", "OFF\n3 x 0\n") == 2102);
    CHECK(error_of("a.off", "OFF\n3\n") == 2102);
    CHECK(error_of("a.off", "OFF\n-3 1 0\n") == 2102);
    CHECK(error_of("a.off", "OFF") == 2101);
    CHECK(error_of("a.off", "OFF\n4000000000 1 0\n0 0 0\n") == 2007);
    CHECK(error_of("a.off", "OFF\n60000000 1 0\n0 0 0\n") == 2104);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n# padding to pass the check of the size\n") == 2101);
    CHECK(error_of("a.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n") == 2101);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n") == 2110);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0 1\n1 0 0\n0 1 0\n3 0 1 2\n") == 2109);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0\n1 0 0\n0 1 0\n3 0 1 2\n") == 2109);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n") == 2106);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n") == 2106);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n") == 2103);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n") == 2103);
    CHECK(error_of("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n") == 2108);
    CHECK(error_of("a.off", "OFF\n0 0 0\n") == 2005);
}

// -------------------------------------------------------------------------------------------------------------------- files

TEST_CASE("a file is what its name says")
{
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    CHECK(error_of("a.ply", obj) == 2004);
    CHECK(error_of("a.off", obj) == 2004);
    CHECK(error_of("a.obj", "OFF\n3 1 0\n") == 2004);
    CHECK(error_of("a.obj", "ply\nformat ascii 1.0\n") == 2004);
    CHECK(error_of("a.obj", "\x89PNG\r\n\x1a\n") == 2004);
    CHECK(error_of("a.obj", std::string("\0\1\2\3", 4)) == 2004);
    CHECK(error_of("a.obj", "solid cube\n") == 2004);
    CHECK(error_of("a.stl", obj) == 2003);
    CHECK(error_of("a", obj) == 2003);
    CHECK(number_of([] { read_mesh("/no/such/file.obj"); }) == 2001);
    CHECK(number_of([] { read_mesh("/"); }) == 2002);
    CHECK(number_of([] { read_mesh("/dev/zero"); }) == 2002);
    CHECK(number_of([] { read_mesh(""); }) == 2001);
    const TemporaryFolder folder;
    pliant_test::write_bytes(folder / "large.obj", obj);
    std::filesystem::resize_file(folder / "large.obj", std::uintmax_t(5) << 30); // takes no space
    CHECK(number_of([&] { read_mesh(folder / "large.obj"); }) == 2008);
    for (const char* name :
         { "\xc3\xa4\xe2\x82\xac \xe6\xa8\xa1.obj", "-o.obj", "a b  c.obj", "'quoted'\"name\".obj", "a\nb.obj" })
        CHECK_MESSAGE(error_of(name, obj) == 0, name);
    CHECK(error_of(std::string(250, 'x') + ".obj", obj) == 0);
}
