#include "input/io/read_mesh.h"

#include "input/io/source_file.h"
#include "input/io/tet_builder.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace pliant {
namespace {

struct Format {
    const char* name;
    const char* extension;
    bool (*read)(const SourceFile&, MeshFile&);
};
constexpr std::array<Format, 7> formats { { { "OBJ", ".obj", read_obj },
                                            { "PLY", ".ply", read_ply },
                                            { "OFF", ".off", read_off },
                                            { "Gmsh", ".msh", read_msh },
                                            { "MEDIT", ".mesh", read_medit },
                                            { "Vega", ".veg", read_vega },
                                            { "VTK", ".vtk", read_vtk } } };

const Format* find_by_extension(const std::string& path)
{
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    const auto format
        = std::find_if(formats.begin(), formats.end(), [&](const Format& f) { return extension == f.extension; });
    return format == formats.end() ? nullptr : &*format;
}

bool starts_with(std::string_view text, std::string_view beginning) { return text.substr(0, beginning.size()) == beginning; }

bool has_control_bytes(std::string_view text)
{
    return std::any_of(text.begin(), text.end(),
                       [](unsigned char c) { return c < ' ' && c != '\t' && c != '\f' && c != '\v'; });
}

// Files by their first bytes: some of ours, and those that are often given by mistake.
const char* name_by_magic(std::string_view bytes)
{
    struct Magic {
        std::string_view bytes;
        const char* name;
    };
    constexpr std::array<Magic, 13> magics { { { "glTF", "binary glTF" },
                                               { "\x89PNG", "a PNG picture" },
                                               { "\xff\xd8\xff", "a JPEG picture" },
                                               { "solid", "STL" },
                                               { "$MeshFormat", "Gmsh" },
                                               { "# vtk DataFile", "VTK" },
                                               { "PK\x03\x04", "a ZIP archive" },
                                               { "\x1f\x8b", "a gzip archive" },
                                               { "Kaydara FBX", "FBX" },
                                               { "\xabPLIANT", "a Pliant asset" },
                                               { "{", "JSON" },
                                               { "\xff\xfe", "UTF-16 text" },
                                               { "\xfe\xff", "UTF-16 text" } } };
    for (const Magic& magic : magics) {
        if (starts_with(bytes, magic.bytes)) return magic.name;
    }
    return nullptr;
}

// What the content looks like: the name of a format of ours, something foreign, or "binary data" or "other text". Comments
// and empty lines alone could be any of our text formats: nullptr.
const char* sniff(std::string_view bytes)
{
    if (starts_with(bytes, "ply\n") || starts_with(bytes, "ply\r")) return "PLY";
    if (const char* name = name_by_magic(bytes)) return name;
    LineReader lines(bytes);
    while (lines.next()) {
        std::string_view words = lines.line();
        if (has_control_bytes(words.substr(0, 256))) return "binary data";
        const std::string_view word = next_word(words, '#');
        if (word.empty()) continue;
        const bool ends_off = word.size() >= 3 && word.size() <= 7 && word.substr(word.size() - 3) == "OFF";
        if (ends_off) return "OFF";
        if (word == "ply") return "PLY";
        if (word == "MeshVersionFormatted") return "MEDIT";
        if (word[0] == '*') return "Vega";
        return is_obj_statement(word) ? "OBJ" : "other text";
    }
    return nullptr;
}

// What programs of artists write is named with the way in.
std::string hint_for_unknown(const std::string& extension)
{
    const auto is_one_of = [&](std::initializer_list<const char*> known) {
        return std::any_of(known.begin(), known.end(), [&](const char* one) { return extension == one; });
    };
    if (is_one_of({ ".usd", ".usda", ".usdc", ".usdz" }))
        return "export it as glTF (.glb), or bake it from Python: pliant.load_poses reads USD";
    if (is_one_of({ ".fbx", ".abc", ".blend", ".dae", ".3ds", ".max", ".ma", ".mb" }))
        return "export it as glTF (.glb) from the program that made it, with shape keys or animations";
    return "surfaces are read from .obj, .ply and .off, as poses also from .glb, .gltf and .vrm, solids from .msh, .mesh, "
           ".veg and .vtk";
}

// The format to read with, or nothing after a P2003, P2004 or P2005.
const Format* choose_format(const SourceFile& file)
{
    const Format* format = find_by_extension(file.path);
    if (!format) {
        file.error(2003, file.path,
                   fmt::format("unknown kind of file {}", excerpt(std::filesystem::path(file.path).extension().string())),
                   hint_for_unknown(std::filesystem::path(file.path).extension().string()));
        return nullptr;
    }
    if (file.bytes.empty()) {
        file.error(2005, file.path, "is empty: has no vertices", "export the file again");
        return nullptr;
    }
    const char* content = sniff(file.bytes);
    if (!content || std::string_view(content) == format->name) return format;
    file.error(2004, file.path, fmt::format("is named {}, but its content looks like {}", format->extension, content),
               "rename the file, or export it again");
    return nullptr;
}

void check_not_empty(const SourceFile& file, const MeshFile& mesh)
{
    if (mesh.positions.rows() == 0)
        file.error(2005, file.path, "has no vertices", "export the mesh itself");
    else if (mesh.faces.count() == 0 && mesh.tets.empty())
        file.error(2006, file.path, "has no faces", "export the faces along with the vertices");
}

} // namespace

std::optional<MeshFile> parse_mesh(const std::string& path, std::string bytes, DiagnosticList& diagnostics)
{
    if (starts_with(bytes, "\xef\xbb\xbf")) bytes.erase(0, 3);
    const SourceFile file { path, std::move(bytes), &diagnostics };

    const std::size_t errors_before = diagnostics.error_count();
    const Format* format = choose_format(file);
    if (!format) return std::nullopt;
    MeshFile mesh;
    mesh.path = path;
    try {
        if (!format->read(file, mesh) && diagnostics.error_count() == errors_before) report_truncated(file, "the file");
        if (diagnostics.error_count() == errors_before) check_not_empty(file, mesh);
    } catch (const std::bad_alloc&) {
        file.error(2008, path, "does not fit into memory", "use a machine with more memory or a coarser mesh");
    }
    if (diagnostics.error_count() != errors_before) return std::nullopt;
    return mesh;
}

std::optional<MeshFile> read_mesh(const std::string& path, DiagnosticList& diagnostics)
{
    std::optional<std::string> bytes = read_bytes(path, diagnostics);
    return bytes ? parse_mesh(path, std::move(*bytes), diagnostics) : std::nullopt;
}

MeshFile read_mesh(const std::string& path)
{
    DiagnosticList diagnostics;
    std::optional<MeshFile> mesh = read_mesh(path, diagnostics);
    if (!mesh) throw Failure(ExitCode::bad_input, diagnostics.diagnostics());
    return std::move(*mesh);
}

} // namespace pliant
