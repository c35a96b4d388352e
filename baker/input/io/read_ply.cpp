// Polygon File Format (Stanford): ASCII, binary little-endian, binary big-endian.
#include "input/io/ply_header.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fmt/format.h>
#include <type_traits>

namespace pliant {
namespace {

using ply::Element;
using ply::Encoding;
using ply::Header;
using ply::Property;
using ply::Type;

// Where in the body we are, for messages.
struct Position {
    const Element* element = nullptr;
    std::uint64_t index = 0;
};

// One line an element. Both sources offer the same functions; false or nothing means that an error was reported.
class TextSource {
public:
    TextSource(const SourceFile& file, const Header& header)
        : file_(file)
        , lines_(std::string_view(file.bytes).substr(header.body))
        , first_line_(header.line_count)
    {
    }

    std::size_t line() const { return first_line_ + lines_.number(); }

    bool begin(const Position& at)
    {
        at_ = at;
        if (next_line()) return true;
        report_truncated(file_, at.element->name, at.index, at.element->count);
        return false;
    }

    bool coordinate(Type, double& value)
    {
        const std::string_view word = next();
        return !word.empty() && read_coordinate(file_, line(), at_.index, word, value);
    }

    std::optional<std::int64_t> integer(Type)
    {
        const std::string_view word = next();
        if (word.empty()) return std::nullopt;
        const std::optional<std::int64_t> value = parse_integer(word);
        if (!value) {
            file_.error(2106, file_.at_line(line()),
                        fmt::format("{} {}: number {} not understood", at_.element->name, at_.index, excerpt(word)),
                        "the file is damaged: export it again");
        }
        return value;
    }

    bool skip(Type) { return !next().empty(); }

    void end()
    {
        if (next_word(rest_).empty()) return;
        file_.error(2109, file_.at_line(line()),
                    fmt::format("{} {} has more numbers than the header declares", at_.element->name, at_.index),
                    "the file is damaged or its header is wrong: export it again");
    }

    // After a bad value: the next line starts a new element.
    bool can_go_on() const { return true; }
    void lose_place() {}

    void finish()
    {
        if (!next_line()) return;
        file_.error(2110, file_.at_line(line()), fmt::format("more follows after the last element: {}", excerpt(rest_)),
                    "the counts in the header are wrong: export the file again");
    }

private:
    bool next_line()
    {
        while (lines_.next()) {
            rest_ = lines_.line();
            std::string_view words = rest_;
            if (!next_word(words).empty()) return true;
        }
        return false;
    }

    std::string_view next()
    {
        const std::string_view word = next_word(rest_);
        if (word.empty()) {
            file_.error(2109, file_.at_line(line()),
                        fmt::format("{} {} has fewer numbers than the header declares", at_.element->name, at_.index),
                        "the file is damaged or its header is wrong: export it again");
        }
        return word;
    }

    const SourceFile& file_;
    LineReader lines_;
    std::size_t first_line_;
    std::string_view rest_;
    Position at_;
};

class BinarySource {
public:
    BinarySource(const SourceFile& file, const Header& header)
        : file_(file)
        , rest_(std::string_view(file.bytes).substr(header.body))
        , is_big_endian_(header.encoding == Encoding::big_endian)
    {
    }

    std::size_t line() const { return 0; }

    bool begin(const Position& at)
    {
        at_ = at;
        return true;
    }

    bool coordinate(Type type, double& value)
    {
        const std::optional<double> number = next(type);
        if (!number) return false;
        value = *number;
        check_coordinate(file_, 0, at_.index, value);
        return true;
    }

    // Every integer of 32 bits is exactly a double.
    std::optional<std::int64_t> integer(Type type)
    {
        const std::optional<double> number = next(type);
        if (!number) return std::nullopt;
        return static_cast<std::int64_t>(*number);
    }

    bool skip(Type type) { return next(type).has_value(); }
    void end() {}
    // After a bad list length nobody knows where the next element begins.
    bool can_go_on() const { return !is_lost_; }
    void lose_place() { is_lost_ = true; }

    void finish()
    {
        if (rest_.empty()) return;
        file_.error(2110, file_.path, fmt::format("{} bytes follow after the last element", rest_.size()),
                    "the counts in the header are wrong: export the file again");
    }

private:
    template <class T> T take()
    {
        std::array<unsigned char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        // Shifts give the value on machines of either byte order.
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < sizeof(T); ++i) {
            const std::size_t shift = 8 * (is_big_endian_ ? sizeof(T) - 1 - i : i);
            bits |= std::uint64_t(bytes[i]) << shift;
        }
        using Bits = std::conditional_t<sizeof(T) == 8, std::uint64_t,
                                        std::conditional_t<sizeof(T) == 4, std::uint32_t,
                                                           std::conditional_t<sizeof(T) == 2, std::uint16_t, std::uint8_t>>>;
        const auto narrow = static_cast<Bits>(bits);
        T value;
        std::memcpy(&value, &narrow, sizeof(T));
        return value;
    }

