// Wavefront OBJ. Our own reader rather than tinyobjloader, which was measured: it rounds more than half of all coordinates
// wrongly (by up to 4 ulp), holds at most 255 corners a face, and takes nan and 0,5 for 0; a check in front of it that
// refuses those has read the whole file already. Tests compare the two.
#include "input/io/source_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace pliant {
namespace {

// Statements that say nothing about the surface: texture, normals, grouping, display. Sorted.
constexpr std::array<std::string_view, 20> skipped_statements { "bevel",  "c_interp", "d_interp",   "g",         "l",
                                                                "lod",    "maplib",   "mg",         "mtllib",    "o",
                                                                "p",      "s",        "shadow_obj", "trace_obj", "usemap",
                                                                "usemtl", "vn",       "vp",         "vt",        "vw" };

// Curves and surfaces: geometry that would be lost in silence. Sorted.
constexpr std::array<std::string_view, 23> free_form_statements { "bmat", "bsp",   "bzp",    "call",  "cdc",  "cdp",
                                                                  "con",  "csh",   "cstype", "ctech", "curv", "curv2",
                                                                  "deg",  "end",   "hole",   "parm",  "res",  "scrv",
                                                                  "sp",   "stech", "step",   "surf",  "trim" };

template <std::size_t N> bool contains(const std::array<std::string_view, N>& sorted, std::string_view word)
{
    return std::binary_search(sorted.begin(), sorted.end(), word);
}

// A face may name a vertex that comes later in the file; whether it came is known at the end.
struct ForwardReference {
    std::size_t face;
    std::size_t line;
    std::int64_t index;
};

class ObjReader {
public:
    ObjReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , faces_(file, mesh)
    {
    }

    bool read();

private:
    bool read_statement(std::string_view statement);
    void read_vertex(std::string_view words);
    void read_face(std::string_view words);
    void read_corner(std::string_view word);
    void check_forward_references() const;
    void store_positions() const;

    const SourceFile& file_;
    MeshFile& mesh_;
    FaceBuilder faces_;
    std::size_t line_ = 0;
    std::vector<double> coordinates_;
    std::vector<ForwardReference> forward_references_;

