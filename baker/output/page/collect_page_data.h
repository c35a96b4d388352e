// What a page shows of an asset, drawn and counted through the C runtime.
#pragma once

#include "output/asset/runtime_blender.h"
#include "output/page/page_data.h"
#include "output/page/report_file.h"

#include <string>

namespace pliant {

// `name`: of the asset's file, as it is to be shown. `report`: of its bake, or null.
// Cost: some 40 pictures, and for a basis in single precision a reconstruction a column; seconds for 20,000 vertices.
PageData collect_page_data(RuntimeBlender& blender, const std::string& name, const ReportFile* report,
                           const ViewOptions& view);

} // namespace pliant
