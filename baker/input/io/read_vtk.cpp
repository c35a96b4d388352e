// VTK's legacy format, ASCII and binary (big-endian): unstructured grids, cells in the layout of version 3.0 or of 5.1.
#include "input/io/tet_builder.h"

#include "input/io/number_reader.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <vector>

namespace pliant {
namespace {

// A type of cells that are left out; corners: how many each has, 0 for any number.
struct LeftOut {
    std::int64_t type;
    std::size_t corners;
    const char* kind;
};

// clang-format off
constexpr LeftOut left_out[] = {
    { 1, 1, "points" }, { 2, 0, "points" }, { 3, 2, "lines" }, { 4, 0, "lines" }, { 21, 3, "lines" },
    { 5, 3, "triangles" }, { 6, 0, "triangles" }, { 22, 6, "triangles" }, { 7, 0, "polygons" },
    { 8, 4, "quadrilaterals" }, { 9, 4, "quadrilaterals" }, { 23, 8, "quadrilaterals" },
};
// clang-format on

// What a cell is that is refused.
std::string refused_kind(std::int64_t type)
{
    switch (type) {
    case 11: return "a voxel";
    case 12: return "a hexahedron";
    case 13: return "a prism";
    case 14: return "a pyramid";
    case 24: return "a tetrahedron with 10 nodes";
    case 25: return "a hexahedron with 20 nodes";
    case 42: return "a polyhedron";
    case 71: return "a tetrahedron of higher order";
    default: return fmt::format("of the type {}", type);
    }
}

// Bytes of a number in a binary file; nothing for names that are not known and for bits.
std::optional<std::size_t> size_of(std::string_view type)
{
    if (type == "char" || type == "unsigned_char" || type == "vtktypeint8" || type == "vtktypeuint8") return 1;
    if (type == "short" || type == "unsigned_short") return 2;
    if (type == "int" || type == "unsigned_int" || type == "float" || type == "vtktypeint32") return 4;
    if (type == "double" || type == "long" || type == "unsigned_long" || type == "vtktypeint64" || type == "vtkIdType")
        return 8;
    return std::nullopt;
}

class VtkReader {
public:
    VtkReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , numbers_(file)
        , tets_(file, mesh)
    {
    }

    bool read();

private:
    bool read_header();
    bool read_section(std::string_view name);
    bool read_points();
    bool read_cells();
    bool read_cells_with_sizes(std::uint64_t cell_count, std::uint64_t size);
    bool read_cells_with_offsets(std::uint64_t offset_count, std::uint64_t size);
    bool read_array(const char* name, std::uint64_t count, std::vector<std::int64_t>& values,
                    std::vector<std::uint32_t>* lines);
    bool read_types();
    bool add_cell(std::size_t cell, std::int64_t type);
    bool skip_metadata();
    bool skip_field();
    bool skip_array();
    bool fail(int number, std::string what);
    // What follows a line with counts: numbers of the file's layout.
    void begin_data()
    {
        if (is_binary_) numbers_.rest_of_line();
        numbers_.set_layout(is_binary_ ? NumberLayout::big_endian : NumberLayout::free);
    }
    void end_data() { numbers_.set_layout(NumberLayout::free); }
    bool has_room(std::uint64_t count, const char* what, std::uint64_t limit, std::size_t size);

