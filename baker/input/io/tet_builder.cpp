#include "input/io/tet_builder.h"

#include <algorithm>
#include <fmt/format.h>

namespace pliant {

void TetBuilder::add(std::size_t line, const std::array<std::int64_t, 4>& corners)
{
    Tetrahedron tet {};
    const std::int64_t vertex_count = mesh_.positions.rows();
    for (std::size_t i = 0; i < 4; ++i) {
        const bool is_inside = corners[i] >= first_ && corners[i] - first_ < vertex_count;
        if (is_inside) {
            tet[i] = static_cast<std::uint32_t>(corners[i] - first_);
            continue;
        }
        // A file with an error is never used, so it does not matter what stands in for a bad index.
        file_.error(2103, file_.at_line(line),
                    fmt::format("tetrahedron {} uses vertex {}, the file has {}{}", count(), corners[i], vertex_count,
                                first_ == 1 ? " (counted from 1)" : ""),
                    "vertices are missing or the tetrahedron is wrong: export the file again");
    }
    mesh_.tets.push_back(tet);
    if (line != 0) mesh_.tet_lines.push_back(static_cast<std::uint32_t>(std::min<std::size_t>(line, UINT32_MAX)));
}

void TetBuilder::refuse(const std::string& where, std::uint64_t element, const std::string& kind)
{
    file_.error(2114, where, fmt::format("element {} is {}", element, kind),
                "only tetrahedra of four corners are supported: mesh the body with them alone");
}

bool TetBuilder::finish()
{
    std::string list;
    std::uint64_t total = 0;
    for (const auto& [kind, count] : skipped_) {
        if (count == 0) continue;
        list += fmt::format("{}{} {}", list.empty() ? "" : ", ", count, kind);
        total += count;
    }
    if (mesh_.positions.rows() == 0) return true; // P2005 says it better
    if (mesh_.tets.empty()) {
        file_.error(
            2116, file_.path, fmt::format("has no tetrahedra{}{}", total == 0 ? "" : ", only ", list),
            "only tetrahedra are read from this format: fill the surface with them, or export it as .obj, .ply or .off");
        return false;
    }
    if (total != 0)
        file_.diagnostics->add(warning_at(2115, file_.path, fmt::format("{} ignored: only tetrahedra are used", list),
                                          "harmless: they usually mark the boundary"));
    return true;
}

} // namespace pliant
