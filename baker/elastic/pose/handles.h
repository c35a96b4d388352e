// The vertices that a script holds or moves, and their positions at every time of the motion.
#pragma once

#include "elastic/pose/script.h"

namespace pliant {

class Handles {
public:
    // `rest`: as read, in the units and the order of the file. A vertex in several regions belongs to the first line that
    // Names it. Adds errors to `diagnostics` (P2812 to P2817): a vertex that the mesh does not have, a region without
    // vertices, too few vertices to hold the body, none that is free, none that moves.
    Handles(const Script& script, const Positions& rest, DiagnosticList& diagnostics);

    const std::vector<std::uint32_t>& vertices() const { return vertices_; } // ascending
    std::size_t count(std::size_t handle) const { return handles_[handle].count; }
    std::size_t size() const { return handles_.size(); }

    // Positions of vertices(), in input units, when the fraction `time` (0 to 1) of every motion is done. Held vertices keep
    // their coordinates to the bit.
    Positions at(double time) const;

    // Number of steps of ten degrees or a tenth of the diagonal in the longest motion, at least 1.
    int nominal_steps() const;

private:
    struct Handle {
        std::vector<Motion> motions; // in input units
        std::size_t count = 0;
    };
    // What a line of the script took hold of.
    struct Claim {
        std::size_t count = 0, taken = 0; // new vertices, and those that belong to earlier lines
    };
    void add_handle(const Script& script, std::size_t line, const Positions& rest, DiagnosticList& diagnostics);
    void claim(std::size_t vertex, std::size_t line, Claim& claim);
    bool contains(const Region& region, const Eigen::Vector3d& point) const;
    void check_grip(const Script& script, DiagnosticList& diagnostics) const;

    Eigen::Vector3d lower_, extent_;
    double diagonal_;
    std::vector<std::int32_t> owners_; // handle of each vertex of the mesh, -1: free
    std::vector<Handle> handles_;
    std::vector<std::uint32_t> vertices_;
    std::vector<std::uint32_t> handle_of_; // per entry of vertices_
    Positions rest_;                       // of vertices_
};

} // namespace pliant
