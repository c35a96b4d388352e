// The format of the Vega library, text: .veg. Vertices, tetrahedra, and materials of sets of tetrahedra.
#include "input/io/tet_builder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <utility>
#include <vector>

namespace pliant {
namespace {

std::string upper(std::string_view text)
{
    std::string result(text);
    for (char& c : result) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return result;
}

// The next part of a row: parts end with a blank, a comma or both. A comma inside a number is none of these: "0,5" is one
// word.
std::string_view next_cell(std::string_view& line)
{
    std::string_view word = next_word(line, '#');
    while (!word.empty() && word.back() == ',') word.remove_suffix(1);
    return word;
}

// The next part of a list, commas with or without blanks; empty at the end of the line.
std::string_view next_part(std::string_view& line)
{
    const std::size_t begin = std::min(line.find_first_not_of(", \t"), line.size());
    const std::size_t end = std::min(line.find_first_of(", \t#", begin), line.size());
    const std::string_view part = line.substr(begin, end - begin);
    line.remove_prefix(end);
    if (part.empty()) line = {}; // a comment
    return part;
}

// The parts of a list of known length: at most one more.
template <std::size_t size> std::vector<std::string_view> parts_of(std::string_view line)
{
    std::vector<std::string_view> parts;
    for (std::string_view part = next_part(line); !part.empty() && parts.size() <= size; part = next_part(line))
        parts.push_back(part);
    return parts;
}

// A set of tetrahedra by name; numbers as in the file.
struct Set {
    std::size_t line = 0;
    bool is_all = false;
    bool is_used = false; // by a region, which is enough for once
    std::vector<std::int64_t> tets;
};

struct Region {
    std::size_t line = 0;
    std::string_view set, material; // of the file
};

class VegaReader {
public:
    VegaReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , lines_(file.bytes)
        , tets_(file, mesh)
    {
    }

    bool read();

private:
    bool next_line();
    bool next_row(); // false at the end and at the next section
    bool read_section();
    bool read_vertices();
    bool read_elements();
    bool read_tet(std::uint64_t tet, std::uint64_t count);
    bool read_material(const std::string& name);
    bool read_set(const std::string& name);
    bool read_regions();
    bool read_counts(const char* element, std::array<std::int64_t, 2>& counts);
    bool read_number(std::uint64_t element, const char* kind, std::int64_t& first);
    bool assign_materials();
    bool assign(const Region& region);
    bool fail(int number, std::string what, const char* hint = "the file is damaged: export it again");
    std::string where() const { return file_.at_line(lines_.number()); }

