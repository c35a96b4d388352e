// The page that `pliant report` writes: what people want to know of a baked asset, in one HTML file that needs nothing else.
#pragma once

#include "output/page/page_data.h"

#include <string>

namespace pliant {

// HTML. The same data give the same text.
std::string write_page(const PageData& data);

} // namespace pliant
