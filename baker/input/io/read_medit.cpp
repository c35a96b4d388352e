// MEDIT's format (INRIA), text: .mesh.
#include "input/io/tet_builder.h"

#include "input/io/number_reader.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace pliant {
namespace {

// A section that is a number and that many rows.
struct Section {
    std::string_view name;
    int size;         // numbers in a row
    const char* kind; // elements of many, if they are left out; of one, if they are refused; null: nothing to tell
    bool is_refused = false;
};

// clang-format off
constexpr Section sections[] = {
    { "Edges", 3, "lines" }, { "EdgesP2", 4, "lines" }, { "Triangles", 4, "triangles" }, { "TrianglesP2", 7, "triangles" },
    { "Quadrilaterals", 5, "quadrilaterals" }, { "QuadrilateralsQ2", 10, "quadrilaterals" },
    { "TetrahedraP2", 11, "a tetrahedron with 10 nodes", true }, { "Hexahedra", 9, "a hexahedron", true },
    { "HexahedraQ2", 28, "a hexahedron with 27 nodes", true }, { "Pentahedra", 7, "a prism", true },
    { "Prisms", 7, "a prism", true }, { "Pyramids", 6, "a pyramid", true },
    { "Corners", 1, nullptr }, { "RequiredVertices", 1, nullptr }, { "Ridges", 1, nullptr }, { "RequiredEdges", 1, nullptr },
    { "RequiredTriangles", 1, nullptr }, { "RequiredQuadrilaterals", 1, nullptr }, { "RequiredTetrahedra", 1, nullptr },
    { "Normals", 3, nullptr }, { "Tangents", 3, nullptr }, { "NormalAtVertices", 2, nullptr },
    { "TangentAtVertices", 2, nullptr }, { "NormalAtTriangleVertices", 3, nullptr },
    { "NormalAtQuadrilateralVertices", 3, nullptr }, { "TangentAtEdges", 3, nullptr },
};
// clang-format on

class MeditReader {
public:
    MeditReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , numbers_(file, '#')
        , tets_(file, mesh, 1)
    {
        numbers_.set_layout(NumberLayout::free);
    }

    bool read();

private:
    bool read_section(std::string_view name);
    bool read_vertices();
    bool read_tets();
    bool leave_out(const Section& section);
    bool check_dimension();
    std::optional<std::uint64_t> read_count(const char* element, std::uint64_t limit, std::uint64_t minimal_size);

    const SourceFile& file_;
    MeshFile& mesh_;
    NumberReader numbers_;
    TetBuilder tets_;
    bool has_vertices_ = false, has_tets_ = false;
};

bool MeditReader::read()
{
    numbers_.word(); // MeshVersionFormatted, as the caller has seen
    if (!numbers_.count(0, "the version")) return false;
    for (std::string_view word = numbers_.word(); !word.empty() && word != "End"; word = numbers_.word()) {
        if (!read_section(word)) return false;
    }
    const std::string_view rest = numbers_.word();
    if (!rest.empty()) {
        file_.error(2110, numbers_.where(), fmt::format("more follows after End: {}", excerpt(rest)),
                    "the file is damaged: export it again");
        return false;
    }
    if (!has_vertices_) {
        report_truncated(file_, "the part before Vertices");
        return false;
    }
    return tets_.finish();
}

bool MeditReader::read_section(std::string_view name)
{
    if (name == "Dimension") return check_dimension();
    if (name == "BoundingBox")
        return numbers_.skip(0) && numbers_.skip(0) && numbers_.skip(0) && numbers_.skip(0) && numbers_.skip(0)
            && numbers_.skip(0);
    if (name == "AngleOfCornerBound" || name == "Geometry" || name == "Identifier") return numbers_.skip(0);
    if (name == "Vertices" || name == "Tetrahedra") {
        bool& is_there = name == "Vertices" ? has_vertices_ : has_tets_;
        if (is_there || (name == "Tetrahedra" && !has_vertices_)) {
            file_.error(2117, numbers_.where(),
                        is_there ? fmt::format("section {} comes twice", name) : "section Tetrahedra comes before Vertices",
                        "the file is damaged: export it again");
            return false;
        }
        is_there = true;
        return name == "Vertices" ? read_vertices() : read_tets();
    }
    const auto section
        = std::find_if(std::begin(sections), std::end(sections), [&](const Section& s) { return s.name == name; });
    if (section != std::end(sections)) return leave_out(*section);
    file_.error(2112, numbers_.where(), fmt::format("unknown section {}", excerpt(name)),
                "the file is damaged, its counts are wrong, or it is not a MEDIT file: export it again");
    return false;
}

bool MeditReader::check_dimension()
{
    const std::optional<std::uint64_t> dimension = numbers_.count(0, "Dimension");
    if (!dimension || *dimension == 3) return dimension.has_value();
    file_.error(2111, numbers_.where(), fmt::format("this kind of MEDIT file is not read: Dimension {}", *dimension),
                "export a mesh in three dimensions");
    return false;
}

std::optional<std::uint64_t> MeditReader::read_count(const char* element, std::uint64_t limit, std::uint64_t minimal_size)
{
    const std::optional<std::uint64_t> count = numbers_.count(0, element);
    // The last line may lack its end.
    if (!count || !check_count(file_, numbers_.line(), element, *count, limit, numbers_.bytes_left() + 1, minimal_size))
        return std::nullopt;
    return count;
}

bool MeditReader::read_vertices()
{
    const std::optional<std::uint64_t> count = read_count("vertices", vertex_count_limit, 8); // "0 0 0 0\n"
    if (!count) return false;
    mesh_.positions.resize(static_cast<Eigen::Index>(*count), 3);
    for (std::uint64_t vertex = 0; vertex < *count; ++vertex) {
        numbers_.begin("vertex", vertex, *count);
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            if (!numbers_.coordinate(0, vertex, mesh_.positions(static_cast<Eigen::Index>(vertex), axis))) return false;
        }
        if (!numbers_.integer(0)) return false; // the reference: nothing that we use
    }
    return true;
}

bool MeditReader::read_tets()
{
    const std::optional<std::uint64_t> count = read_count("tetrahedra", face_count_limit, 10); // "1 2 3 4 0\n"
    if (!count) return false;
    for (std::uint64_t tet = 0; tet < *count; ++tet) {
        numbers_.begin("tetrahedron", tet, *count);
        std::array<std::int64_t, 4> corners {};
        std::size_t line = 0; // where it begins
        for (std::int64_t& corner : corners) {
            const std::optional<std::int64_t> index = numbers_.integer(0);
            if (!index) return false;
            corner = *index;
            if (line == 0) line = numbers_.line();
        }
        if (!numbers_.integer(0)) return false; // the reference
        tets_.add(line, corners);
    }
    return true;
}

bool MeditReader::leave_out(const Section& section)
{
    const auto row_size = static_cast<std::uint64_t>(2 * section.size);
    const std::optional<std::uint64_t> count = read_count("elements", face_count_limit, row_size);
    if (!count || *count == 0) return count.has_value();
    if (section.is_refused) {
        tets_.refuse(numbers_.where(), 0, section.kind);
        return false;
    }
    for (std::uint64_t row = 0; row < *count; ++row) {
        numbers_.begin("element", row, *count);
        for (int i = 0; i < section.size; ++i) {
            if (!numbers_.skip(0)) return false;
        }
    }
    if (section.kind) tets_.skip(section.kind, *count);
    return true;
}

} // namespace

bool read_medit(const SourceFile& file, MeshFile& mesh) { return MeditReader(file, mesh).read(); }

} // namespace pliant
