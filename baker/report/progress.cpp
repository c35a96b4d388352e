#include "report/progress.h"

namespace pliant {

void Progress::update(const std::string&, double, const std::string&) {}
void Progress::warn(int, const std::string&, const std::string&) {}

} // namespace pliant
