// Small solids in every format and layout, written independently of the code under test.
#pragma once

#include "base/mesh/pose_set.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

namespace pliant_test {

struct Sample {
    std::string name; // of the layout, for messages
    std::string file; // with its extension
    std::string bytes;
};

// A file while it is written: text, or bytes in either order. The tests run on little-endian machines.
class SolidWriter {
public:
    enum class Kind { text, little_endian, big_endian };
    explicit SolidWriter(Kind kind)
        : kind_(kind)
    {
    }

    SolidWriter& text(const std::string& text)
    {
        out += text;
        return *this;
    }
    SolidWriter& integer(std::int64_t value, std::size_t size)
    {
        return kind_ == Kind::text ? text(std::to_string(value) + " ") : raw(&value, size);
    }
    SolidWriter& real(double value)
    {
        char buffer[64];
        std::snprintf(buffer, sizeof buffer, "%.17g ", value);
        return kind_ == Kind::text ? text(buffer) : raw(&value, 8);
    }
    // Only a text has lines.
    SolidWriter& end_line() { return kind_ == Kind::text ? text("\n") : *this; }

    std::string out;

private:
    SolidWriter& raw(const void* value, std::size_t size)
    {
        std::string bytes(static_cast<const char*>(value), size);
        if (kind_ == Kind::big_endian) std::reverse(bytes.begin(), bytes.end());
        return text(bytes);
    }
    Kind kind_;
};

struct SampleSolid {
    pliant::Positions positions;
    std::vector<pliant::Tetrahedron> tets;
    std::vector<pliant::Triangle> triangles; // that readers leave out
};

// Three tetrahedra around an edge, with coordinates that show every rounding.
inline SampleSolid sample_solid()
{
    SampleSolid solid;
    solid.positions.resize(6, 3);
    solid.positions << 0.1, 1e-300, 1.0 / 3, 1, 0.7, -0.0, -1e-7, 1, 123456.789012, 0, -1, 5, 9.25, 2, 2, 0.3, -5e17, 1;
    solid.tets = { { 0, 1, 2, 3 }, { 0, 1, 3, 4 }, { 5, 1, 4, 0 } };
    solid.triangles = { { 0, 1, 2 }, { 2, 3, 0 } };
    return solid;
}

inline std::string make_msh2(const SampleSolid& solid, SolidWriter::Kind kind)
{
    const bool is_text = kind == SolidWriter::Kind::text;
    SolidWriter w(kind);
    w.text("$MeshFormat\n2.2 " + std::string(is_text ? "0" : "1") + " 8\n");
    if (!is_text) w.integer(1, 4).text("\n");
    w.text("$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"$a body\"\n$EndPhysicalNames\n$Nodes\n");
    w.text(std::to_string(solid.positions.rows()) + "\n");
    for (Eigen::Index v = 0; v < solid.positions.rows(); ++v) { // tags with gaps, from 10
        w.integer(10 + 3 * v, 4);
        for (int axis = 0; axis < 3; ++axis) w.real(solid.positions(v, axis));
        w.end_line();
    }
    w.text(is_text ? "" : "\n").text("$EndNodes\n$Elements\n");
    w.text(std::to_string(solid.tets.size() + solid.triangles.size()) + "\n");
    std::int64_t tag = 1;
    const auto element = [&](std::int64_t type, const auto& corners) {
        if (is_text)
            w.integer(tag, 4).integer(type, 4).integer(2, 4);
        else
            w.integer(tag, 4);
        w.integer(7, 4).integer(8, 4);
        for (const std::uint32_t corner : corners) w.integer(10 + 3 * std::int64_t(corner), 4);
        w.end_line();
        ++tag;
    };
    const auto head = [&](std::int64_t type, std::size_t count) {
        if (!is_text) w.integer(type, 4).integer(std::int64_t(count), 4).integer(2, 4);
    };
    head(2, solid.triangles.size());
    for (const auto& triangle : solid.triangles) element(2, triangle);
    for (const auto& tet : solid.tets) {
        head(4, 1);
        element(4, tet);
    }
    return w.text(is_text ? "" : "\n").text("$EndElements\n").out;
}

inline std::string make_msh4(const SampleSolid& solid, SolidWriter::Kind kind)
{
    const bool is_text = kind == SolidWriter::Kind::text;
    const std::string end = is_text ? "" : "\n";
    const std::int64_t rows = solid.positions.rows();
    SolidWriter w(kind);
    w.text("$MeshFormat\n4.1 " + std::string(is_text ? "0" : "1") + " 8\n");
    if (!is_text) w.integer(1, 4).text("\n");
    w.text("$EndMeshFormat\n$Entities\n1 2 3\n$EndEntities\n$Nodes\n");
    w.integer(2, 8).integer(rows, 8).integer(1, 8).integer(rows, 8).end_line();
    for (const bool is_first :
         { true, false }) { // two nodes on a surface with parameters, the others inside; tags backwards
        const std::int64_t begin = is_first ? 0 : 2, stop = is_first ? 2 : rows;
        w.integer(is_first ? 2 : 3, 4).integer(1, 4).integer(is_first, 4).integer(stop - begin, 8).end_line();
        for (std::int64_t v = begin; v < stop; ++v) w.integer(rows - v, 8).end_line();
        for (std::int64_t v = begin; v < stop; ++v) {
            for (int axis = 0; axis < 3; ++axis) w.real(solid.positions(v, axis));
            if (is_first) w.real(0.5).real(0.25);
            w.end_line();
        }
    }
    w.text(end + "$EndNodes\n$Elements\n");
    const auto total = std::int64_t(solid.triangles.size() + solid.tets.size());
    w.integer(2, 8).integer(total, 8).integer(1, 8).integer(total, 8).end_line();
    const auto block = [&](int dimension, int type, const auto& elements) {
        w.integer(dimension, 4).integer(1, 4).integer(type, 4).integer(std::int64_t(elements.size()), 8).end_line();
        for (const auto& corners : elements) {
            w.integer(77, 8);
            for (const std::uint32_t corner : corners) w.integer(rows - corner, 8);
            w.end_line();
        }
    };
    block(2, 2, solid.triangles);
    block(3, 4, solid.tets);
    return w.text(end + "$EndElements\n").out;
}

inline std::string make_medit(const SampleSolid& solid)
{
    SolidWriter w(SolidWriter::Kind::text);
    w.text("# by hand\nMeshVersionFormatted 2\nDimension\n3\nVertices\n").integer(solid.positions.rows(), 0).end_line();
    for (Eigen::Index v = 0; v < solid.positions.rows(); ++v) {
        for (int axis = 0; axis < 3; ++axis) w.real(solid.positions(v, axis));
        w.text("1\n");
    }
    w.text("\nTriangles ").integer(std::int64_t(solid.triangles.size()), 0).end_line();
    for (const auto& t : solid.triangles) w.integer(t[0] + 1, 0).integer(t[1] + 1, 0).integer(t[2] + 1, 0).text("0\n");
    w.text("Corners\n1\n3\nTetrahedra\n").integer(std::int64_t(solid.tets.size()), 0).end_line();
    for (const auto& tet : solid.tets) {
        for (const std::uint32_t corner : tet) w.integer(corner + 1, 0);
        w.text("0 # a comment\n");
    }
    return w.text("End\n").out;
}

inline std::string make_vega(const SampleSolid& solid, int first)
{
    SolidWriter w(SolidWriter::Kind::text);
    w.text("# Vega\n\n*VERTICES\n").integer(solid.positions.rows(), 0).text("3 0 0\n");
    for (Eigen::Index v = 0; v < solid.positions.rows(); ++v) {
        w.integer(v + first, 0);
        for (int axis = 0; axis < 3; ++axis) w.real(solid.positions(v, axis));
        w.end_line();
    }
    w.text("\n*ELEMENTS\nTET\n").integer(std::int64_t(solid.tets.size()), 0).text("4 0\n");
    for (std::size_t t = 0; t < solid.tets.size(); ++t) {
        w.integer(std::int64_t(t) + first, 0);
        for (const std::uint32_t corner : solid.tets[t]) w.integer(corner + first, 0);
        w.end_line();
    }
    w.text("*MATERIAL A\nENU, 1000, 1e6, 0.45\n*MATERIAL B\nENU,1000,2.5e7,0.3 # stiff\n*SET s\n");
    w.integer(first, 0).text(",").integer(first + 2, 0).text("\n*REGION\nallElements, A\n*REGION\ns, B\n");
    return w.out;
}

inline std::string make_vtk(const SampleSolid& solid, SolidWriter::Kind kind, bool has_offsets)
{
    const bool is_text = kind == SolidWriter::Kind::text;
    const std::size_t count = solid.triangles.size() + solid.tets.size();
    const std::size_t corner_count = 3 * solid.triangles.size() + 4 * solid.tets.size();
    SolidWriter w(kind);
    w.text("# vtk DataFile Version " + std::string(has_offsets ? "5.1" : "3.0") + "\nPOINTS is only a title\n");
    w.text(is_text ? "ASCII\n" : "BINARY\n").text("DATASET UNSTRUCTURED_GRID\n");
    if (has_offsets) // as VTK writes it: metadata behind arrays whose range somebody asked for
        w.text("FIELD FieldData 2\ntime 1 1 double\n")
            .real(0.5)
            .text("\nMETADATA\nINFORMATION 0\n\nspeed 1 1 double\n")
            .real(0.5)
            .text("\n");
    w.text("POINTS " + std::to_string(solid.positions.rows()) + " double\n");
    for (Eigen::Index i = 0; i < solid.positions.size(); ++i) w.real(solid.positions.data()[i]);
    w.text("\n");
    std::vector<std::vector<std::uint32_t>> cells;
    for (const auto& t : solid.triangles) cells.emplace_back(t.begin(), t.end());
    for (const auto& t : solid.tets) cells.emplace_back(t.begin(), t.end());
    if (has_offsets) {
        w.text("METADATA\nINFORMATION 0\n\nCELLS " + std::to_string(count + 1) + " " + std::to_string(corner_count));
        w.text("\nOFFSETS vtktypeint64\n").integer(0, 8);
        std::int64_t offset = 0;
        for (const auto& cell : cells) w.integer(offset += std::int64_t(cell.size()), 8);
        w.text("\nCONNECTIVITY vtktypeint64\n");
        for (const auto& cell : cells) {
            for (const std::uint32_t corner : cell) w.integer(corner, 8);
        }
    } else {
        w.text("CELLS " + std::to_string(count) + " " + std::to_string(corner_count + count) + "\n");
        for (const auto& cell : cells) {
            w.integer(std::int64_t(cell.size()), 4);
            for (const std::uint32_t corner : cell) w.integer(corner, 4);
            w.end_line();
        }
    }
    w.text("\nCELL_TYPES " + std::to_string(count) + "\n");
    for (const auto& cell : cells) w.integer(cell.size() == 3 ? 5 : 10, 4).end_line();
    return w.text("\nPOINT_DATA 6\nanything goes here\n").out;
}

// The same solid in everything that is read.
inline std::vector<Sample> solid_samples(const SampleSolid& solid = sample_solid())
{
    using Kind = SolidWriter::Kind;
    std::vector<Sample> samples;
    const char* const names[] = { "text", "little-endian", "big-endian" };
    for (const Kind kind : { Kind::text, Kind::little_endian, Kind::big_endian }) {
        const std::string name = names[int(kind)];
        samples.push_back({ "Gmsh 2.2, " + name, "a.msh", make_msh2(solid, kind) });
        samples.push_back({ "Gmsh 4.1, " + name, "a.msh", make_msh4(solid, kind) });
        if (kind == Kind::little_endian) continue; // VTK knows big-endian bytes only
        samples.push_back({ "VTK 3.0, " + name, "a.vtk", make_vtk(solid, kind, false) });
        samples.push_back({ "VTK 5.1, " + name, "a.vtk", make_vtk(solid, kind, true) });
    }
    samples.push_back({ "MEDIT", "a.mesh", make_medit(solid) });
    samples.push_back({ "Vega from 1", "a.veg", make_vega(solid, 1) });
    samples.push_back({ "Vega from 0", "a.veg", make_vega(solid, 0) });
    return samples;
}

} // namespace pliant_test
