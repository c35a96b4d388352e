// creature: writes the five poses of Pliant's example character.
#include "creature.h"
#include "ply.h"

#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace {

constexpr int min_vertices = 8000, max_vertices = 20000, default_vertices = 12000;

constexpr char help_text[] = "usage: creature -o DIR [--vertices N]\n"
                             "\n"
                             "Writes five poses of one character, same vertices and faces, as binary PLY files:\n"
                             "DIR/creature_rest.ply, _reach, _curl, _leap, _twist. DIR must exist.\n"
                             "\n"
                             "  -o, --output DIR   the folder to write to\n"
                             "  --vertices N       about this many vertices, 8000 to 20000 (default 12000)\n"
                             "  --help             this text\n"
                             "\n"
                             "exit code: 0 done, 1 failed while working, 2 wrong usage\n";

struct Options {
    std::string folder;
    int vertex_count = default_vertices;
    bool help = false;
};

// Returns an empty text, or what is wrong with the command line.
std::string parse(int argc, char** argv, Options& options)
{
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        if (argument == "--help" || argument == "-h") {
            options.help = true;
            return {};
        }
        const bool folder = argument == "-o" || argument == "--output";
        if (!folder && argument != "--vertices") return "unknown argument '" + argument + "'";
        if (++i == argc) return argument + " needs a value";
        if (folder) {
            options.folder = argv[i];
            continue;
        }
        const char* end = argv[i] + std::strlen(argv[i]);
        const auto [stop, error] = std::from_chars(argv[i], end, options.vertex_count);
        if (error != std::errc() || stop != end || options.vertex_count < min_vertices
            || options.vertex_count > max_vertices)
            return "--vertices: '" + std::string(argv[i]) + "' is not a whole number from 8000 to 20000";
    }
    return options.folder.empty() ? "no output folder given" : "";
}

} // namespace

int main(int argc, char** argv)
{
#ifdef SIGXFSZ
    std::signal(SIGXFSZ, SIG_IGN); // a limit on the size of files is an error like a full disk
#endif
    Options options;
    const std::string wrong = parse(argc, argv, options);
    if (!wrong.empty()) {
        std::fprintf(stderr, "creature: error: %s\nhint: see creature --help\n", wrong.c_str());
        return 2;
    }
    if (options.help) return std::fputs(help_text, stdout) < 0 || std::fflush(stdout) != 0;
    // Checked first: building takes seconds.
    std::error_code ignored;
    if (!std::filesystem::is_directory(options.folder, ignored)) {
        std::fprintf(stderr, "creature: error: %s is not a folder\nhint: create it first\n", options.folder.c_str());
        return 1;
    }
    try {
        const auto character = pliant::creature::build_character(options.vertex_count);
        std::vector<pliant::creature::PlyFile> files;
        for (const auto& pose : character.poses)
            files.push_back({ options.folder + "/creature_" + pose.name + ".ply", pose.points });
        pliant::creature::write_ply_set(files, character.faces);
        std::printf("creature: %zu poses, %zu vertices, %zu faces\n", character.poses.size(),
                    character.poses.front().points.size(), character.faces.size());
        if (std::fflush(stdout) != 0) throw std::runtime_error("standard output cannot be written");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "creature: error: %s\n", error.what());
        return 1;
    }
    return 0;
}
