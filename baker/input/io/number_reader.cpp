#include "input/io/number_reader.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <utility>

namespace pliant {
namespace {

bool is_line_end(char c) { return c == '\n' || c == '\r'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

} // namespace

void NumberReader::skip_blanks(bool over_lines)
{
    const std::string& text = file_.bytes;
    for (; at_ < text.size(); ++at_) {
        const char c = text[at_];
        if (comment_ != '\0' && c == comment_) {
            at_ = std::min(text.find_first_of("\r\n", at_), text.size()) - 1;
        } else if (is_line_end(c)) {
            if (!over_lines) return;
            if (c == '\r' && at_ + 1 < text.size() && text[at_ + 1] == '\n') ++at_;
            ++line_;
        } else if (!is_blank(c)) {
            return;
        }
    }
}

std::string_view NumberReader::word_of_line()
{
    skip_blanks(false);
    const std::size_t begin = at_;
    const std::string& text = file_.bytes;
    while (at_ < text.size() && !is_blank(text[at_]) && !is_line_end(text[at_])) ++at_;
    word_line_ = line_;
    return std::string_view(text).substr(begin, at_ - begin);
}

std::string_view NumberReader::word()
{
    skip_blanks(true);
    return word_of_line();
}

std::string_view NumberReader::peek()
{
    const std::size_t at = at_, line = line_, word_line = word_line_;
    const std::string_view result = word();
    at_ = at;
    line_ = line;
    word_line_ = word_line;
    return result;
}

std::string_view NumberReader::rest_of_line()
{
    const std::string& text = file_.bytes;
    const std::size_t begin = at_;
    at_ = std::min(text.find_first_of("\r\n", at_), text.size());
    const std::string_view rest = std::string_view(text).substr(begin, at_ - begin);
    word_line_ = line_;
    if (at_ < text.size()) {
        at_ += text.compare(at_, 2, "\r\n") == 0 ? 2 : 1;
        ++line_;
    }
    return rest;
}

bool NumberReader::skip_behind(std::string_view text)
{
    const std::size_t found = file_.bytes.find(text, at_);
    if (found == std::string::npos) return false;
    for (; at_ < found; ++at_) {
        const char c = file_.bytes[at_];
        const bool is_pair = c == '\r' && file_.bytes[at_ + 1] == '\n'; // found is behind, so there is a next one
        if (is_line_end(c) && !is_pair) ++line_;
    }
    at_ = found + text.size();
    return true;
}

bool NumberReader::begin(const char* name, std::uint64_t index, std::uint64_t count)
{
    name_ = name;
    index_ = index;
    count_ = count;
    if (layout_ != NumberLayout::lines) return true;
    skip_blanks(true);
    if (at_ < file_.bytes.size()) return true;
    truncated();
    return false;
}

std::string NumberReader::element() const { return count_ == 0 ? std::string(name_) : fmt::format("{} {}", name_, index_); }

void NumberReader::truncated() const
{
    if (count_ == 0)
        report_truncated(file_, name_);
    else
        report_truncated(file_, name_, index_, count_);
}

bool NumberReader::end()
{
    if (layout_ != NumberLayout::lines) return true;
    const std::string_view word = word_of_line();
    if (word.empty()) return true;
    file_.error(2109, where(), fmt::format("{} has more numbers than expected: {}", element(), excerpt(word)),
                "the file is damaged or its counts are wrong: export it again");
    return false;
}

std::string_view NumberReader::number_word()
{
    const bool is_bound = layout_ == NumberLayout::lines;
    const std::string_view result = is_bound ? word_of_line() : word();
    if (!result.empty()) return result;
    if (at_ >= file_.bytes.size())
        truncated();
    else
        file_.error(2109, where(), fmt::format("{} has fewer numbers than expected", element()),
                    "the file is damaged: export it again");
    return {};
}

const char* NumberReader::bytes(std::size_t size)
{
    saw_bytes_ = true;
    if (bytes_left() < size) {
        truncated();
        return nullptr;
    }
    const char* result = file_.bytes.data() + at_;
    at_ += size;
    return result;
}

std::uint64_t NumberReader::bits(const char* bytes, std::size_t size) const
{
    std::uint64_t result = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t place = layout_ == NumberLayout::big_endian ? size - 1 - i : i;
        result |= std::uint64_t(static_cast<unsigned char>(bytes[i])) << 8 * place;
    }
    return result;
}

std::optional<std::int64_t> NumberReader::integer(std::size_t size)
{
    if (!is_text()) {
        const char* data = bytes(size);
        if (!data) return std::nullopt;
        const std::uint64_t value = bits(data, size);
        if (size == 8) return static_cast<std::int64_t>(value);
        if (size == 4) return static_cast<std::int32_t>(static_cast<std::uint32_t>(value));
        return static_cast<std::int8_t>(static_cast<std::uint8_t>(value));
    }
    const std::string_view word = number_word();
    if (word.empty()) return std::nullopt;
    const std::optional<std::int64_t> value = parse_integer(word);
    if (!value)
        file_.error(2106, where(), fmt::format("{}: number {} not understood", element(), excerpt(word)),
                    "the file is damaged or its counts are wrong: export it again");
    return value;
}

std::optional<std::uint64_t> NumberReader::count(std::size_t size, const char* of_what)
{
    const char* const name = std::exchange(name_, of_what);
    const std::uint64_t declared = std::exchange(count_, 0);
    const std::optional<std::int64_t> value = integer(size);
    name_ = name;
    count_ = declared;
    if (!value) return std::nullopt;
    if (*value >= 0) return static_cast<std::uint64_t>(*value);
    file_.error(2102, where(), fmt::format("declares {} {}", *value, of_what), "the file is damaged: export it again");
    return std::nullopt;
}

bool NumberReader::coordinate(std::size_t size, std::size_t vertex, double& value)
{
    if (is_text()) {
        const std::string_view word = number_word();
        if (word.empty()) return false;
        read_coordinate(file_, line(), vertex, word, value);
        return true;
    }
    const char* data = bytes(size);
    if (!data) return false;
    const std::uint64_t raw = bits(data, size);
    if (size == 4) {
        const auto narrow = static_cast<std::uint32_t>(raw);
        float single;
        std::memcpy(&single, &narrow, sizeof single);
        value = single;
    } else {
        std::memcpy(&value, &raw, sizeof value);
    }
    check_coordinate(file_, 0, vertex, value);
    return true;
}

bool NumberReader::skip(std::size_t size) { return is_text() ? !number_word().empty() : bytes(size) != nullptr; }

bool NumberReader::skip_bytes(std::uint64_t count)
{
    if (count <= bytes_left()) return bytes(static_cast<std::size_t>(count)) != nullptr;
    truncated();
    return false;
}

} // namespace pliant