    std::int64_t vertex_count() const { return static_cast<std::int64_t>(coordinates_.size() / 3); }
};

bool ObjReader::read()
{
    LineReader lines(file_.bytes);
    std::string joined; // a statement over several lines, ended by backslashes
    while (lines.next()) {
        std::string_view line = lines.line();
        const bool goes_on = !line.empty() && line.back() == '\\'
            && line.find('#') == std::string_view::npos; // comments end with folders of Windows
        if (goes_on) line.remove_suffix(1);
        if (joined.empty()) line_ = lines.number();
        if (goes_on || !joined.empty()) {
            joined += line;
            joined += ' ';
            if (goes_on) continue;
            line = joined;
        }
        if (!read_statement(line)) return false;
        joined.clear();
    }
    if (!joined.empty() && !read_statement(joined)) return false;
    check_forward_references();
    store_positions();
    return true;
}

bool ObjReader::read_statement(std::string_view statement)
{
    const std::string_view keyword = next_word(statement, '#');
    if (keyword.empty() || contains(skipped_statements, keyword)) return true;
    if (keyword == "v") {
        read_vertex(statement);
        return check_count(file_, line_, "vertices", coordinates_.size() / 3, vertex_count_limit, 0, 0);
    }
    if (keyword == "f" || keyword == "fo") {
        read_face(statement);
        return check_count(file_, line_, "faces", mesh_.faces.count(), face_count_limit, 0, 0)
            && check_count(file_, line_, "face corners", mesh_.faces.indices.size(), corner_count_limit, 0, 0);
    }
    if (contains(free_form_statements, keyword)) {
        file_.error(2111, file_.at_line(line_), fmt::format("statement {} describes a free-form surface", excerpt(keyword)),
                    "convert the surface to polygons");
        return false;
    }
    file_.error(2112, file_.at_line(line_), fmt::format("unknown statement {}", excerpt(keyword)),
                "the file is damaged or not an OBJ file: export it again");
    return true;
}

// v x y z, then perhaps a weight (of curves, unused) or a colour, or both.
void ObjReader::read_vertex(std::string_view words)
{
    const auto vertex = static_cast<std::size_t>(vertex_count());
    std::size_t count = 0;
    for (std::string_view word = next_word(words, '#'); !word.empty(); word = next_word(words, '#'), ++count) {
        double value = 0;
        read_coordinate(file_, line_, vertex, word, value);
        if (count < 3) coordinates_.push_back(value);
    }
    if (count != 3 && count != 4 && count != 6 && count != 7) {
        file_.error(2109, file_.at_line(line_), fmt::format("vertex {} has {} numbers, 3 expected", vertex, count),
                    "the file is damaged: export it again");
    }
    coordinates_.resize(3 * (vertex + 1)); // keeps the count right, so that later messages are
}

void ObjReader::read_face(std::string_view words)
{
    for (std::string_view word = next_word(words, '#'); !word.empty(); word = next_word(words, '#')) read_corner(word);
    faces_.end_face(line_);
}

// v, v/vt, v//vn or v/vt/vn: what follows the first slash must look right but is not used.
void ObjReader::read_corner(std::string_view word)
{
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::optional<std::int64_t> index = parse_integer(word.substr(0, slash));
    const bool has_clean_tail = word.find_first_not_of("+-0123456789/", slash) == std::string_view::npos
        && std::count(word.begin(), word.end(), '/') <= 2;
    if (!index || !has_clean_tail) {
        file_.error(2106, file_.at_line(line_),
                    fmt::format("face {}: corner {} not understood", faces_.face(), excerpt(word)),
                    "the file is damaged: export it again");
        mesh_.faces.indices.push_back(0);
        return;
    }
    if (*index == 0) {
        file_.error(2107, file_.at_line(line_), fmt::format("face {} uses vertex 0, but OBJ counts from 1", faces_.face()),
                    "the program that wrote the file counts from 0: correct its export");
    } else if (*index < 0 && *index < -vertex_count()) {
        file_.error(2103, file_.at_line(line_),
                    fmt::format("face {} uses vertex {}, but only {} vertices come before it", faces_.face(), *index,
                                vertex_count()),
                    "vertices are missing or the face is wrong: export the file again");
    } else if (*index > vertex_count()) {
        forward_references_.push_back({ faces_.face(), line_, *index });
    }
    const std::int64_t zero_based = *index > 0 ? *index - 1 : vertex_count() + *index;
    // A forward reference beyond the limit is an error in any case; the cast must not wrap before that is said.
    const bool fits = zero_based >= 0 && static_cast<std::uint64_t>(zero_based) < vertex_count_limit;
    mesh_.faces.indices.push_back(fits ? static_cast<std::uint32_t>(zero_based) : 0);
}

void ObjReader::check_forward_references() const
{
    for (const ForwardReference& reference : forward_references_) {
        if (reference.index <= vertex_count()) continue;
        file_.error(2103, file_.at_line(reference.line),
                    fmt::format("face {} uses vertex {}, the file has {} (counted from 1)", reference.face, reference.index,
                                vertex_count()),
                    "vertices are missing or the face is wrong: export the file again");
    }
}

void ObjReader::store_positions() const
{
    mesh_.positions = Eigen::Map<const Positions>(coordinates_.data(), vertex_count(), 3);
}

} // namespace

bool is_obj_statement(std::string_view word)
{
    return word == "v" || word == "f" || word == "fo" || contains(skipped_statements, word)
        || contains(free_form_statements, word);
}

bool read_obj(const SourceFile& file, MeshFile& mesh) { return ObjReader(file, mesh).read(); }

} // namespace pliant
