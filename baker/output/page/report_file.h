// The report of a bake (`pliant bake --report`) read back, for a page.
#pragma once

#include "base/common/diagnostics.h"
#include "output/page/page_data.h"

#include <string>
#include <vector>

namespace pliant {

struct ReportFile {
    std::string asset; // as the report names it: relative to its own folder, or absolute
    std::vector<PageStage> stages;
    std::vector<Diagnostic> warnings;
};

// Throws Failure (bad_input) naming `path`: P5301 not JSON, P5302 a member that is missing or of the wrong type, P5303 no
// asset named.
ReportFile parse_report(const std::string& text, const std::string& path);

// The same bake? Throws Failure (bad_input, P5304) naming `path` if the report holds another certificate than the asset
// does.
void check_same_bake(const std::string& report, const std::string& certificate, const std::string& path,
                     const std::string& asset);

// Whether a file's first bytes are those of JSON with an object.
bool looks_like_json(const std::string& bytes);

} // namespace pliant
