// load_poses_tool [--fix FILE] POSE...: loads poses, prints what was found as `pliant check` does, exits with its code. For
// the tests of tests/bad_input where the tool `pliant` is not built. Also: load_poses_tool --write OUT [--repeat N] POSE...
// writes pose 0.
#include "input/io/encode_ply.h"
#include "input/io/write_file.h"
#include "input/poses/load_poses.h"

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

struct Arguments {
    std::vector<std::string> poses;
    std::string output, fixed;
    int repeat = 1;
};

Arguments parse(int argc, char** argv)
{
    Arguments arguments;
    bool only_poses = false;
    for (int i = 1; i < argc; ++i) {
        const bool has_value = i + 1 < argc && !only_poses;
        if (has_value && std::strcmp(argv[i], "--write") == 0)
            arguments.output = argv[++i];
        else if (has_value && std::strcmp(argv[i], "--repeat") == 0)
            arguments.repeat = std::atoi(argv[++i]);
        else if (has_value && std::strcmp(argv[i], "--fix") == 0)
            arguments.fixed = argv[++i];
        else if (!only_poses && std::strcmp(argv[i], "--") == 0)
            only_poses = true;
        else
            arguments.poses.emplace_back(argv[i]);
    }
    return arguments;
}

void print(const std::vector<pliant::Diagnostic>& diagnostics)
{
    for (const pliant::Diagnostic& diagnostic : diagnostics)
        std::fprintf(stderr, "load_poses_tool: %s\n", to_text(diagnostic).c_str());
}

} // namespace

int main(int argc, char** argv)
{
    const Arguments arguments = parse(argc, argv);
    try {
        pliant::probe_outputs({ arguments.output }, arguments.poses);
        std::vector<pliant::Diagnostic> warnings;
        pliant::LoadOptions options;
        options.fixed_path = arguments.fixed;
        const pliant::PoseSet poses = pliant::load_poses(arguments.poses, options, &warnings);
        print(warnings);
        for (int i = 0; i < arguments.repeat && !arguments.output.empty(); ++i)
            pliant::write_file_atomically(arguments.output, pliant::encode_ply(poses.positions[0], poses));
        std::printf("%zu poses, %zu vertices, %zu faces, %zu triangles\n", poses.pose_count(), poses.vertex_count(),
                    poses.polygons.count(), poses.triangles.size());
        return 0;
    } catch (const pliant::Failure& failure) {
        print(failure.diagnostics());
        return static_cast<int>(failure.code());
    }
}
