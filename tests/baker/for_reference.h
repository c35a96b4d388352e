// What tests of whole bakes share: assets left for the script that holds them against the second implementation.
#pragma once

#include "bake/bake.h"
#include "input/io/write_file.h"
#include "output/asset/runtime_blender.h"

#include <cmath>
#include <fmt/core.h>
#include <string>
#include <vector>

// Relative distance of positions as the runtime writes them.
inline double relative(const std::vector<float>& a, const pliant::Positions& b)
{
    double difference = 0, size = 0;
    for (Eigen::Index v = 0; v < b.rows(); ++v) {
        difference += (Eigen::Map<const Eigen::RowVector3f>(a.data() + 3 * v).cast<double>() - b.row(v)).squaredNorm();
        size += b.row(v).squaredNorm();
    }
    return std::sqrt(difference / size);
}

// Leaves NAME.pliant and the runtime's answers in NAME.txt for compare_with_reference.py.
inline void write_for_reference(const std::string& name, const pliant::BakedAsset& baked, pliant::RuntimeBlender& blender,
                                const std::vector<std::vector<float>>& weights)
{
    pliant::write_file_atomically(name + ".pliant",
                                  { reinterpret_cast<const char*>(baked.bytes.data()), baked.bytes.size() });
    pliant_solver_desc desc = pliant_solver_desc_default();
    desc.tolerance = 1e-5f;
    blender.configure(desc);
    std::string text;
    for (const std::vector<float>& w : weights) {
        for (float value : w) text += std::to_string(value) + " ";
        for (float value : blender.positions(blender.solve(w, false))) text += fmt::format("{:.9g} ", value);
        text += "\n";
    }
    pliant::write_file_atomically(name + ".txt", text);
}