    const SourceFile& file_;
    MeshFile& mesh_;
    NumberReader numbers_;
    TetBuilder tets_;
    bool is_binary_ = false;
    bool has_points_ = false, has_cells_ = false, has_types_ = false;
    std::vector<std::int64_t> offsets_; // of cells in corners_
    std::vector<std::int64_t> corners_;
    std::vector<std::uint32_t> lines_; // of corners, in text
};

bool VtkReader::fail(int number, std::string what)
{
    file_.error(number, numbers_.where(), std::move(what), "the file is damaged: export it again");
    return false;
}

bool VtkReader::has_room(std::uint64_t count, const char* what, std::uint64_t limit, std::size_t size)
{
    const std::uint64_t minimal_size = is_binary_ ? size : 2; // "0 "
    return check_count(file_, numbers_.line(), what, count, limit, numbers_.bytes_left() + (is_binary_ ? 0 : 1),
                       minimal_size);
}

bool VtkReader::read()
{
    if (!read_header()) return false;
    for (std::string_view word = numbers_.word(); !word.empty(); word = numbers_.word()) {
        // Data on points and cells are the last part, and nothing of ours.
        if (word == "POINT_DATA" || word == "CELL_DATA") break;
        if (!read_section(word)) return false;
    }
    const char* missing = !has_points_ ? "POINTS" : !has_cells_ ? "CELLS" : !has_types_ ? "CELL_TYPES" : nullptr;
    if (!missing) return tets_.finish();
    file_.error(2117, file_.path, fmt::format("section {} is missing", missing),
                "the file is cut off or damaged: export it again");
    return false;
}

bool VtkReader::read_header()
{
    const std::string_view version = numbers_.rest_of_line(); // "# vtk DataFile Version 3.0", as the caller has seen
    numbers_.rest_of_line();                                  // a title
    numbers_.set_layout(NumberLayout::free);
    const std::string_view encoding = numbers_.word();
    is_binary_ = encoding == "BINARY";
    if (!is_binary_ && encoding != "ASCII")
        return fail(2102, fmt::format("header not understood: {} after {}", excerpt(encoding), excerpt(version)));
    const std::string_view keyword = numbers_.word(), kind = numbers_.word();
    if (keyword != "DATASET") return fail(2102, fmt::format("header not understood: {}", excerpt(keyword)));
    if (kind == "UNSTRUCTURED_GRID") return true;
    file_.error(2111, numbers_.where(), fmt::format("this kind of VTK file is not read: {}", excerpt(kind)),
                "export as UNSTRUCTURED_GRID");
    return false;
}

bool VtkReader::read_section(std::string_view name)
{
    if (name == "POINTS" && !has_points_) return read_points();
    if (name == "CELLS" && !has_cells_ && has_points_) return read_cells();
    if (name == "CELL_TYPES" && !has_types_ && has_cells_) return read_types();
    if (name == "FIELD") return skip_field();
    if (name == "METADATA") return skip_metadata();
    if (name == "POINTS" || name == "CELLS" || name == "CELL_TYPES")
        return fail(2117, fmt::format("section {} comes twice or too early", name));
    return fail(2112, fmt::format("unknown section {}", excerpt(name)));
}

bool VtkReader::read_points()
{
    has_points_ = true;
    const std::optional<std::uint64_t> count = numbers_.count(0, "points");
    if (!count) return false;
    const std::string_view type = numbers_.word();
    if (type != "float" && type != "double") {
        file_.error(2111, numbers_.where(), fmt::format("points of the type {} are not read", excerpt(type)),
                    "export them as float or double");
        return false;
    }
    const std::size_t size = type == "float" ? 4 : 8;
    if (!has_room(*count, "points", vertex_count_limit, 3 * size)) return false;
    begin_data();
    mesh_.positions.resize(static_cast<Eigen::Index>(*count), 3);
    for (std::uint64_t point = 0; point < *count; ++point) {
        numbers_.begin("point", point, *count);
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            if (!numbers_.coordinate(size, point, mesh_.positions(static_cast<Eigen::Index>(point), axis))) return false;
        }
    }
    end_data();
    return true;
}

bool VtkReader::read_cells()
{
    has_cells_ = true;
    const std::optional<std::uint64_t> count = numbers_.count(0, "cells");
    const std::optional<std::uint64_t> size = count ? numbers_.count(0, "numbers of cells") : std::nullopt;
    if (!size || !has_room(*count, "cells", face_count_limit, 4)
        || !has_room(*size, "numbers of cells", corner_count_limit, 4))
        return false;
    // In binary files what follows the line may begin like anything, but a cell has no 1.3e9 corners.
    return numbers_.peek() == "OFFSETS" ? read_cells_with_offsets(*count, *size) : read_cells_with_sizes(*count, *size);
}

// Version 3.0: of each cell the number of its corners, then these.
bool VtkReader::read_cells_with_sizes(std::uint64_t cell_count, std::uint64_t size)
{
    begin_data();
    offsets_ = { 0 };
    for (std::uint64_t cell = 0; cell < cell_count; ++cell) {
        numbers_.begin("cell", cell, cell_count);
        const std::optional<std::uint64_t> corner_count = numbers_.count(4, "corners");
        if (!corner_count) return false;
        if (*corner_count >= size || corners_.size() + offsets_.size() + *corner_count > size)
            return fail(2102, fmt::format("cell {} has {} corners, more than all cells together", cell, *corner_count));
        for (std::uint64_t i = 0; i < *corner_count; ++i) {
            const std::optional<std::int64_t> corner = numbers_.integer(4);
            if (!corner) return false;
            corners_.push_back(*corner);
            if (!is_binary_)
                lines_.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(numbers_.line(), UINT32_MAX)));
        }
        offsets_.push_back(static_cast<std::int64_t>(corners_.size()));
    }
    end_data();
    if (corners_.size() + cell_count == size) return true;
    return fail(2102, fmt::format("CELLS declares {} numbers and holds {}", size, corners_.size() + cell_count));
}

bool VtkReader::read_array(const char* name, std::uint64_t count, std::vector<std::int64_t>& values,
                           std::vector<std::uint32_t>* lines)
{
    const std::string_view keyword = numbers_.word(), type = numbers_.word();
    const bool is_long = type == "vtktypeint64" || type == "long" || type == "vtkIdType";
    if (keyword != name || (!is_long && type != "vtktypeint32" && type != "int"))
        return fail(2102, fmt::format("{} expected, found {} {}", name, excerpt(keyword), excerpt(type)));
    if (!has_room(count, name, corner_count_limit, is_long ? 8 : 4)) return false;
    begin_data();
    for (std::uint64_t i = 0; i < count; ++i) {
        numbers_.begin(name, i, count);
        const std::optional<std::int64_t> value = numbers_.integer(is_long ? 8 : 4);
        if (!value) return false;
        values.push_back(*value);
        if (lines && !is_binary_)
            lines->push_back(static_cast<std::uint32_t>(std::min<std::size_t>(numbers_.line(), UINT32_MAX)));
    }
    end_data();
    return true;
}

