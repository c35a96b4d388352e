#include "input/io/encode_msh.h"

#include <fmt/format.h>
#include <iterator>

namespace pliant {

std::string encode_msh(const Positions& positions, const std::vector<Tetrahedron>& tets)
{
    std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", positions.rows());
    const auto out = std::back_inserter(text);
    // Without a format fmt writes the shortest digits that give the same double back.
    for (Eigen::Index v = 0; v < positions.rows(); ++v)
        fmt::format_to(out, "{} {} {} {}\n", v + 1, positions(v, 0), positions(v, 1), positions(v, 2));
    fmt::format_to(out, "$EndNodes\n$Elements\n{}\n", tets.size());
    // Type 4 with two tags, of its physical group and of its part of the geometry: readers of 2.2 expect them.
    for (std::size_t t = 0; t < tets.size(); ++t)
        fmt::format_to(out, "{} 4 2 0 1 {} {} {} {}\n", t + 1, tets[t][0] + 1, tets[t][1] + 1, tets[t][2] + 1,
                       tets[t][3] + 1);
    return text + "$EndElements\n";
}

} // namespace pliant
