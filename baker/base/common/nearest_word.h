// What somebody who misspelt a word has meant.
#pragma once

#include <string>
#include <vector>

namespace pliant {

// Of `words` the one with the fewest letters to change, insert, leave out or swap (the first of several), or where more than
// a third of the letters would change the shortest that begins with `word`; else empty, as something else was meant. Upper
// and lower case, '-' and '_' count as the same.
std::string nearest_word(const std::string& word, const std::vector<std::string>& words);

} // namespace pliant
