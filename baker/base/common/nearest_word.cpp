#include "base/common/nearest_word.h"

#include <algorithm>

namespace pliant {
namespace {

std::string plain(std::string word)
{
    for (char& c : word) {
        if (c == '-') c = '_';
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return word;
}

// Letters to change, insert, leave out or swap with their neighbour (optimal string alignment).
std::size_t edit_distance(const std::string& a, const std::string& b)
{
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t k = 0; k <= b.size(); ++k) d[0][k] = k;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t k = 1; k <= b.size(); ++k) {
            d[i][k] = std::min({ d[i - 1][k] + 1, d[i][k - 1] + 1, d[i - 1][k - 1] + (a[i - 1] == b[k - 1] ? 0u : 1u) });
            if (i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1])
                d[i][k] = std::min(d[i][k], d[i - 2][k - 2] + 1);
        }
    return d[a.size()][b.size()];
}

// The shortest word that begins like this one; of one or two letters none, as most words would.
std::string completed_word(const std::string& word, const std::vector<std::string>& words)
{
    std::string found;
    for (const std::string& candidate : words)
        if (word.size() > 2 && plain(candidate).rfind(plain(word), 0) == 0
            && (found.empty() || candidate.size() < found.size()))
            found = candidate;
    return found;
}

} // namespace

std::string nearest_word(const std::string& word, const std::vector<std::string>& words)
{
    constexpr std::size_t longest = 64; // no key of ours; bounds the table
    if (word.size() > longest) return {};
    std::string nearest;
    std::size_t least = longest;
    for (const std::string& candidate : words) {
        if (candidate.size() > 2 * longest) continue;
        const std::size_t distance = edit_distance(plain(word), plain(candidate));
        if (distance >= least || 3 * distance > std::max(word.size(), candidate.size())) continue;
        least = distance;
        nearest = candidate;
    }
    return nearest.empty() ? completed_word(word, words) : nearest;
}

} // namespace pliant
