#include "input/io/ply_header.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace pliant::ply {
namespace {

struct TypeName {
    std::string_view name;
    Type type;
};
constexpr std::array<TypeName, 16> type_names { { { "char", Type::int8 },
                                                  { "int8", Type::int8 },
                                                  { "uchar", Type::uint8 },
                                                  { "uint8", Type::uint8 },
                                                  { "short", Type::int16 },
                                                  { "int16", Type::int16 },
                                                  { "ushort", Type::uint16 },
                                                  { "uint16", Type::uint16 },
                                                  { "int", Type::int32 },
                                                  { "int32", Type::int32 },
                                                  { "uint", Type::uint32 },
                                                  { "uint32", Type::uint32 },
                                                  { "float", Type::float32 },
                                                  { "float32", Type::float32 },
                                                  { "double", Type::float64 },
                                                  { "float64", Type::float64 } } };

class HeaderReader {
public:
    explicit HeaderReader(const SourceFile& file)
        : file_(file)
        , lines_(file.bytes)
    {
    }

    std::optional<Header> read();

private:
    bool read_line();
    bool read_format(std::string_view words);
    bool read_element(std::string_view words);
    bool read_property(std::string_view words);
    std::optional<Type> read_type(std::string_view word) const;
    bool check_elements() const;
    bool not_understood() const;

    const SourceFile& file_;
    LineReader lines_;
    Header header_;
    bool has_format_ = false;
};

std::optional<Header> HeaderReader::read()
{
    lines_.next(); // "ply", as the caller has seen
    const bool has_crlf = std::string_view(file_.bytes).substr(lines_.line().size(), 2) == "\r\n";
    while (lines_.next()) {
        if (lines_.line() != "end_header") {
            if (!read_line()) return std::nullopt;
            continue;
        }
        // A header with plain line ends may be followed by a data byte that looks like part of one.
        const std::size_t end = static_cast<std::size_t>(lines_.line().data() - file_.bytes.data()) + lines_.line().size();
        const bool ends_crlf = has_crlf && std::string_view(file_.bytes).substr(end, 2) == "\r\n";
        header_.body = std::min(end + (ends_crlf ? 2 : 1), file_.bytes.size());
        header_.line_count = lines_.number();
        if (!check_elements()) return std::nullopt;
        return header_;
    }
    report_truncated(file_, "the header");
    return std::nullopt;
}

bool HeaderReader::not_understood() const
{
    file_.error(2102, file_.at_line(lines_.number()), fmt::format("header not understood: {}", excerpt(lines_.line())),
                "the file is damaged: export it again");
    return false;
}

// Files of scanners have some dozens; looking a name up takes a step for each.
constexpr std::size_t header_line_limit = 10000;

bool HeaderReader::read_line()
{
    if (lines_.number() > header_line_limit) {
        file_.error(2102, file_.at_line(lines_.number()),
                    fmt::format("the header has more than {} lines", header_line_limit),
                    "export the file without properties that nobody reads");
        return false;
    }
    std::string_view words = lines_.line();
    const std::string_view keyword = next_word(words);
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") return true;
    if (keyword == "format") return read_format(words);
    if (keyword == "element") return read_element(words);
    if (keyword == "property") return read_property(words);
    return not_understood();
}

bool HeaderReader::read_format(std::string_view words)
{
    const std::string_view encoding = next_word(words);
    const std::string_view version = next_word(words);
    if (encoding == "ascii")
        header_.encoding = Encoding::ascii;
    else if (encoding == "binary_little_endian")
        header_.encoding = Encoding::little_endian;
    else if (encoding == "binary_big_endian")
        header_.encoding = Encoding::big_endian;
    else
        return not_understood();
    if (has_format_ || version != "1.0" || !next_word(words).empty()) return not_understood();
    has_format_ = true;
    return true;
}

bool HeaderReader::read_element(std::string_view words)
{
    Element element;
    element.name = next_word(words);
    const std::optional<std::int64_t> count = parse_integer(next_word(words));
    if (element.name.empty() || !count || *count < 0 || !next_word(words).empty() || header_.find(element.name)) {
        return not_understood();
    }
    element.count = static_cast<std::uint64_t>(*count);
    element.line = lines_.number();
    header_.elements.push_back(std::move(element));
    return true;
}

std::optional<Type> HeaderReader::read_type(std::string_view word) const
{
    for (const TypeName& known : type_names) {
        if (known.name == word) return known.type;
    }
    return std::nullopt;
}

bool HeaderReader::read_property(std::string_view words)
{
    if (header_.elements.empty()) return not_understood();
    Property property;
    std::string_view word = next_word(words);
    if (word == "list") {
        property.count_type = read_type(next_word(words));
        if (!property.count_type || is_real(*property.count_type)) return not_understood();
        word = next_word(words);
    }
    const std::optional<Type> type = read_type(word);
    property.name = next_word(words);
    if (!type || property.name.empty() || !next_word(words).empty()) return not_understood();
    if (header_.elements.back().find(property.name)) return not_understood();
    property.type = *type;
    header_.elements.back().properties.push_back(std::move(property));
    return true;
}

std::uint64_t limit_of(const Element& element)
{
    if (element.name == "vertex") return vertex_count_limit;
    return element.name == "face" ? face_count_limit : UINT64_MAX;
}

// What we need is there, and what is declared fits into the bytes that follow.
bool HeaderReader::check_elements() const
{
    if (!has_format_) {
        file_.error(2102, file_.path, "the header has no format line", "the file is damaged: export it again");
        return false;
    }
    const Element* vertex = header_.find("vertex");
    for (const char* axis : { "x", "y", "z" }) {
        const Property* property = vertex ? vertex->find(axis) : nullptr;
        if (property && !property->count_type) continue;
        file_.error(2102, file_.path, fmt::format("the header has no vertex coordinate {}", axis),
                    "export vertices with the properties x, y and z");
        return false;
    }
    if (!header_.find("face") && header_.find("tristrips")) {
        file_.error(2111, file_.path, "triangle strips are not read", "export faces");
        return false;
    }
    const bool is_text = header_.encoding == Encoding::ascii;
    // In text the line end of the last element may be missing, so one byte counts that is not there.
    const std::uint64_t bytes_left = file_.bytes.size() - header_.body + (is_text ? 1 : 0);
    for (const Element& element : header_.elements) {
        std::uint64_t minimal_size = 0;
        for (const Property& property : element.properties) {
            minimal_size += is_text ? 2 : size_of(property.count_type.value_or(property.type));
        }
        const std::string what = element.name == "vertex" ? "vertices" : element.name + "s";
        if (!check_count(file_, element.line, what, element.count, limit_of(element), bytes_left, minimal_size))
            return false;
    }
    return true;
}

} // namespace

std::size_t size_of(Type type)
{
    switch (type) {
    case Type::int8:
    case Type::uint8: return 1;
    case Type::int16:
    case Type::uint16: return 2;
    case Type::int32:
    case Type::uint32:
    case Type::float32: return 4;
    case Type::float64: return 8;
    }
    return 8;
}

std::optional<Header> read_header(const SourceFile& file) { return HeaderReader(file).read(); }

} // namespace pliant::ply
