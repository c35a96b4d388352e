// Tetrahedra as they arrive, with what every format of solids asks of them.
#pragma once

#include "input/io/source_file.h"

#include <array>
#include <map>

namespace pliant {

class TetBuilder {
public:
    // first: the number of the first vertex in this file, 0 or 1, for messages.
    TetBuilder(const SourceFile& file, MeshFile& mesh, std::int64_t first = 0)
        : file_(file)
        , mesh_(mesh)
        , first_(first)
    {
    }

    void set_first(std::int64_t first) { first_ = first; }

    // Appends a tetrahedron. Corners as the file counts; out of range is P2103. line 0: a binary file.
    void add(std::size_t line, const std::array<std::int64_t, 4>& corners);
    // Counts an element that is left out, by the name of many: "triangles".
    void skip(const char* kind) { ++skipped_[kind]; }
    void skip(const char* kind, std::uint64_t count) { skipped_[kind] += count; }
    // P2114 for an element that cannot be left out.
    void refuse(const std::string& where, std::uint64_t element, const std::string& kind);
    // At the end of the file. P2115 what was left out, P2116 no tetrahedra.
    bool finish();
    std::size_t count() const { return mesh_.tets.size(); }

private:
    const SourceFile& file_;
    MeshFile& mesh_;
    std::int64_t first_;
    std::map<std::string, std::uint64_t> skipped_; // sorted: messages do not depend on the order of a file
};

// The readers of solids, as those in source_file.h.
bool read_msh(const SourceFile& file, MeshFile& mesh);
bool read_medit(const SourceFile& file, MeshFile& mesh);
bool read_vega(const SourceFile& file, MeshFile& mesh);
bool read_vtk(const SourceFile& file, MeshFile& mesh);

} // namespace pliant
