// Mutates texts by their words and lines: meshes as text, JSON. A word becomes a special number or another word of the text,
// lines and stretches of bytes come twice or go. Half of the mutations are libFuzzer's own, which binary formats need.
#include "mutate_text.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <random>

namespace {

using Random = std::minstd_rand;

constexpr const char* special[] = { "0",
                                    "1",
                                    "-1",
                                    "2",
                                    "3",
                                    "4",
                                    "-2147483648",
                                    "2147483648",
                                    "4294967295",
                                    "4294967296",
                                    "1000000000",
                                    "1e9",
                                    "nan",
                                    "inf",
                                    "-inf",
                                    "9223372036854775807",
                                    "-9223372036854775808",
                                    "1e308",
                                    "1e-400",
                                    "1e400",
                                    "0.5",
                                    "",
                                    "0x10",
                                    "1.",
                                    "18446744073709551615",
                                    "67108864",
                                    "00",
                                    "+1",
                                    "1e+",
                                    "--1",
                                    "null",
                                    "true",
                                    "[]",
                                    "{}",
                                    "\"\"",
                                    "-0" };

std::size_t below(Random& random, std::size_t limit) { return random() % limit; }

struct Span {
    std::size_t begin, end;
};

bool is_blank(char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }
bool is_mark(char c) { return std::strchr("/,:{}[]\"", c) != nullptr; }

// The word at or behind a random place: between blanks and marks.
Span word_of(const std::string& text, Random& random)
{
    const auto is_cut = [&](std::size_t i) { return is_blank(text[i]) || is_mark(text[i]); };
    std::size_t begin = below(random, text.size());
    while (begin > 0 && !is_cut(begin - 1)) --begin;
    while (begin < text.size() && is_cut(begin)) ++begin;
    std::size_t end = begin;
    while (end < text.size() && !is_cut(end) && end - begin < 256) ++end;
    return { begin, end };
}

Span line_of(const std::string& text, Random& random)
{
    const std::size_t at = below(random, text.size());
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1), behind = text.find('\n', at);
    return { before == std::string::npos ? 0 : before + 1, behind == std::string::npos ? text.size() : behind + 1 };
}

void mutate(std::string& text, Random& random)
{
    const Span word = word_of(text, random), other = word_of(text, random), line = line_of(text, random);
    switch (below(random, 7)) {
    case 0:
    case 1: text.replace(word.begin, word.end - word.begin, special[below(random, std::size(special))]); break;
    case 2: text.replace(word.begin, word.end - word.begin, text.substr(other.begin, other.end - other.begin)); break;
    case 3: text.erase(line.begin, line.end - line.begin); break;
    case 4: text.insert(line_of(text, random).begin, text.substr(line.begin, line.end - line.begin)); break;
    case 5: text.erase(word.begin, word.end - word.begin); break;
    default: text.insert(word.begin, text.substr(other.begin, other.end - other.begin) + " "); break;
    }
}

} // namespace

std::size_t mutate_text(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed)
{
    Random random(seed);
    if (size == 0 || seed % 2 == 0) return LLVMFuzzerMutate(data, size, max_size);
    std::string text(data, data + size);
    for (std::size_t left = 1 + below(random, 3); left > 0 && !text.empty(); --left) mutate(text, random);
    const std::size_t made = std::min(text.size(), max_size);
    std::memcpy(data, text.data(), made);
    return made;
}
