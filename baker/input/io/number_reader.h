// Numbers of a file one after the other, as text or as bytes: what the readers of solids share.
#pragma once

#include "input/io/source_file.h"

namespace pliant {

// How numbers stand in a part of a file.
enum class NumberLayout {
    lines,         // text, one element a line
    free,          // text, line ends are blanks
    little_endian, // bytes
    big_endian
};

// Reads words and numbers behind each other. Whatever returns nothing or false has reported an error, except word().
class NumberReader {
public:
    // comment: what begins a comment in text, '\0' for nothing.
    explicit NumberReader(const SourceFile& file, char comment = '\0')
        : file_(file)
        , comment_(comment)
    {
    }

    void set_layout(NumberLayout layout) { layout_ = layout; }
    NumberLayout layout() const { return layout_; }
    bool is_text() const { return layout_ == NumberLayout::lines || layout_ == NumberLayout::free; }

    // For messages; 0 once bytes were read: what they hold are no lines.
    std::size_t line() const { return saw_bytes_ ? 0 : word_line_; }
    std::string where() const { return file_.at_line(line()); }
    std::size_t bytes_left() const { return file_.bytes.size() - at_; }

    // Text, whatever the layout: the next word, over line ends; empty at the end of the file. Separators besides blanks and
    // line ends are none.
    std::string_view word();
    // The next word if it stands on this line; else empty.
    std::string_view word_of_line();
    // What is left of this line, the line end taken too.
    std::string_view rest_of_line();
    // Goes behind the next place where the text stands; false if there is none.
    bool skip_behind(std::string_view text);
    // The same as `word` without taking it.
    std::string_view peek();

    // An element begins and ends. name, index and count are for messages (count 0: there is one of the name). Only in
    // `lines` this moves or checks anything.
    bool begin(const char* name, std::uint64_t index, std::uint64_t count);
    bool end();

    // Sizes in bytes are used for bytes only: 1, 4 or 8 of an integer, 4 or 8 of a real number. Errors: P2101, P2106, P2109.
    std::optional<std::int64_t> integer(std::size_t size);
    // The same, not negative, as a number of something; P2102 else.
    std::optional<std::uint64_t> count(std::size_t size, const char* of_what);
    // False only if the place is lost: a bad value is reported and reading may go on.
    bool coordinate(std::size_t size, std::size_t vertex, double& value);
    // Takes a number, whatever it is.
    bool skip(std::size_t size);
    // Takes bytes, whatever they are.
    bool skip_bytes(std::uint64_t count);

private:
    void skip_blanks(bool over_lines);
    std::string_view number_word();
    std::string element() const;
    void truncated() const;
    const char* bytes(std::size_t size);
    std::uint64_t bits(const char* bytes, std::size_t size) const;

    const SourceFile& file_;
    char comment_;
    NumberLayout layout_ = NumberLayout::lines;
    std::size_t at_ = 0;
    std::size_t line_ = 1;      // at at_
    std::size_t word_line_ = 1; // of the word taken last
    bool saw_bytes_ = false;
    const char* name_ = "number";
    std::uint64_t index_ = 0, count_ = 0;
};

} // namespace pliant