    const SourceFile& file_;
    MeshFile& mesh_;
    LineReader lines_;
    TetBuilder tets_;
    std::string_view line_;
    bool is_kept_ = false; // the line was read and belongs to what comes next
    bool has_vertices_ = false, has_elements_ = false;
    std::int64_t first_vertex_ = 1, first_tet_ = 1; // numbers of the first
    std::map<std::string, Set, std::less<>> sets_;
    std::map<std::string, std::uint32_t, std::less<>> materials_;
    std::vector<Region> regions_;
};

bool VegaReader::fail(int number, std::string what, const char* hint)
{
    file_.error(number, where(), std::move(what), hint);
    return false;
}

bool VegaReader::next_line()
{
    if (is_kept_) {
        is_kept_ = false;
        return true;
    }
    while (lines_.next()) {
        line_ = lines_.line();
        std::string_view rest = line_;
        if (!next_word(rest, '#').empty()) return true;
    }
    return false;
}

bool VegaReader::next_row()
{
    if (!next_line()) return false;
    is_kept_ = line_[line_.find_first_not_of(" \t")] == '*';
    return !is_kept_;
}

bool VegaReader::read()
{
    sets_["allElements"].is_all = true;
    while (next_line()) {
        if (!read_section()) return false;
    }
    if (!has_vertices_ || !has_elements_) {
        file_.error(2117, file_.path, fmt::format("section *{} is missing", has_vertices_ ? "ELEMENTS" : "VERTICES"),
                    "the file is cut off or damaged: export it again");
        return false;
    }
    return tets_.finish() && assign_materials();
}

bool VegaReader::read_section()
{
    const std::string keyword = upper(next_word(line_, '#'));
    const std::string name(next_cell(line_));
    if (keyword == "*VERTICES" || keyword == "*ELEMENTS") {
        bool& is_there = keyword == "*VERTICES" ? has_vertices_ : has_elements_;
        if (is_there || (keyword == "*ELEMENTS" && !has_vertices_))
            return fail(2117, fmt::format("section {} comes {}", keyword, is_there ? "twice" : "before *VERTICES"));
        is_there = true;
        return keyword == "*VERTICES" ? read_vertices() : read_elements();
    }
    if (keyword == "*MATERIAL") return read_material(name);
    if (keyword == "*SET") return read_set(name);
    if (keyword == "*REGION") return read_regions();
    if (keyword == "*INCLUDE") return fail(2111, "*INCLUDE is not read", "put the included text into the file");
    return fail(2112, fmt::format("a section expected, found {}", excerpt(keyword)));
}

// The number of elements and how many numbers each has; a third number counts attributes, which Vega knows none of.
bool VegaReader::read_counts(const char* element, std::array<std::int64_t, 2>& counts)
{
    if (!next_row()) {
        report_truncated(file_, fmt::format("the header of the {}", element));
        return false;
    }
    std::string_view row = line_;
    for (std::int64_t& count : counts) {
        const std::optional<std::int64_t> value = parse_integer(next_cell(row));
        if (!value || *value < 0) return fail(2102, fmt::format("number of {} not understood: {}", element, excerpt(line_)));
        count = *value;
    }
    return true;
}

// The number in front of a row: from 0 or from 1, as the first row says, then one by one.
bool VegaReader::read_number(std::uint64_t element, const char* kind, std::int64_t& first)
{
    const std::string_view word = next_cell(line_);
    const std::optional<std::int64_t> number = parse_integer(word);
    if (element == 0 && number && (*number == 0 || *number == 1)) first = *number;
    const std::int64_t expected = first + static_cast<std::int64_t>(element);
    if (number == expected) return true;
    return fail(2118, fmt::format("{} {} is numbered {}, {} expected", kind, element, excerpt(word), expected),
                "number them consecutively, from 0 or from 1");
}

bool VegaReader::read_vertices()
{
    std::array<std::int64_t, 2> counts {};
    if (!read_counts("vertices", counts)) return false;
    const auto count = static_cast<std::uint64_t>(counts[0]);
    if (counts[1] != 3) return fail(2111, fmt::format("vertices with {} coordinates are not read", counts[1]));
    // The shortest row: "1 0 0 0\n".
    if (!check_count(file_, lines_.number(), "vertices", count, vertex_count_limit, file_.bytes.size() - lines_.offset() + 1,
                     8))
        return false;
    mesh_.positions.setZero(static_cast<Eigen::Index>(count), 3);
    for (std::uint64_t vertex = 0; vertex < count; ++vertex) {
        if (!next_row()) {
            report_truncated(file_, "vertex", vertex, count);
            return false;
        }
        if (!read_number(vertex, "vertex", first_vertex_)) return false;
        Eigen::Index size = 0;
        for (std::string_view word = next_cell(line_); !word.empty(); word = next_cell(line_), ++size) {
            double value = 0;
            read_coordinate(file_, lines_.number(), vertex, word, value);
            if (size < 3) mesh_.positions(static_cast<Eigen::Index>(vertex), size) = value;
        }
        if (size != 3) fail(2109, fmt::format("vertex {} has {} numbers, 3 expected", vertex, size));
    }
    tets_.set_first(first_vertex_);
    return true;
}

bool VegaReader::read_elements()
{
    if (!next_row()) {
        report_truncated(file_, "the header of the elements");
        return false;
    }
    std::string_view row = line_;
    const std::string kind = upper(next_cell(row));
    std::array<std::int64_t, 2> counts {};
    if (!read_counts("elements", counts)) return false;
    const auto count = static_cast<std::uint64_t>(counts[0]);
    if (kind != "TET" && kind != "TETS") {
        const bool is_cube = kind == "CUBIC" || kind == "CUBE";
        tets_.refuse(where(), 0, is_cube ? "a cube" : fmt::format("of the unknown type {}", excerpt(kind)));
        return false;
    }
    if (counts[1] != 4) return fail(2108, fmt::format("element 0 is a tetrahedron with {} corners", counts[1]));
    // The shortest row: "1 1 2 3 4\n".
    if (!check_count(file_, lines_.number(), "elements", count, face_count_limit, file_.bytes.size() - lines_.offset() + 1,
                     10))
        return false;
    for (std::uint64_t tet = 0; tet < count; ++tet) {
        if (!read_tet(tet, count)) return false;
    }
    return true;
}

bool VegaReader::read_tet(std::uint64_t tet, std::uint64_t count)
{
    if (!next_row()) {
        report_truncated(file_, "element", tet, count);
        return false;
    }
    if (!read_number(tet, "element", first_tet_)) return false;
    std::array<std::int64_t, 4> corners {};
    std::size_t size = 0;
    for (std::string_view word = next_cell(line_); !word.empty(); word = next_cell(line_), ++size) {
        const std::optional<std::int64_t> corner = parse_integer(word);
        if (!corner) return fail(2106, fmt::format("element {}: corner {} not understood", tet, excerpt(word)));
        if (size < 4) corners[size] = *corner;
    }
    if (size != 4) return fail(2109, fmt::format("element {} has {} corners, 4 expected", tet, size));
    tets_.add(lines_.number(), corners);
    return true;
}

// "ENU, density, Young's modulus, Poisson's ratio": the one kind that we know what to do with.
bool VegaReader::read_material(const std::string& name)
{
    if (!next_row()) {
        report_truncated(file_, fmt::format("material {}", excerpt(name)));
        return false;
    }
    const std::vector<std::string_view> parts = parts_of<4>(line_);
    if (parts.empty() || upper(parts[0]) != "ENU")
        return fail(2119, fmt::format("material {} is {}", excerpt(name), parts.empty() ? "empty" : excerpt(parts[0])),
                    "only ENU materials are read: ENU, density, Young's modulus, Poisson's ratio");
    std::array<double, 3> values {};
    bool is_good = parts.size() == 4;
    for (std::size_t i = 0; i < 3 && is_good; ++i) {
        const auto [end, error] = std::from_chars(parts[i + 1].data(), parts[i + 1].data() + parts[i + 1].size(), values[i]);
        is_good = error == std::errc() && end == parts[i + 1].data() + parts[i + 1].size();
    }
    constexpr double largest = 1e100; // ratios of moduli are formed
    is_good = is_good && values[1] > 1 / largest && values[1] < largest && values[2] > -1 && values[2] < 0.5;
    if (!is_good)
        return fail(2119, fmt::format("material {} not understood: {}", excerpt(name), excerpt(line_)),
                    "write ENU, density, Young's modulus above 0, Poisson's ratio between -1 and 0.5, decimal points");
    if (!materials_.emplace(name, static_cast<std::uint32_t>(mesh_.regions.materials.size())).second)
        return fail(2119, fmt::format("material {} comes twice", excerpt(name)), "give each its own name");
    mesh_.regions.materials.push_back({ name, values[1], values[2] });
    return true;
}

bool VegaReader::read_set(const std::string& name)
{
    Set& set = sets_[name];
    if (set.is_all || set.line != 0)
        return fail(2119, fmt::format("set {} comes twice", excerpt(name)), "give each its own name");
    set.line = lines_.number();
    while (next_row()) {
        for (std::string_view part = next_part(line_); !part.empty(); part = next_part(line_)) {
            const std::optional<std::int64_t> tet = parse_integer(part);
            if (!tet) return fail(2106, fmt::format("set {}: number {} not understood", excerpt(name), excerpt(part)));
            set.tets.push_back(*tet);
        }
    }
    return true;
}

bool VegaReader::read_regions()
{
    while (next_row()) {
        const std::vector<std::string_view> parts = parts_of<2>(line_);
        if (parts.size() != 2)
            return fail(2119, fmt::format("region not understood: {}", excerpt(line_)),
                        "write the set, a comma, the material");
        regions_.push_back({ lines_.number(), parts[0], parts[1] });
    }
    return true;
}

constexpr std::uint32_t no_material = UINT32_MAX;

bool VegaReader::assign(const Region& region)
{
    const auto set = sets_.find(region.set);
    const auto material = materials_.find(region.material);
    if (set == sets_.end() || material == materials_.end()) {
        const bool is_set = set == sets_.end();
        file_.error(
            2119, file_.at_line(region.line),
            fmt::format("there is no {} {}", is_set ? "set" : "material", excerpt(is_set ? region.set : region.material)),
            "the file is damaged: export it again");
        return false;
    }
    if (std::exchange(set->second.is_used, true)) return true; // a later region has it all
    std::vector<std::uint32_t>& of_tet = mesh_.regions.of_tet;
    const auto give = [&](std::size_t tet) { of_tet[tet] = of_tet[tet] == no_material ? material->second : of_tet[tet]; };
    for (std::size_t tet = 0; set->second.is_all && tet < of_tet.size(); ++tet) give(tet);
    for (const std::int64_t number : set->second.tets) {
        if (number < first_tet_ || number - first_tet_ >= static_cast<std::int64_t>(of_tet.size())) {
            file_.error(2103, file_.at_line(set->second.line),
                        fmt::format("set {} uses tetrahedron {}, the file has {} (counted from {})", excerpt(region.set),
                                    number, of_tet.size(), first_tet_),
                        "the file is damaged: export it again");
            return false;
        }
        give(static_cast<std::size_t>(number - first_tet_));
    }
    return true;
}

// Where sets overlap, the last region counts: so they are taken from the last to the first, and every set once, which keeps
// the time proportional to the file.
bool VegaReader::assign_materials()
{
    SolidRegions& result = mesh_.regions;
    if (result.materials.empty() && regions_.empty()) return true;
    const bool is_uniform = regions_.empty() && result.materials.size() == 1;
    result.of_tet.assign(mesh_.tets.size(), is_uniform ? 0 : no_material);
    for (auto region = regions_.rbegin(); region != regions_.rend(); ++region) {
        if (!assign(*region)) return false;
    }
    const auto left = std::find(result.of_tet.begin(), result.of_tet.end(), no_material);
    if (left == result.of_tet.end()) return true;
    const auto tet = static_cast<std::size_t>(left - result.of_tet.begin());
    file_.error(2119, file_.at_line(mesh_.tet_lines[tet]), fmt::format("tetrahedron {} has no material", tet),
                "every tetrahedron must be in a set that a *REGION gives a material");
    return false;
}

} // namespace

bool read_vega(const SourceFile& file, MeshFile& mesh) { return VegaReader(file, mesh).read(); }

} // namespace pliant