// Version 5.1: where the corners of each cell begin, and all corners.
bool VtkReader::read_cells_with_offsets(std::uint64_t offset_count, std::uint64_t size)
{
    if (!read_array("OFFSETS", offset_count, offsets_, nullptr) || !read_array("CONNECTIVITY", size, corners_, &lines_))
        return false;
    if (offsets_.empty()) offsets_ = { 0 };
    const bool is_good = offsets_.front() == 0 && offsets_.back() == static_cast<std::int64_t>(corners_.size())
        && std::is_sorted(offsets_.begin(), offsets_.end());
    return is_good || fail(2102, "OFFSETS do not run from 0 to the number of corners");
}

bool VtkReader::read_types()
{
    has_types_ = true;
    const std::optional<std::uint64_t> count = numbers_.count(0, "cell types");
    if (!count) return false;
    if (*count != offsets_.size() - 1) return fail(2102, fmt::format("{} cells have {} types", offsets_.size() - 1, *count));
    begin_data();
    for (std::uint64_t cell = 0; cell < *count; ++cell) {
        numbers_.begin("cell type", cell, *count);
        const std::optional<std::int64_t> type = numbers_.integer(4);
        if (!type || !add_cell(static_cast<std::size_t>(cell), *type)) return false;
    }
    end_data();
    return true;
}

bool VtkReader::add_cell(std::size_t cell, std::int64_t type)
{
    const auto begin = static_cast<std::size_t>(offsets_[cell]), end = static_cast<std::size_t>(offsets_[cell + 1]);
    const std::size_t line = begin < lines_.size() ? lines_[begin] : 0;
    const auto skipped
        = std::find_if(std::begin(left_out), std::end(left_out), [&](const LeftOut& l) { return l.type == type; });
    const bool is_skipped = skipped != std::end(left_out);
    if (!is_skipped && type != 10) {
        tets_.refuse(file_.at_line(line), cell, refused_kind(type));
        return false;
    }
    // A file cut off behind the 1 of a 10 looks like one with a point.
    const std::size_t corner_count = is_skipped ? skipped->corners : 4;
    if (corner_count != 0 && end - begin != corner_count) {
        file_.error(
            2108, file_.at_line(line),
            fmt::format("element {} has {} corners, {} expected of the type {}", cell, end - begin, corner_count, type),
            "the file is damaged: export it again");
        return false;
    }
    if (is_skipped) {
        tets_.skip(skipped->kind);
        return true;
    }
    tets_.add(line, { corners_[begin], corners_[begin + 1], corners_[begin + 2], corners_[begin + 3] });
    return true;
}

// FIELD name count, then arrays.
// Ends with an empty line.
bool VtkReader::skip_metadata()
{
    numbers_.rest_of_line();
    while (numbers_.bytes_left() != 0 && !numbers_.rest_of_line().empty()) {}
    return true;
}

bool VtkReader::skip_field()
{
    numbers_.word();
    const std::optional<std::uint64_t> count = numbers_.count(0, "arrays");
    if (!count) return false;
    for (std::uint64_t i = 0; i < *count; ++i) { // ends with the file, whatever the count
        if (!skip_array()) return false;
    }
    return true;
}

bool VtkReader::skip_array()
{
    std::string_view name = numbers_.word();
    if (name == "METADATA" && skip_metadata()) name = numbers_.word(); // of the array before
    const std::optional<std::uint64_t> width = numbers_.count(0, "components"),
                                       length = width ? numbers_.count(0, "tuples") : std::nullopt;
    if (!length) return false;
    const std::string_view type = numbers_.word();
    const std::optional<std::size_t> size = size_of(type);
    if (!size) {
        file_.error(2111, numbers_.where(), fmt::format("array {} of the type {} is not read", excerpt(name), excerpt(type)),
                    "export the mesh without data");
        return false;
    }
    if (!has_room(*width, "components", corner_count_limit, 0) || !has_room(*length, "tuples", corner_count_limit, 0))
        return false;
    begin_data();
    numbers_.begin("an array of data", 0, 0);
    const std::uint64_t total = *width * *length; // both below 2^29
    if (is_binary_ && !numbers_.skip_bytes(total * *size)) return false;
    for (std::uint64_t i = 0; i < total && !is_binary_; ++i) {
        if (!numbers_.skip(0)) return false;
    }
    end_data();
    return true;
}

} // namespace

bool read_vtk(const SourceFile& file, MeshFile& mesh) { return VtkReader(file, mesh).read(); }

} // namespace pliant
