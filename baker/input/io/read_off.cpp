// Object File Format (Geomview), text: OFF, and COFF, NOFF, STOFF and their mixtures, whose additions are skipped.
#include "input/io/source_file.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <string>

namespace pliant {
namespace {

class OffReader {
public:
    OffReader(const SourceFile& file, MeshFile& mesh)
        : file_(file)
        , mesh_(mesh)
        , lines_(file.bytes)
    {
    }

    bool read() { return read_header() && read_vertices() && read_faces() && check_end(); }

private:
    // The next line that is neither empty nor a comment.
    bool next_line();
    bool read_header();
    bool read_counts(std::string_view words);
    bool read_vertices();
    bool read_faces();
    bool check_end();

    const SourceFile& file_;
    MeshFile& mesh_;
    LineReader lines_;
    std::string_view line_;
    bool has_attributes_ = false; // vertices carry more than a position
    std::uint64_t vertex_count_ = 0;
    std::uint64_t face_count_ = 0;
};

bool OffReader::next_line()
{
    while (lines_.next()) {
        line_ = lines_.line();
        std::string_view rest = line_;
        if (!next_word(rest, '#').empty()) return true;
    }
    return false;
}

// OFF behind any mixture of ST, C and N. Geomview writes them in this order, other programs in theirs.
bool is_text_kind(std::string_view keyword)
{
    constexpr std::string_view ending = "OFF";
    if (keyword.size() < ending.size() || keyword.substr(keyword.size() - ending.size()) != ending) return false;
    std::string additions(keyword.substr(0, keyword.size() - ending.size()));
    for (const std::string_view addition : { "ST", "C", "N" }) {
        const std::size_t place = additions.find(addition);
        if (place != std::string::npos) additions.erase(place, addition.size());
    }
    return additions.empty();
}

bool OffReader::read_header()
{
    if (!next_line()) {
        report_truncated(file_, "the header");
        return false;
    }
    const std::string_view keyword = next_word(line_, '#');
    std::string_view rest = line_;
    const bool is_binary = next_word(rest, '#') == "BINARY";
    if (!is_text_kind(keyword) || is_binary) {
        file_.error(2111, file_.at_line(lines_.number()),
                    fmt::format("this kind of OFF is not read: {}{}", excerpt(keyword), is_binary ? " BINARY" : ""),
                    "export as text OFF with three coordinates, or as PLY");
        return false;
    }
    has_attributes_ = keyword != "OFF";
    rest = line_;
    if (next_word(rest, '#').empty() && !next_line()) {
        report_truncated(file_, "the header");
        return false;
    }
    return read_counts(line_);
}

// Vertices, faces, and edges, which many writers leave out or set to 0.
bool OffReader::read_counts(std::string_view words)
{
    std::array<std::int64_t, 3> counts {};
    std::size_t count = 0;
    bool is_good = true;
    for (std::string_view word = next_word(words, '#'); !word.empty(); word = next_word(words, '#'), ++count) {
        const std::optional<std::int64_t> value = parse_integer(word);
        is_good = is_good && count < 3 && value && *value >= 0;
        if (is_good) counts[count] = *value;
    }
    if (!is_good || count < 2) {
        file_.error(2102, file_.at_line(lines_.number()), fmt::format("header not understood: {}", excerpt(lines_.line())),
                    "after OFF come the numbers of vertices, faces and edges");
        return false;
    }
    vertex_count_ = static_cast<std::uint64_t>(counts[0]);
    face_count_ = static_cast<std::uint64_t>(counts[1]);
    // The shortest vertex is "0 0 0", the shortest face "0", each with a line end that the last may lack.
    const std::uint64_t bytes_left = file_.bytes.size() - lines_.offset() + 1;
    return check_count(file_, lines_.number(), "vertices", vertex_count_, vertex_count_limit, bytes_left, 6)
        && check_count(file_, lines_.number(), "faces", face_count_, face_count_limit, bytes_left, 2);
}

bool OffReader::read_vertices()
{
    mesh_.positions.resize(static_cast<Eigen::Index>(vertex_count_), 3);
    for (std::uint64_t vertex = 0; vertex < vertex_count_; ++vertex) {
        if (!next_line()) {
            report_truncated(file_, "vertex", vertex, vertex_count_);
            return false;
        }
        std::size_t count = 0;
        for (std::string_view word = next_word(line_, '#'); !word.empty(); word = next_word(line_, '#'), ++count) {
            double value = 0;
            read_coordinate(file_, lines_.number(), vertex, word, value);
            if (count < 3) mesh_.positions(static_cast<Eigen::Index>(vertex), static_cast<Eigen::Index>(count)) = value;
        }
        if (count < 3 || (count > 3 && !has_attributes_)) {
            file_.error(2109, file_.at_line(lines_.number()),
                        fmt::format("vertex {} has {} numbers, 3 expected", vertex, count),
                        "the file is damaged or its counts are wrong: export it again");
        }
    }
    return true;
}

bool OffReader::read_faces()
{
    FaceBuilder faces(file_, mesh_);
    for (std::uint64_t face = 0; face < face_count_; ++face) {
        if (!next_line()) {
            report_truncated(file_, "face", face, face_count_);
            return false;
        }
        const std::string_view size_word = next_word(line_, '#');
        const std::optional<std::int64_t> size = parse_integer(size_word);
        if (!size || *size < 0) {
            file_.error(2106, file_.at_line(lines_.number()),
                        fmt::format("face {}: number of corners {} not understood", face, excerpt(size_word)),
                        "the file is damaged or its counts are wrong: export it again");
            return false;
        }
        std::int64_t corner = 0;
        for (; corner < *size; ++corner) {
            const std::string_view word = next_word(line_, '#');
            const std::optional<std::int64_t> index = parse_integer(word);
            if (!index) {
                file_.error(2106, file_.at_line(lines_.number()),
                            word.empty() ? fmt::format("face {} has {} corners, {} declared", face, corner, *size)
                                         : fmt::format("face {}: corner {} not understood", face, excerpt(word)),
                            "the file is damaged: export it again");
                break; // at the latest at the end of the line, whatever size was declared
            }
            faces.add_corner(lines_.number(), *index, vertex_count_);
        }
        if (!check_count(file_, lines_.number(), "face corners", mesh_.faces.indices.size(), corner_count_limit, 0, 0))
            return false;
        // What follows on the line is a colour.
        if (corner == *size)
            faces.end_face(lines_.number());
        else
            faces.abandon_face(lines_.number());
    }
    return true;
}

bool OffReader::check_end()
{
    if (!next_line()) return true;
    file_.error(2110, file_.at_line(lines_.number()), fmt::format("more follows after the last face: {}", excerpt(line_)),
                "the counts in the header are wrong: export the file again");
    return true;
}

} // namespace

bool read_off(const SourceFile& file, MeshFile& mesh) { return OffReader(file, mesh).read(); }

} // namespace pliant
