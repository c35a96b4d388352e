// Which vertices a script takes hold of, and where they are at every moment of the motion.
#pragma once

#include "elastic/pose/script.h"

namespace pliant {

class Handles {
public:
    // `rest`: as read, in the units and the order of the file. A vertex in several regions belongs to the first line that names it.
    // Errors are added to `findings`: a region without vertices, a vertex that is not there, too few to hold the body.
    Handles(const Script& script, const Positions& rest, FindingList& findings);

    const std::vector<std::uint32_t>& vertices() const { return vertices_; } // ascending
    std::size_t count(std::size_t handle) const { return handles_[handle].count; }
    std::size_t size() const { return handles_.size(); }

    // Places of vertices(), in input units, when the part `time` (0 to 1) of every motion is done. Held ones keep their exact
    // coordinates.
    Positions at(double time) const;

    // How many steps of ten degrees or a tenth of the diagonal the longest motion has.
    int nominal_steps() const;

private:
    struct Handle {
        std::vector<Motion> motions; // in input units
        std::size_t count = 0;
    };
    void claim(const Script& script, std::size_t line, const Positions& rest, FindingList& findings);
    void check_grip(const Script& script, FindingList& findings) const;

    Eigen::Vector3d lower_, extent_;
    double diagonal_;
    std::vector<std::int32_t> owners_; // per vertex of the mesh a handle or -1; while the regions are looked up
    std::vector<Handle> handles_;
    std::vector<std::uint32_t> vertices_;
    std::vector<std::uint32_t> handle_of_; // per entry of vertices_
    Positions rest_;                       // of vertices_
};

} // namespace pliant