    std::optional<double> next(Type type)
    {
        if (rest_.size() < ply::size_of(type)) {
            if (!is_lost_) report_truncated(file_, at_.element->name, at_.index, at_.element->count);
            is_lost_ = true;
            return std::nullopt;
        }
        switch (type) {
        case Type::int8: return take<std::int8_t>();
        case Type::uint8: return take<std::uint8_t>();
        case Type::int16: return take<std::int16_t>();
        case Type::uint16: return take<std::uint16_t>();
        case Type::int32: return take<std::int32_t>();
        case Type::uint32: return take<std::uint32_t>();
        case Type::float32: return take<float>();
        case Type::float64: return take<double>();
        }
        return std::nullopt;
    }

    const SourceFile& file_;
    std::string_view rest_;
    bool is_big_endian_;
    bool is_lost_ = false;
    Position at_;
};

template <class Source> class BodyReader {
public:
    BodyReader(const SourceFile& file, const Header& header, MeshFile& mesh)
        : file_(file)
        , header_(header)
        , mesh_(mesh)
        , faces_(file, mesh)
        , source_(file, header)
    {
    }

    bool read();

private:
    bool read_element(const Element& element);
    bool read_property(const Element& element, const Property& property, std::uint64_t index);
    bool read_corners(const Property& property);
    bool skip_list(const Property& property);
    std::optional<std::int64_t> read_list_size(const Property& property);

    const SourceFile& file_;
    const Header& header_;
    MeshFile& mesh_;
    FaceBuilder faces_;
    Source source_;
};

bool is_corner_list(const Property& property)
{
    return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

template <class Source> bool BodyReader<Source>::read()
{
    const Element* face = header_.find("face");
    if (face && face->count != 0) {
        const auto& properties = face->properties;
        const auto corners = std::find_if(properties.begin(), properties.end(), is_corner_list);
        if (corners == properties.end() || std::count_if(properties.begin(), properties.end(), is_corner_list) != 1) {
            file_.error(2102, file_.at_line(face->line), "faces have no list vertex_indices (or have it twice)",
                        "export faces as lists of vertex indices");
            return false;
        }
        if (ply::is_real(corners->type)) {
            file_.error(2111, file_.at_line(face->line), "vertex indices are real numbers", "export them as integers");
            return false;
        }
    }
    mesh_.positions.setZero(static_cast<Eigen::Index>(header_.find("vertex")->count), 3);
    for (const Element& element : header_.elements) {
        if (!element.properties.empty() && !read_element(element)) return false;
    }
    source_.finish();
    return true;
}

template <class Source> bool BodyReader<Source>::read_element(const Element& element)
{
    for (std::uint64_t index = 0; index < element.count; ++index) {
        if (!source_.begin({ &element, index })) return false;
        bool is_good = true;
        for (const Property& property : element.properties) {
            is_good = read_property(element, property, index);
            if (!is_good) break;
        }
        if (!is_good && !source_.can_go_on()) return false;
        if (is_good) source_.end();
        if (element.name != "face") continue;
        if (is_good)
            faces_.end_face(source_.line());
        else
            faces_.abandon_face(source_.line());
        if (!check_count(file_, source_.line(), "face corners", mesh_.faces.indices.size(), corner_count_limit, 0, 0))
            return false;
    }
    return true;
}

template <class Source>
bool BodyReader<Source>::read_property(const Element& element, const Property& property, std::uint64_t index)
{
    if (element.name == "face" && is_corner_list(property)) return read_corners(property);
    if (property.count_type) return skip_list(property);
    const bool is_axis = property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
    if (element.name != "vertex" || !is_axis) return source_.skip(property.type);
    return source_.coordinate(property.type, mesh_.positions(static_cast<Eigen::Index>(index), property.name[0] - 'x'));
}

template <class Source> std::optional<std::int64_t> BodyReader<Source>::read_list_size(const Property& property)
{
    const std::optional<std::int64_t> size = source_.integer(*property.count_type);
    if (!size || *size >= 0) return size;
    file_.error(2108, file_.at_line(source_.line()), fmt::format("list {} has the length {}", property.name, *size),
                "the file is damaged: export it again");
    source_.lose_place();
    return std::nullopt;
}

// A declared size is only believed as far as numbers arrive: the loops end with the line or with the file.
template <class Source> bool BodyReader<Source>::read_corners(const Property& property)
{
    const std::optional<std::int64_t> size = read_list_size(property);
    if (!size) return false;
    const auto vertex_count = static_cast<std::uint64_t>(mesh_.positions.rows());
    for (std::int64_t corner = 0; corner < *size; ++corner) {
        const std::optional<std::int64_t> index = source_.integer(property.type);
        if (!index) return false;
        faces_.add_corner(source_.line(), *index, vertex_count);
    }
    return true;
}

template <class Source> bool BodyReader<Source>::skip_list(const Property& property)
{
    const std::optional<std::int64_t> size = read_list_size(property);
    if (!size) return false;
    for (std::int64_t i = 0; i < *size; ++i) {
        if (!source_.skip(property.type)) return false;
    }
    return true;
}

} // namespace

bool read_ply(const SourceFile& file, MeshFile& mesh)
{
    const std::optional<Header> header = ply::read_header(file);
    if (!header) return false;
    if (header->encoding == Encoding::ascii) return BodyReader<TextSource>(file, *header, mesh).read();
    return BodyReader<BinarySource>(file, *header, mesh).read();
}

} // namespace pliant
